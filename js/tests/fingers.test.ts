// @vitest-environment happy-dom

import { afterEach, beforeEach, describe, expect, it, type Mock, vi } from "vitest";
import { h } from "../src/ui/dom";
import { type Drag, trackDrag } from "../src/ui/drag";
import { useFingers } from "../src/ui/fingers";
import { onPinch } from "../src/ui/pinch";

let lab: HTMLElement;
let surface: HTMLElement;
let drag: { move: Mock<Drag["move"]>; end: Mock<Drag["end"]> };
beforeEach(() => {
  vi.useFakeTimers();
  surface = h("button", { title: "What it does" });
  lab = h("div", {}, surface);
  document.body.replaceChildren(lab);
  Object.assign(surface, { setPointerCapture() {}, hasPointerCapture: () => false });
  drag = { move: vi.fn(), end: vi.fn() };
  useFingers(lab);
});
afterEach(() => {
  window.dispatchEvent(pointer("pointercancel", 0, 0));
  vi.useRealTimers();
});

const pointer = (type: string, clientX: number, clientY: number, pointerId = 1) =>
  new PointerEvent(type, {
    ...{ clientX, clientY, pointerId, pointerType: "touch", isPrimary: pointerId === 1 },
    ...{ button: 0, buttons: 1, bubbles: true },
  });

/** Fingers at places of the lab; returns whether the browser may do what it usually does. */
function touch(type: string, ...places: [number, number][]): boolean {
  const touches = places.map(([clientX, clientY]) => ({ clientX, clientY }));
  return surface.dispatchEvent(
    Object.assign(new Event(type, { bubbles: true, cancelable: true }), { touches }),
  );
}

describe("a finger", () => {
  const begin = (scrolls?: Drag["scrolls"]) => {
    surface.dispatchEvent(pointer("pointerdown", 0, 0));
    trackDrag(surface, pointer("pointerdown", 0, 0), { ...drag, scrolls } as Drag);
  };

  it("does not scroll while it drags something, and scrolls else", () => {
    expect(touch("touchmove", [0, 30])).toBe(true);
    begin();
    expect(touch("touchmove", [0, 30])).toBe(false);
    window.dispatchEvent(pointer("pointerup", 0, 30));
    expect(touch("touchmove", [0, 30])).toBe(true);
  });

  it.each([
    ["all", 30, 0, 0],
    ["down", 0, 30, 0],
    ["down", 30, 0, 1],
  ] as const)("scrolls %s instead of a drag by %i, %i", (scrolls, x, y, moves) => {
    begin(scrolls);
    window.dispatchEvent(pointer("pointermove", x, y));
    expect([drag.move.mock.calls.length, drag.end.mock.calls.length]).toEqual([moves, 1 - moves]);
    expect(touch("touchmove", [x, y])).toBe(true);
  });

  it("trembles without dragging", () => {
    begin();
    window.dispatchEvent(pointer("pointermove", 6, 6));
    expect(drag.move).not.toHaveBeenCalled();
  });
});

describe("two fingers", () => {
  it("zoom around the point between them and move it, and give up what the first one dragged", () => {
    const changes: unknown[] = [];
    onPinch(surface, (factor, { x, y }, dx, dy) => changes.push([factor, x, y, dx, dy]));
    surface.addEventListener("pointerdown", (event) => trackDrag(surface, event, drag));
    surface.dispatchEvent(pointer("pointerdown", 0, 0));
    surface.dispatchEvent(pointer("pointermove", 20, 0));
    surface.dispatchEvent(pointer("pointerdown", 20, 40, 2));
    expect(drag.end.mock.calls).toEqual([[null, true]]);
    surface.dispatchEvent(pointer("pointermove", 20, 80, 2));
    expect(changes).toEqual([[2, 20, 40, 0, 20]]);
    expect(touch("touchmove", [20, 0], [20, 80])).toBe(false);
    surface.dispatchEvent(pointer("pointerup", 20, 80, 2));
    surface.dispatchEvent(pointer("pointermove", 90, 90));
    expect(changes).toHaveLength(1);
    expect(touch("touchmove", [90, 90])).toBe(true);
  });
});

describe("a long press", () => {
  const LONG = 600; // ms

  it("opens the menu that a right click opens, gives up the drag, and does not click", () => {
    const opened = vi.fn((event: MouseEvent) => event.preventDefault());
    const ofNotebook = vi.fn();
    surface.addEventListener("contextmenu", opened);
    document.body.addEventListener("contextmenu", ofNotebook, { once: true });
    touch("touchstart", [7, 8]);
    trackDrag(surface, pointer("pointerdown", 7, 8), drag);
    vi.advanceTimersByTime(LONG);
    const { button, clientX, clientY } = opened.mock.calls[0]![0];
    expect([button, clientX, clientY]).toEqual([2, 7, 8]);
    expect(drag.end.mock.calls).toEqual([[null, false]]);
    expect(touch("touchend")).toBe(false);
    expect(ofNotebook).not.toHaveBeenCalled();
  });

  it("shows the title of what has no menu", () => {
    touch("touchstart", [7, 8]);
    vi.advanceTimersByTime(LONG);
    expect(lab.querySelector('[role="tooltip"]')?.textContent).toBe("What it does");
    expect(touch("touchend")).toBe(false);
    document.dispatchEvent(pointer("pointerdown", 0, 0));
    expect(lab.querySelector('[role="tooltip"]')).toBeNull();
  });

  it.each<[string, () => unknown]>([
    ["moves", () => touch("touchmove", [7, 30])],
    ["ends soon", () => touch("touchend")],
    ["is not alone", () => touch("touchstart", [7, 8], [90, 8])],
    ["scrolls", () => touch("touchcancel")],
  ])("is none if the finger %s", (_, act) => {
    touch("touchstart", [7, 8]);
    vi.advanceTimersByTime(LONG / 2);
    act();
    vi.advanceTimersByTime(LONG);
    expect(lab.querySelector('[role="tooltip"]')).toBeNull();
  });

  it("is none if the finger has moved before a busy page was told so", () => {
    touch("touchstart", [7, 8]);
    vi.advanceTimersByTime(500);
    touch("touchmove", [7, 30]);
    vi.advanceTimersToNextFrame();
    expect(lab.querySelector('[role="tooltip"]')).toBeNull();
  });

  it("is of what is drawn instead of what was pressed, and ends with the touch of that", () => {
    const again = h("button", { title: "What it does now" });
    const draw = () => surface.replaceWith(again);
    document.elementFromPoint = () => again;
    touch("touchstart", [7, 8]);
    draw();
    vi.advanceTimersByTime(LONG);
    expect(lab.querySelector('[role="tooltip"]')?.textContent).toBe("What it does now");
    expect(touch("touchend")).toBe(false);
    document.dispatchEvent(pointer("pointerdown", 0, 0));
    again.replaceWith(surface);
    touch("touchstart", [7, 8]);
    draw();
    touch("touchend");
    vi.advanceTimersByTime(LONG);
    expect(lab.querySelector('[role="tooltip"]')).toBeNull();
  });

  it("is left to a text, which has one of its own", () => {
    surface.classList.add("cm-content");
    touch("touchstart", [7, 8]);
    vi.advanceTimersByTime(LONG);
    expect(touch("touchend")).toBe(true);
  });
});
