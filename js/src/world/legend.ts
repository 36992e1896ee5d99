/** What the colours of the trail mean: a list of states over the world, and a tip beside the pointer. */

import { nameOf } from "../language/paths";
import type { ProgramView } from "../protocol";
import { h, reconcile, setAttribute, setHidden, setText } from "../ui/dom";
import type { Stage } from "./stage";

const REACH = 9; // px from the trail
const DASH = [8, 5]; // px

/** The colours in the order of the program; once they are used up, they come again with a dash. */
export function trailStyles(
  program: ProgramView,
  colors: readonly string[],
): (state: string) => { color: string; dash: number[] } {
  const order = new Map<string, number>();
  for (const { states } of program.machines)
    for (const { path, machines } of states) if (!machines.length) order.set(path, order.size);
  return (state) => {
    const index = order.get(state) ?? 0;
    return {
      color: colors[index % colors.length] ?? "gray",
      dash: Math.floor(index / colors.length) % 2 ? DASH : [],
    };
  };
}

export interface Legend {
  element: HTMLElement;
  tip: HTMLElement;
  refresh(): void;
}

export function legend(stage: Stage): Legend {
  const element = h("ul", { class: "lrp-legend", "aria-label": "Colours of the trail" });
  const tip = h("div", { class: "lrp-tip", hidden: true, "aria-hidden": "true" });
  let shown = "";
  stage.canvas.addEventListener("pointermove", (event) => {
    const [x, y] = stage.inside(event.offsetX, event.offsetY);
    const now = stage.latest?.time ?? 0;
    const found =
      stage.showsTrail && !event.buttons ? stage.trail.near(x, y, REACH / stage.viewport.scale, now) : null;
    setHidden(tip, !found?.state);
    if (!found) return;
    setText(tip, `${nameOf(found.state)} · ${found.time.toFixed(1)} s`);
    tip.style.left = `${event.offsetX + 12}px`;
    tip.style.top = `${event.offsetY + 12}px`;
  });
  stage.canvas.addEventListener("pointerleave", () => setHidden(tip, true));
  return {
    element,
    tip,
    refresh() {
      const states = stage.showsTrail
        ? stage.trail.states(stage.latest?.time ?? 0).filter((state) => state !== "")
        : [];
      const key = JSON.stringify(states.map((state) => [state, stage.styleOf(state)]));
      if (key === shown) return;
      shown = key;
      reconcile(
        element,
        states,
        (state) => state,
        (state) =>
          h("li", { title: state }, h("span", { class: "lrp-swatch" }), h("span", {}, nameOf(state))),
        (item, state) => {
          const { color, dash } = stage.styleOf(state);
          const swatch = item.firstElementChild as HTMLElement;
          swatch.style.setProperty("--lrp-swatch", color);
          setAttribute(swatch, "data-dashed", dash.length > 0);
        },
      );
    },
  };
}
