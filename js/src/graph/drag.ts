/** States dragged by the mouse: they stay under the pointer, and where they are dropped. */

import type { Layout } from "../protocol";
import { moveState, placeOf } from "./draw";

const SEND_EVERY = 40; // ms between two places of a dragged state
const NEAR = 0.2; // px
const PATIENCE = 10_000; // ms that the kernel has to draw a state where it was dropped: a busy machine takes seconds

interface Dragged {
  node: Element;
  path: string;
  x: number;
  y: number;
  /** Where it was. */
  home: { x: number; y: number };
}

export class Dragging {
  private dragged: Dragged | null = null;
  private dropped = false;
  private sent = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** `send` pins a state to a place; `ended` is called when it is drawn there. */
  constructor(
    private readonly send: (path: string, x: number, y: number) => void,
    private readonly ended: () => void,
  ) {}

  begin(node: Element): void {
    this.clear();
    const [x, y] = placeOf(node);
    this.dragged = { node, path: node.getAttribute("data-lrp-state") ?? "", x, y, home: { x, y } };
    this.dropped = false;
    node.setAttribute("data-dragged", "");
  }

  /** Move by so many px of the drawing. */
  move(dx: number, dy: number, time: number): void {
    const { dragged } = this;
    if (!dragged) return;
    dragged.x += dx;
    dragged.y += dy;
    moveState(dragged.node, dragged.x, dragged.y);
    if (time - this.sent < SEND_EVERY) return;
    this.sent = time;
    this.pin(dragged);
  }

  drop(): void {
    if (!this.dragged) return;
    this.pin(this.dragged);
    this.dropped = true;
    this.timer = setTimeout(() => this.end(), PATIENCE);
  }

  /** Pin a state to a place, also one that is being dragged, or was dropped elsewhere and is not drawn there yet. */
  put(path: string, x: number, y: number): void {
    const { dragged } = this;
    if (dragged?.path === path) {
      Object.assign(dragged, { x, y });
      moveState(dragged.node, x, y);
    }
    this.send(path, x, y);
  }

  /** Return the state to where it was. */
  cancel(): void {
    const { dragged } = this;
    if (!dragged) return;
    Object.assign(dragged, dragged.home);
    moveState(dragged.node, dragged.x, dragged.y);
    this.drop();
  }

  /** End the dragging if a layout has the dropped state in its place. */
  drawn(layouts: readonly Layout[]): void {
    const { dragged } = this;
    if (!dragged || !this.dropped) return;
    const shape = layouts.flatMap(({ states }) => states).find(({ id }) => id === dragged.path);
    if (shape && Math.hypot(shape.x - dragged.x, shape.y - dragged.y) > NEAR) return;
    this.end();
  }

  private pin({ path, x, y }: Dragged): void {
    this.send(path, Math.round(x * 10) / 10, Math.round(y * 10) / 10);
  }

  private end(): void {
    if (!this.dragged) return;
    this.clear();
    this.ended();
  }

  private clear(): void {
    clearTimeout(this.timer);
    this.dragged?.node.removeAttribute("data-dragged");
    this.dragged = null;
  }
}
