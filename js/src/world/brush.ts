/** The brush that paints a world, and the shapes that its things share. */

import type { Pose } from "../protocol";
import type { Palette } from "./palette";

export interface Brush {
  /** In metres, with y up. */
  c: CanvasRenderingContext2D;
  palette: Palette;
  /** Per metre: they keep lines and texts legible. */
  pixels: number;
}

/** Paint in the coordinates of a pose. */
export function paintAt(c: CanvasRenderingContext2D, [x, y, theta]: Pose, paint: () => void): void {
  c.save();
  c.translate(x, y);
  c.rotate(theta);
  paint();
  c.restore();
}

export function traceDisc(c: CanvasRenderingContext2D, x: number, y: number, radius: number): void {
  c.beginPath();
  c.arc(x, y, radius, 0, 2 * Math.PI);
}

/** A rectangle around a point. */
export function traceBox(
  c: CanvasRenderingContext2D,
  [x = 0, y = 0, width = 0, height = 0]: readonly number[],
): void {
  c.beginPath();
  c.rect(x - width / 2, y - height / 2, width, height);
}

/** Add a triangle that points ahead to the path. */
export function addHeading(c: CanvasRenderingContext2D, tip: number, back: number, half: number): void {
  c.moveTo(tip, 0);
  c.lineTo(back, half);
  c.lineTo(back, -half);
  c.closePath();
}

export function drawPath(c: CanvasRenderingContext2D, color: string, width: number): void {
  c.strokeStyle = color;
  c.lineWidth = width;
  c.stroke();
}

/** Fill the path, and draw its outline over that. */
export function fillAndOutline(c: CanvasRenderingContext2D, fill: string, edge: string, width: number): void {
  c.fillStyle = fill;
  c.fill();
  drawPath(c, edge, width);
}

/** Dash the lines that follow, with lengths in pixels; without lengths, make them solid. */
export function setDash({ c, pixels }: Brush, ...dash: number[]): void {
  c.setLineDash(dash.map((length) => length / pixels));
}

/** Write a text around or from a point; it stands upright although y points up. */
export function write(
  { c, palette }: Pick<Brush, "c" | "palette">,
  text: string,
  [x, y]: readonly [number, number],
  size: number,
  color: string,
  { align = "center", halo = true }: { align?: CanvasTextAlign; halo?: boolean } = {},
): void {
  c.save();
  c.translate(x, y);
  c.scale(size / 12, -size / 12);
  c.font = `600 12px ${palette.font}`;
  c.textAlign = align;
  c.textBaseline = "middle";
  if (halo) {
    c.lineWidth = 3;
    c.lineJoin = "round";
    c.strokeStyle = palette.halo;
    c.strokeText(text, 0, 0);
  }
  c.fillStyle = color;
  c.fillText(text, 0, 0);
  c.restore();
}
