/** What the colours of the trail mean: a list of states over the world, and a tip beside the pointer. */

import { nameOf } from "../language/paths";
import type { Point, ProgramView } from "../protocol";
import { h, reconcile, setAttribute, setHidden, setText, unmarked } from "../ui/dom";
import { coursesOf } from "./courses";
import { partingOf } from "./ghost";
import type { Style } from "./palette";
import type { Stage } from "./stage";

export const REACH = 9; // px from the trail
const DASH = [8, 5]; // px
const STRIPES = [3, 3]; // px

/** The colours of the trail for what is no canvas; the stylesheet lightens them in the dark. */
export const TRAIL_COLORS = [1, 2, 3, 4, 5, 6, 7, 8].map(
  (number) => `color-mix(in srgb, white var(--lrp-trail-light), var(--lrp-world-trail-${number}))`,
);

const numbers = new WeakMap<ProgramView, Map<string, number>>();

/**
 * The numbers of a program's states, the same for all that is drawn of it. The states in which machines run come
 * after the others. States of another program, an earlier one or one with an edit of the past, get the next numbers
 * when they are first seen.
 */
function numbersOf(program: ProgramView): Map<string, number> {
  let order = numbers.get(program);
  if (!order) {
    const states = program.machines.flatMap((machine) => machine.states);
    states.sort((a, b) => Number(a.machines.length > 0) - Number(b.machines.length > 0));
    order = new Map(states.map(({ path }, index) => [path, index]));
    numbers.set(program, order);
  }
  return order;
}

/**
 * The colours in the order of the program; once they are used up, they come again with a dash. The states in
 * which machines run are striped: they are seen where no machine runs in them.
 */
export function trailStyles(program: ProgramView, colors: readonly string[]): (state: string) => Style {
  const order = numbersOf(program);
  const states = program.machines.flatMap((machine) => machine.states);
  const outer = new Set(states.flatMap(({ path, machines }) => (machines.length ? [path] : [])));
  return (state) => {
    if (!state) return { color: "gray", dash: [] }; // no state is known, or shown
    const index = order.get(state) ?? order.size;
    order.set(state, index);
    const again = Math.floor(index / colors.length) % 2 ? DASH : [];
    return { color: colors[index % colors.length] ?? "gray", dash: outer.has(state) ? STRIPES : again };
  };
}

export function legend(stage: Stage, programOf: () => ProgramView) {
  const element = h("ul", { class: "lrp-legend", "aria-label": "Colours of the trail" });
  const tip = h("div", { class: "lrp-tip", hidden: true, "aria-hidden": "true" });
  let shown = "";
  stage.canvas.addEventListener("pointermove", (event) => {
    const text = event.buttons ? "" : tipAt(stage, stage.viewport.inside(event.offsetX, event.offsetY));
    setHidden(tip, !text);
    if (!text) return;
    setText(tip, text);
    const right = stage.canvas.clientWidth - tip.offsetWidth;
    tip.style.left = `${Math.max(0, Math.min(event.offsetX + 12, right))}px`;
    tip.style.top = `${event.offsetY + 12}px`;
  });
  stage.canvas.addEventListener("pointerleave", () => setHidden(tip, true));
  return {
    element,
    tip,
    refresh(): void {
      const entries = entriesOf(stage, programOf());
      const key = JSON.stringify(entries);
      if (key === shown) return;
      shown = key;
      reconcile(
        element,
        entries,
        ({ title }) => title,
        ({ title, name }) => h("li", { title }, h("span", { class: "lrp-swatch" }), h("span", {}, name)),
        (item, { color, line }) => {
          const swatch = item.firstElementChild as HTMLElement;
          swatch.style.setProperty("--lrp-swatch", color);
          setAttribute(swatch, "data-line", line);
        },
      );
    },
  };
}

interface Entry {
  title: string;
  name: string;
  color: string;
  line: string | null;
}

/** What the lines in the world mean: courses, and the states of the trail in the order of the program. */
function entriesOf(
  { whatIf, palette, trail, latest, showsTrail, styleOf }: Stage,
  program: ProgramView,
): Entry[] {
  const drawn = whatIf ? coursesOf(whatIf, palette).reverse() : [];
  const courses = drawn.map((each) => ({ ...each, line: lineOf(each.dash) }));
  if (!showsTrail.on) return courses;
  const states = trail.states(latest?.time ?? 0).filter((state) => state !== "");
  const styled = states.map((state) => ({ state, ...styleOf(state) }));
  const order = numbersOf(program); // with all states that have a style by now
  styled.sort((a, b) => order.get(a.state)! - order.get(b.state)!);
  return [
    ...courses,
    ...styled.map(({ state, color, dash }) => {
      return { title: state, name: nameOf(state), color, line: lineOf(dash) };
    }),
  ];
}

/** What a line with these dashes is called. */
function lineOf([dash = 0, gap = 0]: readonly number[]): string | null {
  return gap ? (dash < gap ? "dotted" : "dashed") : null;
}

/** What is at a place: where two courses part, or a moment of the trail. */
function tipAt({ whatIf, trail, viewport, showsTrail }: Stage, [x, y]: Point): string {
  const reach = REACH / viewport.scale;
  const parting = whatIf && partingOf(whatIf);
  if (parting && Math.hypot(parting[0] - x, parting[1] - y) <= reach)
    return unmarked(`${whatIf.divergence!.time.toFixed(1)} s: ${whatIf.divergence!.text}`);
  const found = showsTrail.on ? trail.near(x, y, reach) : null;
  return found?.state ? `${nameOf(found.state)} · ${found.time.toFixed(1)} s · click to look` : "";
}
