/** Zoom and pan: which part of a drawing is shown, and how large. */

export interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

const SMALLEST = 0.2;
const LARGEST = 4;

export class Camera {
  x = 0;
  y = 0;
  scale = 1;
  /** Whether the user has zoomed or panned. */
  moved = false;
  /** Whether it has shown anything yet. */
  placed = false;

  /** Show all of a box, centred, magnified at most `most` times. */
  fit(box: Box, width: number, height: number, most = 1.25): void {
    if (!width || !height || !box.width || !box.height) return;
    const scale = Math.max(SMALLEST, Math.min(width / box.width, height / box.height, most));
    this.set({
      x: width / 2 - (box.x + box.width / 2) * scale,
      y: height / 2 - (box.y + box.height / 2) * scale,
      scale,
    });
  }

  set({ x, y, scale }: { x: number; y: number; scale: number }): void {
    this.x = x;
    this.y = y;
    this.scale = scale;
    this.placed = true;
  }

  /** Zoom by a factor, keeping the point (x, y) of the screen where it is. */
  zoom(factor: number, x: number, y: number): void {
    const scale = Math.min(LARGEST, Math.max(SMALLEST, this.scale * factor));
    const ratio = scale / this.scale;
    this.x = x - (x - this.x) * ratio;
    this.y = y - (y - this.y) * ratio;
    this.scale = scale;
    this.moved = true;
  }

  pan(dx: number, dy: number): void {
    this.x += dx;
    this.y += dy;
    this.moved = true;
  }

  /** The point of the drawing under a point of the screen. */
  inside(x: number, y: number): [number, number] {
    return [(x - this.x) / this.scale, (y - this.y) / this.scale];
  }

  get transform(): string {
    return `translate(${this.x.toFixed(2)} ${this.y.toFixed(2)}) scale(${this.scale.toFixed(4)})`;
  }
}
