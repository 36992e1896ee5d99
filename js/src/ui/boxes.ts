/** Where panels are: a plan divides a rectangle again and again; a panel that is hidden leaves its place to the rest. */

/** A panel, or two plans with a bar between them. */
export type Plan = string | Division;

export interface Division {
  name: string;
  /** What the bar sets, in words. */
  label: string;
  /** `columns`: side by side; `rows`: one above the other. */
  axis: "columns" | "rows";
  /** The first one's part of the whole, in percent, unless the user chose another. */
  share: number;
  parts: readonly [Plan, Plan];
}

/** A rectangle, in percent of the whole. */
export interface Box {
  left: number;
  top: number;
  width: number;
  height: number;
}

export interface Bar {
  division: Division;
  share: number;
  /** The rectangle that it divides, and its place: the edge between the two parts. */
  around: Box;
  box: Box;
}

interface Arrangement {
  boxes: Map<string, Box>;
  bars: Bar[];
}

const WHOLE: Box = { left: 0, top: 0, width: 100, height: 100 };

/** The places of the panels that are shown, and of the bars between them; without a plan none. */
export function arrange(
  plan: Plan | null,
  isShown: (panel: string) => boolean,
  shareOf: (division: Division) => number = ({ share }) => share,
): Arrangement {
  const arrangement: Arrangement = { boxes: new Map(), bars: [] };
  const place = (part: Plan, box: Box): void => {
    if (typeof part === "string") {
      if (isShown(part)) arrangement.boxes.set(part, box);
      return;
    }
    const [first, second] = part.parts.filter((each) => panelsOf(each).some(isShown));
    if (!first) return;
    if (!second) {
      place(first, box);
      return;
    }
    const share = shareOf(part);
    const [begin, length] =
      part.axis === "columns" ? (["left", "width"] as const) : (["top", "height"] as const);
    const size = (box[length] * share) / 100;
    const before = { ...box, [length]: size };
    const after = { ...box, [begin]: box[begin] + size, [length]: box[length] - size };
    arrangement.bars.push({ division: part, share, around: box, box: { ...after, [length]: 0 } });
    place(first, before);
    place(second, after);
  };
  if (plan) place(plan, WHOLE);
  return arrangement;
}

function panelsOf(plan: Plan): string[] {
  return typeof plan === "string" ? [plan] : plan.parts.flatMap(panelsOf);
}
