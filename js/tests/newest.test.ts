// @vitest-environment happy-dom

import { beforeEach, describe, expect, it, vi } from "vitest";
import { askWhy } from "../src/parts/why";
import type { LookingView, ReplyMessage, WhyView } from "../src/protocol";
import { newest } from "../src/session/newest";
import { type Lab, Store } from "../src/session/store";
import { askWhatIf } from "../src/timeline/what_if";

const pause = (ms = 0) => new Promise((over) => setTimeout(over, ms));

describe("questions of which the newest counts", () => {
  it("are asked one at a time, and once more for all that came meanwhile", async () => {
    const answers: (() => void)[] = [];
    const ask = newest(
      new AbortController().signal,
      () => 0,
      () => new Promise<void>((resolve) => answers.push(resolve)),
    );
    ask();
    ask();
    ask();
    expect(answers).toHaveLength(1);
    answers[0]!();
    await pause();
    expect(answers).toHaveLength(2);
    answers[1]!();
    await pause();
    expect(answers).toHaveLength(2);
  });

  it("end with the view, also while one waits", async () => {
    const closing = new AbortController();
    const asked = vi.fn(async () => {});
    const ask = newest(closing.signal, () => performance.now() + (closing.signal.aborted ? -1 : 10), asked);
    ask();
    closing.abort();
    await pause(40);
    expect(asked).not.toHaveBeenCalled();
  });
});

/** A lab whose questions wait for their answers. */
class Waiting {
  readonly store = new Store();
  readonly root = document.createElement("div");
  readonly closed = new AbortController().signal;
  readonly told: string[] = [];
  readonly questions: ((reply: Partial<ReplyMessage>) => void)[] = [];
  readonly lab = {
    store: this.store,
    root: this.root,
    closed: this.closed,
    notify: (text: string) => this.told.push(text),
    ask: () => new Promise((resolve) => this.questions.push(resolve)),
  } as unknown as Lab;

  async answer(reply: Partial<ReplyMessage>): Promise<void> {
    this.questions.shift()!(reply);
    await pause();
  }
}

let page: Waiting;
beforeEach(() => {
  page = new Waiting();
  document.body.replaceChildren(page.root);
});

describe("what if, after edits of the past", () => {
  it("is asked once at a time while somebody types, and at last about the newest edit", async () => {
    askWhatIf(page.lab);
    const looking: LookingView = { tick: 5, time: 0.4, ago: 1, edited: true };
    for (let revision = 1; revision < 5; revision++) {
      Object.assign(page.store.state, { looking, revision });
      page.store.touch(["looking", "revision"]);
      await pause(200);
    }
    expect(page.questions).toHaveLength(1);
    await page.answer({ error: "This waits: something else is being computed." });
    expect(page.told).toEqual([]); // it was about an older edit
    await vi.waitUntil(() => page.questions.length === 1, { timeout: 3000 });
  });
});

describe("a why card", () => {
  const why = (sentence: string): { why: WhyView } => ({
    why: {
      code: "condition-false",
      name: "n > 3:a->b",
      tick: 1,
      time: 0,
      sentence,
      lines: [],
      present: true,
    },
  });
  const sentence = () => page.root.querySelector(".lrp-why-sentence")!.textContent;

  it("shows an answer again after one that failed", async () => {
    askWhy(page.lab, "transition", "m:go", { x: 0, y: 0 });
    await page.answer(why("It was False."));
    expect(sentence()).toBe("It was False.");
    page.store.touch(["tick"]);
    await vi.waitUntil(() => page.questions.length === 1, { timeout: 3000 });
    await page.answer({ error: "This waits." });
    expect(sentence()).toBe("This waits.");
    page.store.touch(["tick"]);
    await vi.waitUntil(() => page.questions.length === 1, { timeout: 3000 });
    await page.answer(why("It was False."));
    expect(sentence()).toBe("It was False.");
  });

  it("asks about the last tick, too, if that comes soon after another", async () => {
    askWhy(page.lab, "transition", "m:go", { x: 0, y: 0 });
    await page.answer(why("It was False."));
    page.store.touch(["tick"]); // and then the program pauses
    await vi.waitUntil(() => page.questions.length === 1, { timeout: 3000 });
  });
});
