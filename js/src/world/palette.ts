/** The colours of a world, from the stylesheet. */

import { h } from "../ui/dom";

const COLOURS = [
  ...(["accent", "ink", "paper", "grid", "edge", "solid", "pushable", "moving", "solidEdge"] as const),
  ...(["zone", "robot", "robotEdge", "mark", "bump", "lamp", "ray", "text", "halo"] as const),
];

type Colour = (typeof COLOURS)[number];

export interface Palette extends Record<Colour, string> {
  trail: string[];
  /** The colours of the second robot, the third … */
  others: Pick<Palette, "robot" | "robotEdge" | "mark">[];
  /** Whether the greys of the floor, which are real, are dimmed. */
  dim: boolean;
  font: string;
}

/** How a state's trail is drawn. */
export interface Style {
  color: string;
  dash: number[];
}

/** Read the colours that apply in an element. A canvas knows no `light-dark()`, so a probe resolves them. */
export function paletteIn(root: HTMLElement): Palette {
  const probe = h("span", { hidden: true });
  root.append(probe);
  const style = getComputedStyle(probe);
  const color = (name: string) => {
    probe.style.color = `var(--lrp-world-${name}, gray)`;
    return style.color || "gray"; // none before the view is in a page
  };
  const named = COLOURS.map((name) => [name, color(name.replace("Edge", "-edge"))]);
  const palette = {
    ...(Object.fromEntries(named) as Record<Colour, string>),
    trail: [1, 2, 3, 4, 5, 6, 7, 8].map((number) => color(`trail-${number}`)),
    others: [2, 3].map((number) => ({
      robot: color(`robot-${number}`),
      robotEdge: color(`robot-${number}-edge`),
      mark: color(`mark-${number}`),
    })),
    dim: root.dataset.theme === "dark",
    font: style.fontFamily || "sans-serif",
  };
  probe.remove();
  return palette;
}

/** A palette with the colours of one of several robots. */
export function ofRobot(palette: Palette, index: number): Palette {
  const { others } = palette;
  const number = index % (others.length + 1);
  return number ? { ...palette, ...others[number - 1] } : palette;
}

/** A grey of the floor. */
export function shade(grey: number, { dim }: Palette): string {
  const value = Math.round(dim ? 22 + grey * 0.78 : grey);
  return `rgb(${value} ${value} ${value})`;
}
