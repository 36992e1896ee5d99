/** How fast the program and the simulation run. */

import type { Lab } from "../session/store";
import { h, setText } from "../ui/dom";

const ON_ITS_WAY = 1000; // ms in which the kernel may still report the value before the one chosen here
const SPEEDS = [0.25, 0.5, 1, 2, 5, 10, 0];

export function rateSlider(lab: Lab): HTMLElement {
  const { store } = lab;
  let moved = Number.NEGATIVE_INFINITY;
  const shown = h("span", {});
  const real = h("span", { class: "lrp-achieved" });
  const slider = h("input", {
    type: "range",
    class: "lrp-slider",
    ...SLIDER,
    "aria-label": "Rate",
    "data-lrp-action": "rate",
    title: "Ticks per second; at the right end, as many as possible",
    oninput: () => {
      moved = performance.now();
      lab.send({ do: "rate", value: rateAt(Number(slider.value)) });
    },
  });
  store.watch(["rate", "achieved_rate"], () => {
    const { rate: wanted, achieved_rate: achieved } = store.state;
    if (rateAt(Number(slider.value)) !== wanted && performance.now() - moved > ON_ITS_WAY)
      slider.value = String(positionOf(wanted));
    slider.setAttribute("aria-valuetext", rateText(wanted));
    const off = achieved > 0 && (wanted === 0 || Math.abs(achieved - wanted) > 0.05 * wanted);
    setText(shown, rateText(wanted));
    setText(real, off ? ` (${achieved < 10 ? achieved.toFixed(1) : Math.round(achieved)})` : "");
  });
  const value = h("output", { class: "lrp-number" }, shown, real);
  return h("label", { class: "lrp-control" }, h("span", {}, "Rate"), slider, value);
}

export function speedSelect(lab: Lab): HTMLElement {
  const { store } = lab;
  let chosen = Number.NEGATIVE_INFINITY;
  const select = h(
    "select",
    {
      class: "lrp-select",
      "aria-label": "Speed of the simulation",
      "data-lrp-action": "speed",
      onchange: () => {
        chosen = performance.now();
        lab.send({ do: "speed", value: Number(select.value) });
      },
    },
    ...SPEEDS.map((speed) => h("option", { value: speed }, speed ? `×${speed}` : "max")),
  );
  const label = h("label", { class: "lrp-control" }, h("span", {}, "Speed"), select);
  store.watch(["speed", "bridge"], () => {
    if (performance.now() - chosen > ON_ITS_WAY) select.value = String(store.state.speed);
    label.hidden = store.state.bridge.hardware;
  });
  return label;
}

/** Round numbers, each a tenth or so more than the one before: what a key steps through. */
const TENFOLD = [
  10, 11, 12, 13, 14, 15, 16, 18, 20, 22, 25, 28, 30, 33, 36, 40, 45, 50, 55, 60, 65, 70, 80, 90,
];
/** Hz, from 0.1 to 1000. */
const RATES = [...[100, 10, 1, 0.1].flatMap((part) => TENFOLD.map((each) => each / part)), 1000];

/** Free is one step above the highest rate. */
export const SLIDER = { min: 0, max: RATES.length, step: 1 } as const;

/** Hz at a position of the slider. */
export function rateAt(position: number): number {
  return RATES[position] ?? 0;
}

/** The position that shows a rate, or the next lower one. */
export function positionOf(rate: number): number {
  const position = RATES.findLastIndex((each) => each <= rate);
  return rate > 0 ? Math.max(0, position) : SLIDER.max;
}

export function rateText(rate: number): string {
  return rate > 0 ? `${rate} Hz` : "free";
}
