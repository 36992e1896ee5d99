/** The canvas of a world: a cached layer for what stands still, and frames interpolated between poses. */

import { Camera } from "../graph/camera";
import type { Point, StrokeView, WorldView } from "../protocol";
import { complete, completeStroke, type FullStroke, type FullWorld } from "./complete";
import { type Palette, paintFloor, paintMovers, paintStroke } from "./paint";
import { between, firstPoses, type Snapshot } from "./poses";

const SPAN = 110; // ms over which a new pose is approached at most: they come ten times a second
const CALM = 30; // ms between two pictures at least: more cannot be seen, and typing needs the time

export class Stage {
  readonly canvas = document.createElement("canvas");
  readonly camera = new Camera();
  world: FullWorld | null = null;
  palette: Palette;
  /** The stroke that is being drawn and not yet part of the world. */
  sketch: FullStroke | null = null;
  private ink: FullStroke[] = [];
  private readonly floor = document.createElement("canvas");
  private floorStale = true;
  private before: Snapshot | null = null;
  private after: Snapshot | null = null;
  private arrived = 0;
  private span = 1;
  private scheduled = 0;
  private painted = 0;

  constructor(private readonly readPalette: () => Palette) {
    this.palette = readPalette();
  }

  show(view: WorldView | null): void {
    const world = view && complete(view);
    const other = !this.world || !world || String(this.world.size) !== String(world.size);
    this.world = world;
    this.ink = [];
    const fits =
      world &&
      this.after?.robots.length === world.robots.length &&
      this.after.solids.length === world.solids.length;
    if (world && !fits) this.before = this.after = firstPoses(world);
    if (other && !this.camera.moved) this.fit();
    this.repaint();
  }

  /** Keep the first strokes of ink, then append these. */
  draw(first: number, strokes: StrokeView[]): void {
    const only = first === this.ink.length && !this.floorStale; // the usual case: something is added
    const fresh = strokes.map(completeStroke);
    this.ink = [...this.ink.slice(0, first), ...fresh];
    const c = only ? this.floor.getContext("2d") : null;
    if (!c) {
      this.repaint();
      return;
    }
    this.transform(c);
    for (const stroke of fresh) paintStroke(c, stroke, this.palette);
    this.wake();
  }

  move(next: Snapshot, now: number): void {
    this.before = this.current(now) ?? next;
    this.span = Math.max(1, Math.min(SPAN, now - this.arrived));
    this.after = next;
    this.arrived = now;
    this.wake();
  }

  get latest(): Snapshot | null {
    return this.after;
  }

  private current(now: number): Snapshot | null {
    if (!this.before || !this.after) return this.after;
    const share = Math.min(1, (now - this.arrived) / this.span);
    return share >= 1 ? this.after : between(this.before, this.after, share);
  }

  resize(): void {
    const ratio = window.devicePixelRatio || 1;
    this.canvas.width = this.floor.width = Math.round(this.canvas.clientWidth * ratio);
    this.canvas.height = this.floor.height = Math.round(this.canvas.clientHeight * ratio);
    if (!this.camera.moved) this.fit();
    this.repaint();
  }

  /** Show all of the world, y up. */
  fit(): void {
    this.camera.moved = false;
    if (!this.world) return;
    const [width, height] = this.world.size;
    const margin = 0.06;
    const box = { x: -margin, y: -margin, width: width + 2 * margin, height: height + 2 * margin };
    this.fitted = Math.min(this.canvas.clientWidth / box.width, this.canvas.clientHeight / box.height) || 1;
    this.camera.fit(box, this.canvas.clientWidth / this.fitted, this.canvas.clientHeight / this.fitted, 1);
  }

  /** Pixels per metre when all is shown: the camera zooms relative to that. */
  private fitted = 1;

  get pixelsPerMetre(): number {
    return this.fitted * this.camera.scale;
  }

  /** The point of the world at a point of the canvas. */
  inside(x: number, y: number): Point {
    const [wx, wy] = this.camera.inside(x / this.fitted, y / this.fitted);
    return [wx, (this.world?.size[1] ?? 0) - wy];
  }

  pan(dx: number, dy: number): void {
    this.camera.pan(dx / this.fitted, dy / this.fitted);
    this.repaint();
  }

  zoom(factor: number, x = this.canvas.clientWidth / 2, y = this.canvas.clientHeight / 2): void {
    this.camera.zoom(factor, x / this.fitted, y / this.fitted);
    this.repaint();
  }

  repaint(): void {
    this.floorStale = true;
    this.wake();
  }

  retheme(): void {
    this.palette = this.readPalette();
    this.repaint();
  }

  wake(): void {
    if (this.scheduled) return;
    const soon = () => {
      this.scheduled = requestAnimationFrame((now) => this.picture(now));
    };
    const early = this.painted + CALM - performance.now();
    if (early > 0 && !this.floorStale) this.scheduled = window.setTimeout(soon, early);
    else soon();
  }

  private transform(c: CanvasRenderingContext2D): void {
    const ratio = (window.devicePixelRatio || 1) * this.fitted;
    const { x, y, scale } = this.camera;
    const height = this.world?.size[1] ?? 0;
    c.setTransform(ratio * scale, 0, 0, -ratio * scale, ratio * x, ratio * (y + height * scale));
  }

  private picture(now: number): void {
    this.scheduled = 0;
    const c = this.canvas.getContext("2d");
    if (!c || !this.canvas.width) return;
    this.painted = now;
    if (this.floorStale) this.paintLayer();
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.clearRect(0, 0, this.canvas.width, this.canvas.height);
    c.drawImage(this.floor, 0, 0);
    const current = this.current(now);
    if (!this.world || !current) return;
    this.transform(c);
    if (this.sketch) paintStroke(c, this.sketch, this.palette);
    paintMovers(c, this.world, current, this.palette, this.pixelsPerMetre);
    if (now - this.arrived < this.span) this.wake();
  }

  private paintLayer(): void {
    const c = this.floor.getContext("2d");
    if (!c) return;
    this.floorStale = false;
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.clearRect(0, 0, this.floor.width, this.floor.height);
    if (!this.world) return;
    this.transform(c);
    paintFloor(c, this.world, this.ink, this.palette);
  }
}
