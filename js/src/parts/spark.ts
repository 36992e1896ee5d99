/** The last values of a number as a small line. */

import { s, setAttribute } from "../ui/dom";

const KEPT = 48;
const WIDTH = 48;
const HEIGHT = 14;

export class Spark {
  readonly element = s(
    "svg",
    { class: "lrp-spark", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, "aria-hidden": "true", hidden: true },
    s("polyline", {}),
  );
  private values: number[] = [];

  add(value: number | null): void {
    if (value === null || !Number.isFinite(value)) this.values = [];
    else if (value === this.values.at(-1)) return;
    else this.values = [...this.values.slice(1 - KEPT), value];
    setAttribute(this.element, "hidden", this.values.length < 3);
    setAttribute(this.element.firstElementChild!, "points", points(this.values));
  }
}

/** The points of the line, newest at the right. */
export function points(values: readonly number[]): string {
  const least = Math.min(...values);
  const span = Math.max(...values) - least || 1;
  const step = WIDTH / (KEPT - 1);
  const first = WIDTH - (values.length - 1) * step;
  return values
    .map(
      (value, i) =>
        `${(first + i * step).toFixed(1)},${(HEIGHT - 2 - ((value - least) / span) * (HEIGHT - 4)).toFixed(1)}`,
    )
    .join(" ");
}
