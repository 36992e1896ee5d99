/** The rate slider: 1 to 100 Hz in equal ratios, its right end is 0, as fast as possible. */

const TOP = 100;
const FREE = 108;

export const SLIDER = { min: 0, max: FREE, step: 1 } as const;

/** Hz at a position of the slider. */
export function rateAt(position: number): number {
  return position > TOP ? 0 : Math.round(10 ** (position / 50));
}

/** The position that shows a rate. */
export function positionOf(rate: number): number {
  if (rate <= 0) return FREE;
  return Math.min(TOP, Math.max(0, Math.round(50 * Math.log10(rate))));
}

export function rateText(rate: number): string {
  return rate > 0 ? `${rate} Hz` : "free";
}
