/** The part of a world that a canvas shows: metres with y up, pixels with y down. */

import type { Point } from "../protocol";

export const SMALLEST_ROBOT = 20; // px across: below that its heading and sensors cannot be seen
const MARGIN = 0.02; // metres around the world
const LARGEST = 2500; // px per metre
const INNER = 0.28; // the share of the canvas at each edge that a followed robot does not enter

/** The width of a picture of a whole world, divided by its height. */
export function proportions([width, height]: Point): number {
  return (width + 2 * MARGIN) / (height + 2 * MARGIN);
}

export class Viewport {
  /** Pixels per metre. */
  scale = 100;
  /** The origin of the world, in pixels. */
  private x = 0;
  private y = 0;
  /** `auto`: all of the world, or less of it if the robot would be too small; `all`; or what the user chose. */
  private mode: "auto" | "all" | "free" = "auto";
  /** Whether the robot is kept in sight. */
  follow = false;
  /** Whether the user wants that in every world. */
  alwaysFollows = false;
  private width = 0;
  private height = 0;

  constructor(private readonly robot: () => number) {}

  /** Adapt to the size of the canvas and of the world. */
  resize(width: number, height: number, size: Point, robot: Point | undefined): void {
    [this.width, this.height] = [width, height];
    if (this.mode === "auto") this.arrange(size, robot);
    else if (this.mode === "all") this.showAll(size);
    else this.clamp(size);
  }

  private scaleOfAll([width, height]: Point): number {
    return Math.min(this.width / (width + 2 * MARGIN), this.height / (height + 2 * MARGIN)) || 1;
  }

  /** Show all of the world; less of it around the robot where that would be too small to be seen. */
  arrange(size: Point, robot: Point | undefined): void {
    this.mode = "auto";
    const all = this.scaleOfAll(size);
    const legible = SMALLEST_ROBOT / (2 * this.robot());
    this.scale = Math.max(all, legible);
    if (this.alwaysFollows) this.magnify(all);
    this.follow = this.scale > all;
    this.centre(robot && this.follow ? robot : [size[0] / 2, size[1] / 2], size);
  }

  /** Show all of the world, however small. */
  showAll(size: Point): void {
    this.scale = this.scaleOfAll(size);
    this.centre([size[0] / 2, size[1] / 2], size);
    this.mode = "all";
    this.follow = false;
  }

  /** Keep the robot in sight from now on, magnified so that there is something to follow. */
  begin(robot: Point, size: Point): void {
    this.magnify(this.scaleOfAll(size));
    this.mode = "free";
    this.follow = true;
    this.centre(robot, size);
  }

  /** Show the same part of the world from now on, wherever the robot is. */
  end(): void {
    this.mode = "free";
    this.follow = false;
  }

  private magnify(all: number): void {
    if (this.scale < 1.5 * all) this.scale = 2 * all;
  }

  /** Show the surroundings of a point; no more of what is outside of the world than needed. */
  private centre([x, y]: Point, size: Point): void {
    this.x = this.width / 2 - x * this.scale;
    this.y = this.height / 2 + y * this.scale;
    this.clamp(size);
  }

  private clamp([width, height]: Point): void {
    const edge = MARGIN * this.scale;
    const within = (offset: number, length: number, room: number) =>
      length + 2 * edge <= room
        ? (room - length) / 2
        : Math.min(edge, Math.max(room - length - edge, offset));
    this.x = within(this.x, width * this.scale, this.width);
    this.y = within(this.y - height * this.scale, height * this.scale, this.height) + height * this.scale;
  }

  /** Move so that a point is away from the edges of the canvas; return whether anything moved. */
  keepInSight(point: Point, size: Point): boolean {
    const [px, py] = this.outside(point);
    const [x, y] = [this.x, this.y];
    const into = (at: number, room: number) => Math.min(room * (1 - INNER), Math.max(room * INNER, at)) - at;
    this.x += into(px, this.width);
    this.y += into(py, this.height);
    this.clamp(size);
    return Math.hypot(this.x - x, this.y - y) > 0.01;
  }

  pan(dx: number, dy: number): void {
    this.x += dx;
    this.y += dy;
    this.end();
  }

  /** Zoom by a factor, keeping the point (x, y) of the canvas where it is. */
  zoom(factor: number, size: Point, x = this.width / 2, y = this.height / 2): void {
    const least = Math.min(this.scaleOfAll(size) / 2, this.scale);
    const scale = Math.min(Math.max(LARGEST, this.scale), Math.max(least, this.scale * factor));
    const ratio = scale / this.scale;
    this.x = x - (x - this.x) * ratio;
    this.y = y - (y - this.y) * ratio;
    this.scale = scale;
    this.mode = "free";
  }

  /** The point of the world at a point of the canvas. */
  inside(x: number, y: number): Point {
    return [(x - this.x) / this.scale, (this.y - y) / this.scale];
  }

  /** The point of the canvas at a point of the world. */
  outside([x, y]: Point): Point {
    return [this.x + x * this.scale, this.y - y * this.scale];
  }

  /** Make a context draw in metres, y up. */
  transform(c: CanvasRenderingContext2D, ratio: number): void {
    const scale = ratio * this.scale;
    c.setTransform(scale, 0, 0, -scale, ratio * this.x, ratio * this.y);
  }

  /** Where the origin of the world is, how many pixels make a metre, and the canvas's height: for tests. */
  get place(): string {
    return [this.x, this.y, this.scale, this.height].map((number) => number.toFixed(2)).join(" ");
  }

  get middle(): Point {
    return this.inside(this.width / 2, this.height / 2);
  }
}
