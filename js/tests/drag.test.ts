// @vitest-environment happy-dom

import { beforeEach, describe, expect, it, vi } from "vitest";
import type { Pen } from "../src/editor/pen";
import { attachPencil } from "../src/graph/pencil";
import type { Lab } from "../src/session/store";
import { Store } from "../src/session/store";
import type { Division } from "../src/ui/boxes";
import { h, s } from "../src/ui/dom";
import { type Drag, trackDrag } from "../src/ui/drag";
import { svgDocument } from "../src/ui/picture";
import { splitter } from "../src/ui/splitter";

let surface: HTMLElement;
let captured: Set<number>;
beforeEach(() => {
  captured = new Set();
  surface = h("div");
  surface.setPointerCapture = (id) => void captured.add(id);
  surface.hasPointerCapture = (id) => captured.has(id);
  surface.releasePointerCapture = (id) => void captured.delete(id);
});

const pointer = (type: string, clientX: number, pointerId = 1, button = 0, buttons = 1) =>
  new PointerEvent(type, { clientX, clientY: 0, pointerId, button, buttons, bubbles: true });

describe("a drag", () => {
  let drag: { [K in keyof Required<Omit<Drag, "scrolls">>]: ReturnType<typeof vi.fn> };
  const moves = () => drag.move.mock.calls.map(([event]) => event.clientX);
  beforeEach(() => {
    drag = { begin: vi.fn(), move: vi.fn(), end: vi.fn() };
    trackDrag(surface, pointer("pointerdown", 0), drag as Drag);
  });

  it("begins when the pointer has moved, and ends wherever it is released", () => {
    window.dispatchEvent(pointer("pointermove", 2));
    expect(drag.begin).not.toHaveBeenCalled();
    window.dispatchEvent(pointer("pointermove", 9));
    const last = pointer("pointerup", -50);
    window.dispatchEvent(last);
    window.dispatchEvent(pointer("pointermove", 20));
    expect([moves(), drag.end.mock.calls, [...captured]]).toEqual([[9], [[last, true]], []]);
  });

  it("is that of one pointer", () => {
    window.dispatchEvent(pointer("pointermove", 9));
    window.dispatchEvent(pointer("pointermove", 500, 2));
    window.dispatchEvent(pointer("pointerup", 500, 2));
    expect(drag.end).not.toHaveBeenCalled();
    window.dispatchEvent(pointer("pointerup", 9));
    expect(moves()).toEqual([9]);
  });

  it.each(["Escape", "pointercancel"])("that ends with %s leads to nothing", (how) => {
    window.dispatchEvent(pointer("pointermove", 9));
    const event = how === "Escape" ? new KeyboardEvent("keydown", { key: how }) : pointer(how, 9);
    window.dispatchEvent(event);
    expect([drag.end.mock.calls, [...captured]]).toEqual([[[null, true]], []]);
  });

  it("ends when the pointer comes back without a button, which was released where nothing reports it", () => {
    window.dispatchEvent(pointer("pointermove", 9));
    window.dispatchEvent(pointer("pointermove", 20, 1, -1, 0));
    expect([moves(), drag.end.mock.calls]).toEqual([[9], [[null, true]]]);
  });

  it("does not end in a click", () => {
    const clicked = vi.fn();
    surface.addEventListener("click", clicked);
    window.dispatchEvent(pointer("pointermove", 9));
    window.dispatchEvent(pointer("pointerup", 9));
    surface.click();
    expect(clicked).not.toHaveBeenCalled();
  });

  it("does not end in a click when it is released after Escape, and swallows no other click", async () => {
    const clicked = vi.fn();
    surface.addEventListener("click", clicked);
    window.dispatchEvent(pointer("pointermove", 9));
    window.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape" }));
    await new Promise((done) => setTimeout(done, 5));
    window.dispatchEvent(pointer("pointerup", 9));
    surface.click();
    expect(clicked).not.toHaveBeenCalled();
    await new Promise((done) => setTimeout(done, 5));
    surface.click();
    expect(clicked).toHaveBeenCalledOnce();
  });
});

describe("a bar between two panels", () => {
  let element: HTMLElement;
  let shares: (number | null)[];
  beforeEach(() => {
    shares = [];
    surface.getBoundingClientRect = () => new DOMRect(0, 0, 1000, 100);
    const bar = splitter(surface, (share) => shares.push(share));
    const around = { left: 0, top: 0, width: 100, height: 100 };
    const division: Division = { name: "", label: "", axis: "columns", share: 50, parts: ["a", "b"] };
    bar.update({ division, share: 40, around, box: around });
    element = bar.element;
    for (const name of ["setPointerCapture", "hasPointerCapture", "releasePointerCapture"] as const)
      Object.assign(element, { [name]: surface[name] });
  });

  it("is dragged, but not by another button", () => {
    element.dispatchEvent(pointer("pointerdown", 400, 1, 2));
    window.dispatchEvent(pointer("pointermove", 300));
    expect([shares, element.dataset.dragged]).toEqual([[], undefined]);
    element.dispatchEvent(pointer("pointerdown", 400));
    window.dispatchEvent(pointer("pointermove", 300));
    expect([shares, element.dataset.dragged]).toEqual([[30], ""]);
    window.dispatchEvent(pointer("pointerup", 300));
    window.dispatchEvent(pointer("pointermove", 200));
    expect([shares, element.dataset.dragged]).toEqual([[30], undefined]);
  });

  it.each(["Escape", "pointercancel"])("is where it was after %s", (how) => {
    element.dispatchEvent(pointer("pointerdown", 400));
    window.dispatchEvent(pointer("pointermove", 300));
    window.dispatchEvent(how === "Escape" ? new KeyboardEvent("keydown", { key: how }) : pointer(how, 300));
    expect([shares, element.dataset.dragged]).toEqual([[30, 40], undefined]);
  });
});

describe("the ends of a selected transition", () => {
  const open = (...sources: string[]) => {
    const arrows = sources.map((source, index) => {
      const shaft = Object.assign(s("path", { class: "lrp-shaft" }), {
        getTotalLength: () => 10,
        getPointAtLength: (x: number) => new DOMPoint(x, 0),
        getScreenCTM: () => new DOMMatrix([1, 0, 0, 1, 100 + 50 * index, 40]), // in a nested machine
      });
      const key = `m/a/i:t ${source} 0`;
      return s("g", { class: "lrp-transition", "data-of": "m/a/i:t", "data-key": key }, shaft);
    });
    const root = Object.assign(s("g", {}, ...arrows), {
      getScreenCTM: () => new DOMMatrix([1, 0, 0, 1, 20, 10]),
    });
    const svg = s("svg", {}, root);
    h("div", {}, svg);
    const store = new Store();
    store.state.chosen = "m/a/i:t";
    attachPencil({ store } as unknown as Lab, svg, root, {} as Pen, () => {});
    return { svg, root };
  };

  it("are at the transition, also in a nested machine", () => {
    const places = [...open("x").root.querySelectorAll(".lrp-handle")].map((handle) =>
      ["cx", "cy"].map((name) => Number(handle.getAttribute(name))),
    );
    expect(places).toEqual([
      [80, 30],
      [90, 30],
    ]);
  });

  it("are dragged on a line from the other end of the same arrow", () => {
    const { svg, root } = open("x", "y");
    Object.assign(svg, { setPointerCapture() {}, hasPointerCapture: () => false });
    const line = () => root.querySelector(".lrp-rubber")?.getAttribute("d")?.split("L")[0];
    const [, , source, destination] = root.querySelectorAll(".lrp-handle");
    for (const handle of [source!, destination!]) {
      handle.dispatchEvent(pointer("pointerdown", 0));
      window.dispatchEvent(pointer("pointermove", 200));
      const other = handle === source ? destination! : source!;
      expect(line()).toBe(`M${other.getAttribute("cx")} ${other.getAttribute("cy")}`);
      window.dispatchEvent(pointer("pointerup", 200));
    }
  });

  it("are the destination alone where an exit lands: its source is in another machine", () => {
    const { svg, root } = open("x", "y");
    root.querySelectorAll(".lrp-transition")[1]!.setAttribute("data-lands", "");
    root.querySelector(".lrp-layer-pencil")!.remove();
    const store = new Store();
    store.state.chosen = "m/a/i:t";
    attachPencil({ store } as unknown as Lab, svg, root, {} as Pen, () => {});
    const ends = [...root.querySelectorAll<SVGElement>(".lrp-handle")].map(({ dataset }) => dataset.end);
    expect(ends).toEqual(["source", "destination", "destination"]);
  });

  it("are not in a saved picture", () => {
    const { svg, root } = open("x");
    const box = { x: 0, y: 0, width: 9, height: 9 };
    expect(svgDocument(svg, root, box)).not.toContain("circle");
  });
});

it("a double click renames the state that is seen where two lie on each other", () => {
  const state = (name: string) => {
    const box = s("rect", { class: "lrp-box" });
    box.getBoundingClientRect = () => new DOMRect(0, 0, 80, 45);
    return s("g", { class: "lrp-state", "data-lrp-state": `m/${name}` }, box);
  };
  const root = s("g", {}, state("below"), state("above"));
  const host = h("div", {}, s("svg", {}, root));
  document.body.replaceChildren(host);
  const svg = host.querySelector("svg")!;
  attachPencil({ store: new Store(), root: host } as unknown as Lab, svg, root, {} as Pen, () => {});
  root.dispatchEvent(new MouseEvent("dblclick", { clientX: 40, clientY: 20, bubbles: true }));
  expect(host.querySelector("input")?.value).toBe("above");
});

it("a finger beside a state draws from its border, but not where it is in another state", () => {
  const frames = { one: new DOMRect(0, 0, 80, 45), other: new DOMRect(90, 0, 80, 45) };
  const states = Object.entries(frames).map(([name, frame]) => {
    const box = s("rect", { class: "lrp-box" });
    box.getBoundingClientRect = () => frame;
    return s("g", { class: "lrp-state", "data-lrp-state": `m/${name}` }, box);
  });
  const root = s("g", {}, ...states);
  const svg = s("svg", {}, root);
  document.body.replaceChildren(h("div", {}, svg));
  Object.assign(svg, { setPointerCapture() {}, hasPointerCapture: () => false });
  attachPencil({ store: new Store() } as unknown as Lab, svg, root, {} as Pen, () => {});
  const draws = (clientX: number, clientY: number, pointerType: string) => {
    const at = { clientX, clientY, pointerType, button: 0, buttons: 1, bubbles: true, cancelable: true };
    const press = new PointerEvent("pointerdown", at);
    svg.dispatchEvent(press);
    window.dispatchEvent(new PointerEvent("pointercancel", at));
    return press.defaultPrevented;
  };
  expect([draws(40, 60, "mouse"), draws(40, 60, "touch"), draws(40, 22, "touch")]).toEqual([
    false,
    true,
    false,
  ]);
  frames.other.x = 60; // it covers a part of the first one
  expect(draws(84, 22, "touch")).toBe(false);
});

describe("a state of a machine that is spawned", () => {
  const FRAMES: Record<string, DOMRect> = {
    "m/a": new DOMRect(0, 0, 80, 40),
    "m/c": new DOMRect(0, 100, 80, 40),
    "m/b": new DOMRect(200, 0, 80, 40),
    "car/go": new DOMRect(0, 300, 80, 40),
    "other/x": new DOMRect(200, 300, 80, 40),
  };
  const spawning = (id: string) => ({ id, name: id.at(-1), machines: [], spawns: [{ machine: "car" }] });
  let drawn: ReturnType<typeof vi.fn>;
  let said: string[];
  let lab: Lab;
  let svg: SVGSVGElement;
  let put: ReturnType<typeof vi.fn>;
  let under: Element[];
  const open = (...users: string[]) => {
    const states = Object.entries(FRAMES).map(([path, frame]) => {
      const box = s("rect", { class: "lrp-box" });
      box.getBoundingClientRect = () => frame;
      return s("g", { class: "lrp-state", "data-lrp-state": path, transform: "translate(7 8)" }, box);
    });
    const arrows = ["a", "b", "*"].map((source) =>
      s("g", { class: "lrp-transition", "data-of": `m:${source}`, "data-key": `m:${source} ${source} 0` }),
    );
    const root = s("g", {}, ...arrows, ...states);
    const host = h("div", {}, s("svg", {}, root));
    document.body.replaceChildren(host);
    svg = host.querySelector("svg")!;
    Object.assign(svg, { setPointerCapture() {}, hasPointerCapture: () => false });
    [drawn, said, put, under] = [vi.fn(async () => null), [], vi.fn(), []];
    document.elementsFromPoint = () => under;
    const pen = {
      triggers: () => [],
      transition: () => ({ keyword: "on", trigger: "e for d", hold: "d", effect: "" }),
      draw: drawn,
    };
    lab = { store: new Store(), root: host, notify: (each: string) => said.push(each) } as unknown as Lab;
    const m = { states: users.map(spawning), transitions: [] };
    Object.assign(lab.store.state, { layouts: { m }, lit: ["m/c"] });
    attachPencil(lab, svg, root, pen as unknown as Pen, put as never);
    return arrows;
  };
  const press = (x: number, y: number, type: string) =>
    new PointerEvent(type, {
      ...{ clientX: x, clientY: y, pointerId: 1, button: 0, buttons: 1 },
      ...{ bubbles: true, cancelable: true },
    });
  const drag = (from: [number, number], to: [number, number]) => {
    svg.dispatchEvent(press(...from, "pointerdown"));
    window.dispatchEvent(press(...to, "pointermove"));
    const marked = svg.querySelector("[data-drop]");
    window.dispatchEvent(press(...to, "pointerup"));
    return marked;
  };
  const fields = () =>
    [...document.querySelectorAll<HTMLInputElement>(".lrp-field .lrp-input")].map(({ ariaLabel, value }) => [
      ariaLabel ?? "",
      value,
    ]);

  it("leads from its border to a state beside the one that spawns it: that one waits for it", () => {
    open("m/a");
    drag([40, 301], [240, 20]);
    expect(fields().map(([, value]) => value)).toEqual(["car.go"]);
    document.querySelector("form")!.dispatchEvent(new Event("submit", { cancelable: true }));
    expect(drawn.mock.calls[0]![0]).toEqual({
      ...{ act: "transition", kind: "state", path: "m/a", to: "b", form: "car.go" },
    });
  });

  it("asks which of several states that spawn it is meant, the active one first", () => {
    open("m/a", "m/c");
    drag([40, 301], [240, 20]);
    expect(fields().map(([, value]) => value)).toEqual(["c", "car.go"]);
    document.querySelector<HTMLInputElement>(".lrp-field .lrp-input")!.value = "a";
    document.querySelector("form")!.dispatchEvent(new Event("submit", { cancelable: true }));
    expect(drawn.mock.calls[0]![0]).toMatchObject({ path: "m/a", to: "b", form: "car.go" });
  });

  it("leads nowhere from a machine that nothing there spawns, and the sentence says where to", () => {
    open("m/a");
    drag([240, 301], [240, 20]);
    drag([240, 1], [40, 320]); // from outside into it
    expect([fields(), said.length]).toEqual([[], 2]);
    expect(said[0]).toContain("the machine that spawns it");
  });

  it("that is dropped on an arrow of the state that spawns it is what that waits for, and goes home", async () => {
    const [ofUser, ofOther, ofAny] = open("m/a");
    under = [ofUser!];
    expect(drag([40, 320], [140, 20])).toBe(ofUser);
    await vi.waitFor(() => expect(put).toHaveBeenCalledWith("car/go", 7, 8));
    const act = { act: "trigger", kind: "transition", path: "m:a", form: "car.go for d" };
    expect(drawn.mock.calls).toEqual([[act]]);
    under = [ofAny!];
    expect(drag([40, 320], [140, 20])).toBe(ofAny);
    for (const other of [ofOther!, s("text", { "data-of": "m:gone" })]) {
      under = [other];
      expect(drag([40, 320], [140, 20])).toBeNull();
    }
    under = [ofUser!];
    expect(drag([240, 320], [140, 20])).toBeNull(); // of a machine that the source does not spawn
  });
});
