/** Scrolling of a drawing that is larger than its panel: by the wheel, with bars that show which part is in view. */

import { h } from "../ui/dom";
import { comesFrom } from "../ui/root";
import type { Box, Camera } from "./camera";

const LINE = 16; // px, for mice that scroll by lines
const SAME_GESTURE = 250; // ms: a scrolled page goes on scrolling when the graph comes under the pointer
const MARGIN = 2; // px around a bar

interface Size {
  width: number;
  height: number;
}

/** Move a camera by so many px, not beyond the drawing; returns whether it moved. */
export function scroll(camera: Camera, content: Box, size: Size, dx: number, dy: number): boolean {
  const { x, y, scale } = camera;
  camera.x = scrolled(x, content.x * scale, content.width * scale, size.width, dx);
  camera.y = scrolled(y, content.y * scale, content.height * scale, size.height, dy);
  return camera.x !== x || camera.y !== y;
}

function scrolled(offset: number, begin: number, length: number, room: number, by: number): number {
  const [least, most] = [room - length - begin, -begin];
  if (length <= room + 1 || !by) return offset;
  return by > 0
    ? Math.min(offset, Math.max(least, offset - by))
    : Math.max(offset, Math.min(most, offset - by));
}

/** Let the wheel scroll what is cut off; elsewhere it scrolls the page. */
export function scrollByWheel(
  svg: SVGSVGElement,
  closed: AbortSignal,
  move: (dx: number, dy: number) => boolean,
): void {
  let elsewhere = Number.NEGATIVE_INFINITY; // when the wheel last scrolled something else
  document.addEventListener(
    "wheel",
    (event) => {
      if (!comesFrom(event, svg)) elsewhere = event.timeStamp;
    },
    { passive: true, capture: true, signal: closed },
  );
  svg.addEventListener(
    "wheel",
    (event) => {
      if (event.ctrlKey || event.metaKey) return; // zooms
      const unit = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? LINE : 1;
      const [dx, dy] = event.shiftKey && !event.deltaX ? [event.deltaY, 0] : [event.deltaX, event.deltaY];
      if (event.timeStamp - elsewhere > SAME_GESTURE && move(dx * unit, dy * unit)) event.preventDefault();
      else elsewhere = event.timeStamp;
    },
    { passive: false },
  );
}

export class ScrollBars {
  private readonly across = h("div", { class: "lrp-scroll lrp-scroll-across", "aria-hidden": "true" });
  private readonly down = h("div", { class: "lrp-scroll lrp-scroll-down", "aria-hidden": "true" });
  readonly elements = [this.across, this.down];

  update({ x, y, scale }: Camera, content: Box, { width, height }: Size): void {
    show(this.across, "left", "width", content.x * scale + x, content.width * scale, width);
    show(this.down, "top", "height", content.y * scale + y, content.height * scale, height);
  }
}

function show(
  bar: HTMLElement,
  at: "left" | "top",
  extent: "width" | "height",
  first: number,
  length: number,
  room: number,
): void {
  const [begin, end] = [Math.max(0, -first), Math.max(0, first + length - room)];
  bar.hidden = room <= 0 || begin + end <= 1;
  if (bar.hidden) return;
  const whole = begin + end + room;
  bar.style[at] = `${MARGIN + (begin / whole) * (room - 2 * MARGIN)}px`;
  bar.style[extent] = `${(room / whole) * (room - 2 * MARGIN)}px`;
}
