/** The canvas of a world: a cached layer for what stands still, and frames interpolated between poses. */

import type { Point, StrokeView, WorldView } from "../protocol";
import type { Foretold } from "../session/state";
import type { KeptSwitch } from "../ui/kept";
import { pngOf } from "../ui/picture";
import type { Brush } from "./brush";
import { complete, completeStroke, type FullStroke, type FullWorld } from "./complete";
import { paintGhost, paintParting } from "./ghost";
import {
  LATER,
  OLDER,
  paintBar,
  paintFaintTrail,
  paintGrid,
  paintOutline,
  paintSelection,
  paintTrail,
} from "./overlay";
import { paintFloor, paintRobots, paintSolids, paintStroke, paintZoneNames } from "./paint";
import { ofRobot, type Palette, type Style } from "./palette";
import { between, firstPoses, type Snapshot } from "./poses";
import { paintStart } from "./robot";
import { keyOf, type Shape, shapeOf, type Thing } from "./things";
import { FADES, Trail } from "./trail";
import { Viewport } from "./viewport";

const SPAN = 110; // ms over which a new pose is approached at most: they come ten times a second
const CALM = 30; // ms between two pictures at least: more cannot be seen, and typing needs the time
const SETTLED = 5; // s of the trail that may have faded before they are painted with what stands still
const NEARBY = 0.01; // metres between a robot and its start: the outline would only blur it

export class Stage {
  readonly canvas = document.createElement("canvas");
  readonly viewport = new Viewport(() => this.world?.robots[0]?.radius ?? 0.08);
  readonly trail = new Trail();
  /** The trails of the second robot, the third …; the states of a program are those of the first. */
  private others: Trail[] = [];
  world: FullWorld | null = null;
  palette: Palette;
  /** The stroke that is being drawn and not yet part of the world. */
  sketch: FullStroke | null = null;
  selected: Thing | null = null;
  /** Of a new thing that is being drawn. */
  outline: Shape | null = null;
  /** Whether the user is about to change something: nothing that comes from the kernel ends that. */
  busy = false;
  /** The number of edits that the kernel has not answered yet. */
  awaited = 0;
  isPast = false;
  whatIf: Foretold | null = null;
  styleOf: (state: string) => Style = () => ({ color: "gray", dash: [] });
  /** Called when another part of the world may be shown, or the robot no longer followed. */
  viewed = () => {};
  /** The shapes that things will have, by thing, until the kernel has answered all edits. */
  private readonly drafts = new Map<string, Shape>();
  private ink: FullStroke[] = [];
  /** What each robot says; empty if none says anything. */
  says: readonly string[] = [];
  private readonly floor = document.createElement("canvas");
  private floorStale = true;
  /** The time up to which the floor has the faint trail. */
  private settled = 0;
  private before: Snapshot | null = null;
  latest: Snapshot | null = null;
  private arrived = 0;
  private span = 1;
  private scheduled = 0;
  private painted = 0;
  /** Pixels of the canvas per px of the page. */
  private ratio = 1;

  constructor(
    private readonly readPalette: () => Palette,
    private readonly showsGrid: Pick<KeptSwitch, "on">,
    readonly showsTrail: Pick<KeptSwitch, "on">,
  ) {
    this.palette = readPalette();
  }

  show(view: WorldView | null): void {
    const world = view && complete(view);
    const other = !this.world || !world || String(this.world.size) !== String(world.size);
    if (other || this.world?.name !== world?.name) {
      this.clearTrails();
      this.drafts.clear();
      this.selected = null;
    }
    this.world = world;
    this.others = (world?.robots.slice(1) ?? []).map((_, i) => this.others[i] ?? new Trail());
    this.ink = [];
    this.says = [];
    this.clearDrafts();
    if (world) this.before = this.latest = firstPoses(world, this.latest); // its solids are where they are now
    if (other) this.arrange();
    this.repaint();
  }

  get isHeld(): boolean {
    return this.busy || this.awaited > 0;
  }

  /** Show a thing in the shape that it will have, or (null) as it is. */
  setDraft(thing: Thing, shape: Shape | null): void {
    if (shape) this.drafts.set(keyOf(thing), shape);
    else this.drafts.delete(keyOf(thing));
    this.wake();
  }

  draftOf(thing: Thing): Shape | null {
    return this.drafts.get(keyOf(thing)) ?? null;
  }

  /** Forget what was drawn or placed, unless more is coming: by now it is part of the world. */
  clearDrafts(): void {
    if (this.isHeld) return;
    this.sketch = this.outline = null;
    this.drafts.clear();
    this.wake();
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
    this.viewport.transform(c, this.ratio);
    for (const stroke of fresh) paintStroke({ c, palette: this.palette }, stroke);
    this.wake();
  }

  move(next: Snapshot, now: number, state: string): void {
    this.before = this.current(now) ?? next;
    this.span = Math.max(1, Math.min(SPAN, now - this.arrived));
    this.latest = next;
    this.arrived = now;
    if (!this.isPast)
      next.robots.forEach(({ pose }, i) =>
        (i ? this.others[i - 1] : this.trail)?.add(next.time, pose, state),
      );
    this.clearDrafts(); // the kernel replies before it shows in a frame what it has done
    this.wake();
  }

  /** All trails, that of the first robot on top: it shows states, the others the colours of their robots. */
  private get trails(): { trail: Trail; style: Stage["styleOf"] }[] {
    const others = this.others.map((trail, i) => ({
      trail,
      style: () => ({ color: ofRobot(this.palette, i + 1).mark, dash: [] }),
    }));
    return [...others, { trail: this.trail, style: this.styleOf }];
  }

  clearTrails(): void {
    for (const trail of [this.trail, ...this.others]) trail.clear();
  }

  /** The shape of a thing as it is shown. */
  shape(thing: Thing): Shape | null {
    return this.draftOf(thing) ?? (this.world && this.latest && shapeOf(this.world, this.latest, thing));
  }

  private current(now: number): Snapshot | null {
    if (!this.before || !this.latest) return this.latest;
    const share = Math.min(1, (now - this.arrived) / this.span);
    return share >= 1 ? this.latest : between(this.before, this.latest, share);
  }

  private get robotAt(): Point | undefined {
    const [x, y] = this.latest?.robots[0]?.pose ?? [];
    return x === undefined || y === undefined ? undefined : [x, y];
  }

  resize(): void {
    this.ratio = window.devicePixelRatio;
    const { canvas, ratio } = this;
    canvas.width = this.floor.width = Math.round(canvas.clientWidth * ratio);
    canvas.height = this.floor.height = Math.round(canvas.clientHeight * ratio);
    if (!this.world) return;
    this.viewport.resize(canvas.clientWidth, canvas.clientHeight, this.world.size, this.robotAt);
    this.repaint();
  }

  /** Show the world as at first. */
  arrange(): void {
    if (!this.world) return;
    const { clientWidth, clientHeight } = this.canvas;
    this.viewport.arrange(this.world.size, this.robotAt);
    this.viewport.resize(clientWidth, clientHeight, this.world.size, this.robotAt);
    this.repaint();
  }

  showAll(): void {
    if (this.world) this.viewport.showAll(this.world.size);
    this.repaint();
  }

  get follows(): boolean {
    return this.viewport.follow;
  }

  set follows(on: boolean) {
    if (on && this.world && this.robotAt) this.viewport.begin(this.robotAt, this.world.size);
    else this.viewport.end();
    this.repaint();
  }

  pan(dx: number, dy: number): void {
    this.viewport.pan(dx, dy);
    this.repaint();
  }

  zoom(factor: number, x?: number, y?: number): void {
    if (this.world) this.viewport.zoom(factor, this.world.size, x, y);
    this.repaint();
  }

  repaint(): void {
    this.floorStale = true;
    this.viewed();
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

  /** What is shown, as a picture on paper: without what only a pointer needs. */
  async image(): Promise<Blob> {
    const copy = document.createElement("canvas");
    copy.width = this.canvas.width;
    copy.height = this.canvas.height;
    const c = copy.getContext("2d")!;
    c.fillStyle = this.palette.paper;
    c.fillRect(0, 0, copy.width, copy.height);
    c.drawImage(this.floor, 0, 0);
    const current = this.current(performance.now());
    if (this.world && current) this.paintOver(c, this.world, current);
    return pngOf(copy);
  }

  private picture(now: number): void {
    this.scheduled = 0;
    if (this.ratio !== window.devicePixelRatio) this.resize(); // the window is on another screen
    const c = this.canvas.getContext("2d");
    if (!c || !this.canvas.width) return;
    this.painted = now;
    const current = this.current(now);
    const [x, y] = current?.robots[0]?.pose ?? [];
    // what is dragged would run away from the pointer
    if (this.viewport.follow && !this.busy && this.world && x !== undefined && y !== undefined)
      this.floorStale = this.viewport.keepInSight([x, y], this.world.size) || this.floorStale;
    if (current && this.showsTrail.on) this.settle(current.time);
    if (this.floorStale) this.paintLayer();
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.clearRect(0, 0, this.canvas.width, this.canvas.height);
    c.drawImage(this.floor, 0, 0);
    if (!this.world || !current) return;
    this.paintOver(c, this.world, current);
    this.paintHandles(c);
    if (now - this.arrived < this.span) this.wake();
  }

  private paintOver(c: CanvasRenderingContext2D, world: FullWorld, current: Snapshot): void {
    const { viewport, palette } = this;
    const brush: Brush = { c, palette, pixels: viewport.scale };
    viewport.transform(c, this.ratio);
    if (this.showsTrail.on) {
      for (const { trail, style } of this.trails) {
        const range: [number, number] = [trail.after(this.settled), trail.after(current.time - FADES)];
        paintFaintTrail(brush, trail, range, OLDER, style);
        paintTrail(brush, trail, current.time, style);
      }
    }
    if (this.sketch) paintStroke(brush, this.sketch);
    paintZoneNames(brush, world); // the trail would make them illegible
    if (this.whatIf) paintGhost(brush, world, this.whatIf, current);
    world.robots.forEach(({ pose, radius }, i) => {
      const [x, y] = current.robots[i]?.pose ?? pose;
      if (Math.hypot(x - pose[0], y - pose[1]) > NEARBY)
        paintStart({ ...brush, palette: ofRobot(palette, i) }, pose, radius);
    });
    paintSolids(brush, world, current);
    c.save();
    c.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    paintBar(brush, this.canvas.height / this.ratio, this.showsGrid.on); // no robot hides below it
    c.restore();
    paintRobots(brush, world, current, this.says);
    if (this.whatIf) paintParting(brush, this.whatIf);
  }

  /** Paint what a pointer would take hold of, where the world is painted. */
  private paintHandles(c: CanvasRenderingContext2D): void {
    const { viewport, palette, selected, outline } = this;
    const brush: Brush = { c, palette, pixels: viewport.scale };
    const shape = selected && this.shape(selected);
    if (selected && shape) paintSelection(brush, selected, shape);
    if (outline) paintOutline(brush, outline, 5, 4);
  }

  /** Paint the faint trail with the floor, which is rare: it may be long. */
  private settle(now: number): void {
    const until = now - FADES;
    const isOver = this.isPast
      ? until !== this.settled
      : until > this.settled + SETTLED || until < this.settled;
    if (this.floorStale || isOver) [this.settled, this.floorStale] = [until, true];
  }

  private paintLayer(): void {
    const c = this.floor.getContext("2d");
    if (!c) return;
    this.floorStale = false;
    this.canvas.dataset.view = this.viewport.place;
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.clearRect(0, 0, this.floor.width, this.floor.height);
    if (!this.world) return;
    this.viewport.transform(c, this.ratio);
    const { settled, palette } = this;
    const brush: Brush = { c, palette, pixels: this.viewport.scale };
    paintFloor(brush, this.world, this.ink);
    if (this.showsGrid.on) paintGrid(brush, this.world.size);
    if (!this.showsTrail.on) return;
    for (const { trail, style } of this.trails) {
      paintFaintTrail(brush, trail, [trail.after(settled + FADES), trail.points.length], LATER, style);
      paintFaintTrail(brush, trail, [0, trail.after(settled)], OLDER, style);
    }
  }
}
