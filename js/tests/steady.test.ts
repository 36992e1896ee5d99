import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { BUSY_AFTER } from "../src/session/connection";
import type { Link } from "../src/session/state";
import { steady } from "../src/session/steady";

describe("a busy kernel", () => {
  let shown: Link[];
  let link: (link: Link) => void;
  let view: AbortController;
  beforeEach(() => {
    vi.useFakeTimers();
    shown = [];
    view = new AbortController();
    link = steady((each) => shown.push(each), view.signal);
    link("live");
  });
  afterEach(() => {
    vi.useRealTimers();
  });

  it("is not shown if it answers within a second", () => {
    link("busy");
    vi.advanceTimersByTime(999 - BUSY_AFTER);
    link("live");
    vi.advanceTimersByTime(5000);
    expect(shown.filter((each) => each === "busy")).toEqual([]);
  });

  it("is not shown in a view that has been closed", () => {
    link("busy");
    view.abort();
    vi.advanceTimersByTime(5000);
    expect(shown).toEqual(["live"]);
  });

  it("is shown after a second, for a second at least", () => {
    link("busy");
    vi.advanceTimersByTime(1000 - BUSY_AFTER);
    expect(shown.at(-1)).toBe("busy");
    link("live");
    vi.advanceTimersByTime(900);
    expect(shown.at(-1)).toBe("busy");
    vi.advanceTimersByTime(200);
    expect(shown.at(-1)).toBe("live");
  });

  it("that is lost or has ended is shown at once", () => {
    link("busy");
    link("lost");
    expect(shown.at(-1)).toBe("lost");
    link("dead");
    expect(shown.at(-1)).toBe("dead");
  });
});
