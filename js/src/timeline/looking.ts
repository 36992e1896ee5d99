/** Looking at an earlier moment: the band that says so, and moves of the playhead, of which the newest wins. */

import type { Lab } from "../session/store";
import { button } from "../ui/button";
import { h, setAttribute, setHidden, setText } from "../ui/dom";

const LATE = 300; // ms by which the frame of the moment may come after the reply

export type Moment = { tick: number } | { time: number };

export class Looking {
  /** The moment that is about to be shown; null once it is. */
  wanted: Moment | null = null;
  private next: Moment | null = null;
  private going: Promise<boolean> | null = null;

  /** Called when another moment is wanted, or shown. */
  moved = () => {};

  constructor(private readonly lab: Lab) {
    lab.store.watch(["looking"], () => {
      setAttribute(lab.root, "data-looking", Boolean(lab.store.state.looking));
      this.arrived();
    });
  }

  /** Show a moment; of several that come quickly, the last one. Resolves to whether it is shown. */
  at(moment: Moment): Promise<boolean> {
    if (this.lab.store.state.settings.quiet) return Promise.resolve(false); // it has no timeline
    this.next = this.wanted = moment;
    this.moved();
    this.going ??= this.go();
    return this.going;
  }

  private async go(): Promise<boolean> {
    let refused: string | null = null;
    while (this.next) {
      const now: Moment = this.next;
      this.next = null;
      refused = await this.lab.act({ do: "look", ...now }, true);
    }
    this.going = null;
    if (refused) this.lab.notify(refused);
    setTimeout(() => this.arrived(), refused ? 0 : LATE);
    return !refused;
  }

  back(): void {
    this.next = this.wanted = null;
    void this.lab.act({ do: "look" });
  }

  private arrived(): void {
    if (this.going || !this.wanted) return;
    this.wanted = null;
    this.moved();
  }
}

/** Says that everything shown is the past: in the head of the timeline, where it pushes nothing. */
export function band(lab: Lab, looking: Looking): HTMLElement {
  const { store } = lab;
  const words = h("span", { role: "status" });
  const ago = h("span", {});
  const more = h("span", { class: "lrp-band-more" });
  const run = button({
    label: "Run on from here",
    title: "Continue from this moment. What came later is deleted.",
    action: "run-from",
    onclick: () => void lab.act({ do: "run_from" }),
  });
  const element = h(
    "div",
    { class: "lrp-band", hidden: true },
    h("div", { class: "lrp-band-words" }, words, ago, more),
    run,
    button({
      label: "Back to now",
      title: "Show the present again (Escape on the playhead)",
      action: "back-to-now",
      onclick: () => looking.back(),
    }),
  );
  store.watch(["looking", "bridge", "status"], () => {
    const { looking: moment, bridge, status } = store.state;
    setHidden(element, !moment);
    if (!moment) return;
    const time = `${moment.time.toFixed(1)} s`;
    const goesOn = bridge.hardware && status === "running" ? " The real robot keeps running." : "";
    setText(words, `Looking at ${time}`);
    setText(ago, `, ${moment.ago.toFixed(1)} s ago.`);
    setText(more, `${moment.edited ? " The program has been edited since." : ""}${goesOn}`);
    const label = run.querySelector(".lrp-button-label")!;
    setText(label, moment.edited ? `Run on from ${time} with the edit` : "Run on from here");
    run.disabled = bridge.hardware && bridge.armed;
    setAttribute(
      run,
      "title",
      run.disabled
        ? "The robot is armed, and a real robot cannot go back. Disarm it first."
        : "Continue from this moment. What came later is deleted.",
    );
  });
  return element;
}
