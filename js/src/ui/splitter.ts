/** A bar between two parts of the lab, moved by dragging or with the arrow keys; a double click returns it. */

import type { Bar, Box } from "./boxes";
import { h } from "./dom";
import { trackDrag } from "./drag";

const LEAST = 15; // percent that each part keeps
const STEP = 2; // percent by an arrow key

/** `choose` gets the new share in percent, null for the usual one. */
export function splitter(whole: HTMLElement, choose: (share: number | null) => void) {
  let shown: Bar;
  const set = (share: number) => choose(Math.min(100 - LEAST, Math.max(LEAST, share)));
  const element = h("div", {
    class: "lrp-splitter",
    role: "separator",
    tabindex: "0",
    "aria-valuemin": String(LEAST),
    "aria-valuemax": String(100 - LEAST),
    onpointerdown: (event: PointerEvent) => {
      if (event.button !== 0) return;
      event.preventDefault();
      element.dataset.dragged = "";
      const { share } = shown;
      trackDrag(element, event, {
        move({ clientX, clientY }) {
          const frame = whole.getBoundingClientRect();
          const { left, top, width, height } = shown.around;
          const x = (100 * (clientX - frame.left)) / frame.width;
          const y = (100 * (clientY - frame.top)) / frame.height;
          set(shown.division.axis === "columns" ? (100 * (x - left)) / width : (100 * (y - top)) / height);
        },
        end(last, moved) {
          delete element.dataset.dragged;
          if (moved && !last) set(share);
        },
      });
    },
    ondblclick: () => choose(null),
    onkeydown: (event: KeyboardEvent) => {
      const [less, more] =
        shown.division.axis === "columns" ? ["ArrowLeft", "ArrowRight"] : ["ArrowUp", "ArrowDown"];
      if (event.key === less) set(shown.share - STEP);
      else if (event.key === more) set(shown.share + STEP);
      else if (event.key === "Home") set(LEAST);
      else if (event.key === "End") set(100 - LEAST);
      else return;
      event.preventDefault();
    },
  });
  return {
    element,
    update(bar: Bar): void {
      shown = bar;
      const { division, share, box } = bar;
      element.className = `lrp-splitter lrp-splitter-${division.axis}`;
      element.setAttribute("aria-label", division.label);
      element.setAttribute("aria-orientation", division.axis === "columns" ? "vertical" : "horizontal");
      element.setAttribute("aria-valuenow", String(Math.round(share)));
      put(element, box);
    },
  };
}

/** Put an element into its place; the stylesheet decides whether it has one. */
export function put(element: HTMLElement, box: Box): void {
  for (const [side, share] of Object.entries(box))
    element.style.setProperty(`--lrp-box-${side}`, `${share}%`);
}
