/** What an edit is going to do: after each one the next seconds are asked for, and shown as a ghost's way. */

import type { WhatIf } from "../protocol";
import { newest } from "../session/newest";
import type { Lab } from "../session/store";
import type { KeptSwitch } from "../ui/kept";
import { ghostAt } from "./ghost";

const SECONDS = 3;
const CALM = 300; // ms after an edit: first it is applied and drawn
const LATE = 1; // s of the session: what is older is no news
const ASTRAY = 0.1; // metres: something else has happened than was foretold

export class Preview {
  /** The newest preview, whether or not it is still shown. */
  private latest: WhatIf | null = null;
  private revision: number | null = null;
  private time = 0;
  private edited = 0; // when, in ms
  private readonly ask: () => void;

  constructor(
    private readonly lab: Lab,
    private readonly foretells: Pick<KeptSwitch, "on">,
    calm = CALM,
  ) {
    this.ask = newest(
      lab.closed,
      () => this.edited + calm,
      () => this.foretell(),
    );
    lab.store.watch(["revision", "snapshot"], (changed) => {
      const { revision } = lab.store.state;
      const isEdit = revision !== this.revision && !changed.has("snapshot");
      this.revision = revision;
      if (!isEdit) return;
      this.edited = performance.now();
      this.ask();
    });
    lab.store.watch(["time", "looking", "world"], () => this.check());
  }

  /** End the preview if it is over or switched off, or if the robot, which is at (x, y), has gone another way. */
  check(at?: readonly number[]): void {
    const { whatIf, time, looking } = this.lab.store.state;
    const isBack = time < this.time;
    this.time = time;
    if (!whatIf || whatIf !== this.latest) return;
    const foretold = at && ghostAt(whatIf.changed.way, time);
    const isAstray = foretold && Math.hypot(at[0]! - foretold[0], at[1]! - foretold[1]) > ASTRAY;
    if (!this.foretells.on || looking || isBack || time >= whatIf.end || isAstray) this.show(null);
  }

  private get isWanted(): boolean {
    const { looking, world, status, settings } = this.lab.store.state;
    const hasBegun = status === "running" || status === "paused";
    return this.foretells.on && !settings.quiet && !looking && world !== null && hasBegun;
  }

  private async foretell(): Promise<void> {
    const { edited } = this;
    const whatIf = this.isWanted && (await this.lab.ask({ type: "what_if", seconds: SECONDS })).what_if;
    if (edited !== this.edited) return; // there is a newer edit
    const isNews = whatIf && this.isWanted && this.lab.store.state.time - whatIf.begin <= LATE;
    this.show(isNews ? whatIf : null);
  }

  private show(whatIf: WhatIf | null): void {
    const { store } = this.lab;
    if (!whatIf && store.state.whatIf !== this.latest) return; // there is none, or it is not a preview
    this.latest = whatIf;
    store.set("whatIf", whatIf);
  }
}
