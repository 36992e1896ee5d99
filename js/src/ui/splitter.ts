/** A bar between two panels, moved by dragging or with the arrow keys. It sets a CSS variable. */

import { h } from "./dom";

interface Options {
  /** The variable: a share of the whole, in percent. */
  name: string;
  label: string;
  direction: "columns" | "rows";
  value: number;
  min: number;
  max: number;
  /** The element whose size is the whole, and which carries the variable. */
  whole: HTMLElement;
  /** Count from the far end. */
  reversed?: boolean;
}

export function splitter(options: Options): HTMLElement {
  const { name, label, direction, min, max, whole, reversed = false } = options;
  const columns = direction === "columns";
  const set = (wanted: number) => {
    const value = Math.min(max, Math.max(min, wanted));
    whole.style.setProperty(name, `${value}%`);
    bar.setAttribute("aria-valuenow", String(Math.round(value)));
  };
  const bar = h("div", {
    class: `lrp-splitter lrp-splitter-${direction}`,
    role: "separator",
    tabindex: "0",
    "aria-label": label,
    "aria-orientation": columns ? "vertical" : "horizontal",
    "aria-valuemin": String(min),
    "aria-valuemax": String(max),
    onpointerdown: (event: PointerEvent) => {
      event.preventDefault();
      bar.setPointerCapture(event.pointerId);
      bar.dataset.dragged = "";
    },
    onpointermove: (event: PointerEvent) => {
      if (!bar.hasPointerCapture(event.pointerId)) return;
      const frame = whole.getBoundingClientRect();
      const share = columns
        ? (event.clientX - frame.left) / frame.width
        : (event.clientY - frame.top) / frame.height;
      set(100 * (reversed ? 1 - share : share));
    },
    onpointerup: () => delete bar.dataset.dragged,
    onkeydown: (event: KeyboardEvent) => {
      const less = columns ? "ArrowLeft" : "ArrowUp";
      const more = columns ? "ArrowRight" : "ArrowDown";
      if (event.key !== less && event.key !== more) return;
      event.preventDefault();
      event.stopPropagation();
      const value = Number.parseFloat(whole.style.getPropertyValue(name)); // others may have set it too
      set(value + (event.key === more ? 2 : -2) * (reversed ? -1 : 1));
    },
  });
  set(options.value);
  return bar;
}
