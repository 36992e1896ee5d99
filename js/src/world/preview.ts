/**
 * What an edit is going to do: after each one the next seconds are asked for, and shown as a ghost's way. While a
 * number is stepped through, also how it would go with the number before and with the next one.
 */

import { newest } from "../session/newest";
import type { Foretold, Stepped } from "../session/state";
import type { Lab } from "../session/store";
import type { KeptSwitch } from "../ui/kept";
import { isOther } from "./courses";
import { ghostAt } from "./ghost";

const SECONDS = 3;
const PACE = {
  calm: 300, // ms after an edit: first it is applied and drawn
  rest: 0.5, // after an answer about a number, as many times as long as it took: the robot needs the kernel, too
};
const LEFT = 1; // s of the session that are foretold, at least, when the answer comes
const LINGER = 10_000; // ms after the last step of a number in which it is foretold again and again
const ASTRAY = 0.1; // metres: something else has happened than was foretold

const TOO_SLOW = `The next ${SECONDS} s take too long to compute, so they are not shown.`;

function sameWith([before, now, beyond]: Stepped["values"]): string {
  return `The next ${SECONDS} s are the same with ${[...new Set([before, now, beyond])].join(", ")}.`;
}

/** Whether a step of a number is seen in the world. */
function areOther({ recorded, changed, tried }: Foretold): boolean {
  return isOther(recorded, changed) || isOther(changed, tried?.beyond ?? changed);
}

export class Preview {
  /** The newest preview, whether or not it is still shown. */
  private latest: Foretold | null = null;
  private revision: number | null = null;
  private time = 0;
  private edited = 0; // when, in ms
  private said = 0; // until when, in s of the session, it is said why nothing is shown
  private renewed: Foretold | null = null;
  private rested = 0;
  private readonly ask: () => void;

  constructor(
    private readonly lab: Lab,
    private readonly foretells: Pick<KeptSwitch, "on">,
    private readonly pace = PACE,
  ) {
    this.ask = newest(
      lab.closed,
      () => Math.max(this.edited + (this.stepped ? 0 : pace.calm), this.rested),
      () => this.foretell(),
    );
    lab.store.watch(["revision", "snapshot"], (changed) => {
      const { revision } = lab.store.state;
      const isEdit = revision !== this.revision && !changed.has("snapshot");
      this.revision = revision;
      if (isEdit && !this.stepped) this.wasEdited();
    });
    lab.store.watch(["stepped"], () => {
      if (this.stepped) this.wasEdited();
    });
    lab.store.watch(["time", "looking", "world"], () => this.check());
  }

  /** End the preview if it is over or switched off, or if the robot, which is at (x, y), has gone another way. */
  check(at?: readonly number[]): void {
    const { whatIf, unforetold, time, looking } = this.lab.store.state;
    const isBack = time < this.time;
    this.time = time;
    if (unforetold && (!this.foretells.on || looking || isBack || time >= this.said)) this.say("");
    if (!whatIf || whatIf !== this.latest) return;
    const foretold = at && ghostAt(whatIf.changed.way, time);
    const isAstray = foretold && Math.hypot(at[0]! - foretold[0], at[1]! - foretold[1]) > ASTRAY;
    if (!this.foretells.on || looking || isBack || time >= whatIf.end || isAstray) this.show(null);
    else if (whatIf.tried && time >= (whatIf.begin + whatIf.end) / 2) this.renew(whatIf);
  }

  /** Ask once more while the number may still be in the hand. */
  private renew(whatIf: Foretold): void {
    const isOver = !this.stepped || performance.now() > this.edited + LINGER;
    if (isOver || this.renewed === whatIf) return;
    this.renewed = whatIf;
    this.ask();
  }

  private wasEdited(): void {
    this.edited = performance.now();
    this.ask();
  }

  /** The number that is stepped through, unless edits wait until they are applied. */
  private get stepped(): Stepped | null {
    const { settings, stepped } = this.lab.store.state;
    return settings.edits === "hold" ? null : stepped;
  }

  private get isWanted(): boolean {
    const { looking, world, status, settings } = this.lab.store.state;
    const hasBegun = status === "running" || status === "paused";
    return this.foretells.on && !settings.quiet && !looking && world !== null && hasBegun;
  }

  private async foretell(): Promise<void> {
    const { edited, stepped } = this;
    const begun = performance.now();
    const whatIf = this.isWanted && (stepped ? await this.tried(stepped) : await this.next());
    const now = performance.now();
    this.rested = stepped ? now + this.pace.rest * (now - begun) : 0;
    const isNewer = edited !== this.edited;
    if (isNewer && !(stepped && this.stepped)) return; // than the answer; of the same number it is shown meanwhile
    const isForetold = whatIf && this.isWanted;
    const isLate = isForetold && whatIf.end - this.lab.store.state.time < LEFT;
    const isFelt = isForetold && (!whatIf.tried || areOther(whatIf));
    this.show(isFelt && !isLate ? whatIf : null);
    this.say(isLate ? TOO_SLOW : isForetold && !isFelt ? sameWith(whatIf.tried!.values) : "");
  }

  private async next(): Promise<Foretold | undefined> {
    return (await this.lab.ask({ type: "what_if", seconds: SECONDS })).what_if;
  }

  /** How it goes on with each of the three values. */
  private async tried({ values, programs }: Stepped): Promise<Foretold | null> {
    const reply = await this.lab.ask({ type: "try_programs", programs: [...programs], seconds: SECONDS });
    const [, now, beyond] = reply.what_ifs ?? [];
    if (!now || !beyond) return null;
    return { ...now, tried: { values, beyond: beyond.changed } };
  }

  /** Say why nothing is shown, as long as something would be. */
  private say(text: string): void {
    const { store } = this.lab;
    this.said = store.state.time + SECONDS;
    if (store.state.unforetold !== text) store.set("unforetold", text);
  }

  private show(whatIf: Foretold | null): void {
    const { store } = this.lab;
    if (!whatIf && store.state.whatIf !== this.latest) return; // there is none, or it is not a preview
    this.latest = whatIf;
    store.set("whatIf", whatIf);
  }
}
