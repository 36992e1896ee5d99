// @vitest-environment happy-dom
import { describe, expect, it, vi } from "vitest";
import { announcer, hungNote, robotNote, unstartedNote } from "../src/parts/notes";
import { initialState } from "../src/session/state";
import type { Lab } from "../src/session/store";

/** A note of a lab whose state changes by `show`. */
function noteOf(act: (command: unknown) => void, make = hungNote) {
  const state: Record<string, unknown> = { hung: null, reason: "", bridge: { status: "connected" } };
  let redraw = () => {};
  const store = { state, watch: (_: unknown, call: () => void) => (redraw = call) };
  const note = make({ store, act } as unknown as Lab);
  const show = (changes: Record<string, unknown>) => {
    Object.assign(state, changes);
    redraw();
  };
  show({});
  return { note, show, button: note.querySelector("button")! };
}

describe("the note about a block that does not return", () => {
  const hung = { where: "a.running", seconds: 3, held: false };

  it("has the kernel's sentence and a button that interrupts the block", () => {
    const act = vi.fn();
    const { note, show, button } = noteOf(act);
    expect(note.hidden).toBe(true);
    show({ hung, reason: "`a.running` has run for 3 s (line 2)." });
    expect(note.hidden).toBe(false);
    expect(note.textContent).toContain("a.running has run for 3 s (line 2).");
    button.click();
    expect(act.mock.calls).toEqual([[{ do: "interrupt" }]]);
    show({ hung: null, reason: "" });
    expect(note.hidden).toBe(true);
  });

  it("is announced once, not at every second", () => {
    vi.useFakeTimers();
    const reason = "`b.running` has run for 2 s.";
    const state = { ...initialState(), active: ["a/b"], status: "hung", reason };
    let redraw = () => {};
    let topics: string[] = [];
    const watch = (watched: string[], call: () => void) => ([topics, redraw] = [watched, call]);
    const region = announcer({ store: { state, watch } } as unknown as Lab);
    redraw();
    vi.runAllTimers();
    vi.useRealTimers();
    expect(region.textContent).toBe("hung. b.running has run for 2 s. In b");
    expect(topics).not.toContain("reason");
    expect(noteOf(() => {}).note.closest("[role=status], [aria-live]")).toBe(null);
  });

  it("has no button where interrupting was in vain", () => {
    const { show, button } = noteOf(() => {});
    show({ hung: { ...hung, held: true } });
    expect(button.hidden).toBe(true);
  });
});

describe("the note about a robot that stands although the program runs", () => {
  const announced = (note: HTMLElement) => note.querySelector("[role=status]")!.textContent;

  it("says that it is lost until it is found", () => {
    const { note, show } = noteOf(() => {}, robotNote);
    expect(note.hidden).toBe(true);
    show({ bridge: { status: "lost", sentence: "`ros` no longer answers." } });
    expect(note.hidden).toBe(false);
    expect(note.textContent).toBe("Robot lostros no longer answers.");
    show({ bridge: { status: "connected", sentence: "Connected." } });
    expect([note.hidden, announced(note)]).toEqual([true, ""]);
  });

  it("says how old its data are, and announces only that they are too old", () => {
    const { note, show } = noteOf(() => {}, robotNote);
    for (const age of ["1.1", "1.2"]) {
      show({ bridge: { status: "stale", sentence: `\`robot.light\` is stale: its value is ${age} s old.` } });
      expect(note.textContent).toContain(`${age} s old`);
      expect(announced(note)).toBe("Robot data too old");
    }
  });
});

describe("the note about a program that was not started", () => {
  it("has the reason until the program is started", () => {
    const { note, show } = noteOf(() => {}, unstartedNote);
    show({ status: "paused", tick: 0, reason: "A block did not return." });
    expect([note.hidden, note.textContent]).toEqual([false, "A block did not return."]);
    show({ status: "running", tick: 0, reason: "" });
    expect(note.hidden).toBe(true);
    show({ status: "paused", tick: 8, reason: "The robot was stopped." });
    expect(note.hidden).toBe(true);
  });
});
