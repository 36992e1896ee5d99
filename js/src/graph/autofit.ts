/**
 * The camera's own movements. It fits a drawing into the panel when another one is shown and when part of it
 * gets out of view; it glides, and waits while the user types or points. What would have to shrink below a
 * legible size is larger than the panel instead, and is scrolled.
 */

import type { Box, Camera } from "./camera";

/** The smallest scale chosen without the user: labels of 11.5 px are 9 px high. */
export const LEGIBLE = 9 / 11.5;
const QUIET = 1000; // ms without a key, or a move of the pointer in the panel, before anything moves
const GLIDE = 260; // ms
const EDGE = 14; // px between the panel's border and what is brought into view

/** Where something is in the drawing now; null when it is gone. It may be moved before it is brought into view. */
type Subject = () => Box | null;

interface View {
  x: number;
  y: number;
  scale: number;
}

export class AutoFit {
  private camera: Camera;
  private content: Box = { x: 0, y: 0, width: 0, height: 0 };
  /** What is to be brought into view when the user pauses; until it is. */
  private wanted: Subject | null = null;
  /** Of the panel, when it was last seen: in a tab that is not shown it has none. */
  private size = { width: 0, height: 0 };
  private lastAct = Number.NEGATIVE_INFINITY;
  private pressed = false;
  private held = false;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private gliding = 0;

  constructor(
    private readonly svg: SVGSVGElement,
    camera: Camera,
    private readonly place: () => void,
    /** Draw something else if that is for a panel of this size; returns whether it did. */
    private readonly redraw: () => boolean = () => false,
  ) {
    this.camera = camera;
  }

  /** Show another drawing, at once. `focus` is in view if not all of it can be. */
  show(camera: Camera, content: Box, focus: Box | null): void {
    this.stop();
    this.camera = camera;
    this.content = content;
    this.wanted = null;
    this.measure();
    if (!camera.placed || this.isShrunk()) this.jump(focus);
    else this.place();
    this.check();
  }

  /** The drawing has changed; `fresh` is what is new in it. */
  update(content: Box, fresh: Subject | null): void {
    this.content = content;
    this.wanted = fresh ?? this.wanted;
    this.check();
  }

  /** All states have other places: fit them into the panel. */
  rearranged(content: Box, focus: Box | null): void {
    this.content = content;
    this.wanted = null;
    this.camera.moved = false;
    if (this.camera.placed) this.glide(this.target(focus && this.opening(focus)));
    else this.jump(focus);
  }

  /** The size of the panel has changed: what is in its middle stays there. */
  resized(focus: Box | null): void {
    const { camera } = this;
    if (camera.placed && !this.isQuiet) {
      this.stop();
      this.place();
      this.check();
      return;
    }
    if (this.redraw()) return;
    const before = this.size;
    this.measure();
    if (!camera.placed) {
      this.jump(focus);
      return;
    }
    if (this.size === before) return;
    this.stop();
    camera.x += (this.size.width - before.width) / 2;
    camera.y += (this.size.height - before.height) / 2;
    if (this.isShrunk() || (!camera.moved && this.isCutOff())) this.jump(null);
    else this.place();
    this.check();
  }

  /** Show all of a drawing at once, in the panel as large as it is now: the user asked for it. */
  whole(content: Box): void {
    this.stop();
    this.measure();
    this.camera.fit(content, this.size.width, this.size.height);
    this.camera.moved = this.camera.scale < LEGIBLE; // the user prefers all of it to legible names
    this.place();
  }

  /** Bring something into view when the user pauses, or at once if the user asked for it. */
  reveal(wanted: Subject, now = false): void {
    this.wanted = wanted;
    if (now) this.bringWantedIntoView();
    else this.check();
  }

  /** Bring something into view when the user pauses, unless something else comes into view then. */
  suggest(wanted: Subject): void {
    this.wanted ??= wanted;
    this.check();
  }

  /** The user types or points: what moves stops, and goes on after a pause; not while a button is down. */
  acted(pressed = false): void {
    this.lastAct = performance.now();
    this.pressed = pressed;
    this.stop();
    this.check();
  }

  /** Nothing moves until what was dragged is drawn where it was dropped. */
  hold(): void {
    this.stop();
    this.held = true;
  }

  /** What was dragged out of view stays there until the drawing changes. */
  release(): void {
    this.held = false;
  }

  /** Stop gliding where the camera is. */
  stop(): void {
    cancelAnimationFrame(this.gliding);
    clearTimeout(this.timer);
    this.svg.removeAttribute("data-unsettled");
  }

  private measure(): void {
    const { clientWidth: width, clientHeight: height } = this.svg;
    if (width && height) this.size = { width, height };
  }

  /** Whether the panel is shown, and not as large as when it was last seen. */
  private isResized(): boolean {
    const { clientWidth: width, clientHeight: height } = this.svg;
    return width > 0 && height > 0 && (width !== this.size.width || height !== this.size.height);
  }

  /** Whether the user neither types nor points. */
  get isQuiet(): boolean {
    return !this.held && !this.pressed && performance.now() - this.lastAct >= QUIET;
  }

  private readonly check = (): void => {
    const { camera } = this;
    if (!camera.placed || this.held || this.pressed) return;
    const isResized = this.isResized();
    if (!(isResized || this.wanted || (!camera.moved && this.isCutOff()))) return;
    clearTimeout(this.timer);
    if (!this.isQuiet) {
      this.svg.setAttribute("data-unsettled", "");
      this.timer = setTimeout(this.check, this.lastAct + QUIET - performance.now() + 1);
      return;
    }
    if (isResized) {
      this.resized(null);
      return;
    }
    if (!camera.moved && this.isCutOff()) this.glide(this.target(this.wanted?.()));
    else this.bringWantedIntoView();
  };

  private bringWantedIntoView(): void {
    const { camera, size } = this;
    const wanted = this.wanted?.();
    if (!size.width) return;
    const by = (at: "x" | "y", extent: "width" | "height") =>
      wanted ? shift(wanted[at] * camera.scale + camera[at], wanted[extent] * camera.scale, size[extent]) : 0;
    const [x, y] = [by("x", "width"), by("y", "height")];
    if (x || y) this.glide({ x: camera.x + x, y: camera.y + y, scale: camera.scale });
    else this.arrived();
  }

  /** Whether it was fitted into a panel that was smaller. */
  private isShrunk(): boolean {
    const { moved, scale } = this.camera;
    return !moved && scale < 1 && this.scale() > scale;
  }

  /** Whether part of the drawing is out of view that need not be. */
  private isCutOff(): boolean {
    const { camera, content, size } = this;
    if (!size.width || !content.width) return false;
    const ends = (at: number, length: number, offset: number, room: number): boolean => {
      const first = at * camera.scale + offset;
      const last = first + length * camera.scale;
      const fits = last - first <= room + 1;
      return fits
        ? first < -1 || last > room + 1
        : camera.scale > LEGIBLE || first > EDGE || last < room - EDGE;
    };
    return (
      ends(content.x, content.width, camera.x, size.width) ||
      ends(content.y, content.height, camera.y, size.height)
    );
  }

  /** Where the camera shows everything, or as much as is legible: then `focus`, or what is in the middle now. */
  private target(focus?: Box | null): View {
    const { camera, content } = this;
    const { width, height } = this.size;
    const scale = this.scale();
    const [x, y] = camera.inside(width / 2, height / 2);
    const middle = focus ? { x: focus.x + focus.width / 2, y: focus.y + focus.height / 2 } : { x, y };
    return {
      x: offset(content.x * scale, content.width * scale, middle.x * scale, width),
      y: offset(content.y * scale, content.height * scale, middle.y * scale, height),
      scale,
    };
  }

  private scale(): number {
    const { width, height } = this.size;
    return Math.max(LEGIBLE, Math.min(width / this.content.width, height / this.content.height, 1.25));
  }

  /** The middle of a view that begins where the drawing does, or as near to that as has `focus` in it. */
  private opening(focus: Box): Box {
    const { content } = this;
    const { width, height } = this.size;
    const scale = this.scale();
    const middle = (begin: number, end: number, room: number) =>
      Math.max(begin + room / 2, end + EDGE / scale - room / 2);
    const x = middle(content.x, focus.x + focus.width, width / scale);
    const y = middle(content.y, focus.y + focus.height, height / scale);
    return { x, y, width: 0, height: 0 };
  }

  private jump(focus: Box | null): void {
    const { camera, content } = this;
    const { width, height } = this.size;
    if (!width || !height || !content.width || !content.height) return;
    const shown = focus ?? (camera.placed ? null : corner(content));
    camera.set(this.target(shown && this.opening(shown)));
    this.place();
  }

  private glide(to: View): void {
    this.stop();
    const { camera } = this;
    const from = { x: camera.x, y: camera.y, scale: camera.scale };
    const begun = performance.now();
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const step = () => {
      const time = still ? 1 : Math.min(1, (performance.now() - begun) / GLIDE);
      const share = time * time * (3 - 2 * time);
      const at = (key: keyof View) => from[key] + (to[key] - from[key]) * share;
      camera.set({ x: at("x"), y: at("y"), scale: at("scale") });
      this.place();
      if (time < 1) this.gliding = requestAnimationFrame(step);
      else this.arrived();
    };
    this.svg.setAttribute("data-unsettled", "");
    step();
  }

  private arrived(): void {
    this.wanted = null;
    this.svg.removeAttribute("data-unsettled");
  }
}

/** How far something has to move to be in view, px. */
function shift(first: number, length: number, room: number): number {
  const last = first + length;
  if (first < EDGE || length > room - 2 * EDGE) return first >= 0 && last <= room ? 0 : EDGE - first;
  return last > room - EDGE ? Math.min(0, room - EDGE - last) : 0;
}

/** Where a drawing begins in the panel: in its middle, or scrolled to a point if it is longer. */
function offset(begin: number, length: number, middle: number, room: number): number {
  if (length <= room) return (room - length) / 2 - begin;
  return Math.min(-begin, Math.max(room - length - begin, room / 2 - middle));
}

function corner({ x, y }: Box): Box {
  return { x, y, width: 0, height: 0 };
}
