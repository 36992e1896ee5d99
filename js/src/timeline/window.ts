/** The part of the time that a timeline shows: it follows the present until the user looks elsewhere. */

import type { Store } from "../session/store";
import type { Span } from "./scale";

const USUAL = 30; // s
const SHORTEST = 1;
const LONGEST = 3600;

export class TimeWindow {
  private seconds = USUAL;
  /** Null while it follows the present. */
  private end: number | null = null;

  constructor(
    private readonly store: Store,
    private readonly now: () => number,
  ) {}

  get span(): Span {
    const to = this.end ?? this.latest;
    return { from: Math.max(0, to - this.seconds), to: Math.max(to, this.seconds) };
  }

  /** The last moment that it can show: of the present, or of what would happen after an edit. */
  private get latest(): number {
    const { whatIf, looking } = this.store.state;
    return Math.max(this.now(), (looking && whatIf?.end) ?? 0) + this.seconds * 0.02;
  }

  follow(): void {
    this.end = null;
  }

  stop(): void {
    this.end ??= this.span.to;
  }

  /** End at a time; at the present, follow that. */
  private endAt(time: number): void {
    this.end = time >= this.latest && !this.store.state.looking ? null : Math.min(time, this.latest);
  }

  /** Show a longer or shorter time; one moment stays where it is, the one looked at if no other is meant. */
  zoom(factor: number, moment = this.store.state.looking?.time): void {
    const { from, to } = this.span;
    const fixed = moment ?? (this.end === null ? to : (from + to) / 2);
    const share = (to - fixed) / (to - from);
    this.seconds = Math.min(LONGEST, Math.max(SHORTEST, this.seconds * factor));
    this.endAt(fixed + share * this.seconds);
  }

  /** Move by a share of what is shown. */
  pan(by: number): void {
    const { seconds } = this;
    this.endAt(Math.max(Math.min(seconds, this.latest), this.span.to + by * seconds));
  }

  /** Stay where it is, with the moment looked at in it; without one, follow the present. */
  hold(): void {
    const { looking } = this.store.state;
    const { from, to } = this.span;
    if (!looking) this.follow();
    else if (looking.time < from) this.end = looking.time + this.seconds * 0.9;
    else this.end = looking.time > to ? looking.time + this.seconds * 0.1 : to;
  }

  /** Show what would happen after an edit. */
  makeRoom(): void {
    const { whatIf, looking } = this.store.state;
    if (whatIf && looking && whatIf.end > this.span.to)
      this.end = Math.min(this.latest, looking.time + this.seconds * 0.9);
  }
}
