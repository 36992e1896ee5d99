// @vitest-environment happy-dom

import { readFileSync } from "node:fs";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { openField } from "../src/graph/field";
import type { Panel } from "../src/protocol";
import { h } from "../src/ui/dom";
import { openMenu } from "../src/ui/menu";
import { inputs } from "../src/world/fields";

let lab: HTMLElement;
beforeEach(() => {
  lab = h("div", { class: "lrp-lab" });
  document.body.append(lab);
});
afterEach(() => lab.remove());

const press = (key: string) =>
  document.activeElement!.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
const at = { x: 0, y: 0 };
const field = { title: "New state", entries: [{ label: "Name", value: "s1" }] };

describe("a menu", () => {
  const items = [{ label: "Delete", action: "delete", run: () => {} }];

  it("returns the focus to where it was", () => {
    const button = h("button");
    lab.append(button);
    button.focus();
    openMenu(lab, at, items, "Menu");
    press("Escape");
    expect(document.activeElement).toBe(button);
  });

  it("stays in the lab when that has become smaller", () => {
    let resized = () => {};
    vi.stubGlobal(
      "ResizeObserver",
      class {
        observe = () => {};
        disconnect = () => {};
        constructor(call: () => void) {
          resized = call;
        }
      },
    );
    let width = 900;
    lab.getBoundingClientRect = () => new DOMRect(0, 0, width, 600);
    openMenu(lab, { x: 880, y: 40 }, items, "Menu");
    const left = () => Number.parseFloat(lab.querySelector<HTMLElement>("[role=menu]")!.style.left);
    expect(left()).toBe(880);
    width = 500;
    resized();
    expect(left()).toBeLessThan(500);
    press("Escape");
    vi.unstubAllGlobals();
  });

  it("leaves the focus in the lab if what had it is gone, or if nothing had it", () => {
    const button = h("button");
    lab.append(button);
    button.focus();
    openMenu(lab, at, items, "Menu");
    button.remove();
    press("Escape");
    expect(document.activeElement).toBe(lab);
    (document.activeElement as HTMLElement).blur();
    openMenu(lab, at, items, "Menu");
    press("Escape");
    expect(document.activeElement).toBe(lab);
  });

  it("listens to nothing any more when another one replaces it", () => {
    const removed = vi.spyOn(document, "removeEventListener");
    openMenu(lab, at, items, "Menu");
    openMenu(lab, at, items, "Menu");
    expect(removed.mock.calls.filter(([type]) => type === "pointerdown")).toHaveLength(1);
    expect(lab.querySelectorAll("[role=menu]")).toHaveLength(1);
    removed.mockRestore();
  });
});

it("a menu is not covered by a sentence, which is shown when the menu is closed", () => {
  const style = h("style", {}, readFileSync("src/style/notes.css", "utf8"));
  document.head.append(style);
  const toast = h("div", { class: "lrp-toast" });
  lab.append(toast);
  openMenu(lab, at, [{ label: "Delete", action: "delete", run: () => {} }], "Menu");
  expect(getComputedStyle(toast).display).toBe("none");
  press("Escape");
  expect(getComputedStyle(toast).display).not.toBe("none");
  style.remove();
});

describe("a field on the graph", () => {
  const submit = () => lab.querySelector("form")!.dispatchEvent(new Event("submit", { cancelable: true }));

  it("shows names and code of a refusal as such", async () => {
    openField(lab, at, { ...field, submit: async () => "The name `s1` is taken." });
    submit();
    await Promise.resolve();
    expect(lab.querySelector("[role=alert]")!.innerHTML).toBe("The name <code>s1</code> is taken.");
  });

  it("that was left while the kernel was asked does not take the focus back, nor end twice", async () => {
    const before = h("button");
    const elsewhere = h("button");
    lab.append(before, elsewhere);
    before.focus();
    const closed = vi.fn();
    let answer: (refusal: null) => void = () => {};
    openField(lab, at, { ...field, closed, submit: () => new Promise((resolve) => (answer = resolve)) });
    submit();
    elsewhere.dispatchEvent(new Event("pointerdown", { bubbles: true }));
    elsewhere.focus();
    answer(null);
    await Promise.resolve();
    expect(document.activeElement).toBe(elsewhere);
    expect(closed).toHaveBeenCalledTimes(1);
  });

  it("is all in sight, as near as possible, and beside what it is about", () => {
    const size = (name: "offsetWidth" | "offsetHeight", px: number) =>
      vi.spyOn(HTMLElement.prototype, name, "get").mockReturnValue(px);
    const sizes = [size("offsetWidth", 300), size("offsetHeight", 100)];
    vi.spyOn(lab, "getBoundingClientRect").mockReturnValue(new DOMRect(0, 0, 840, 600));
    const [left, right] = [new DOMRect(60, 180, 60, 30), new DOMRect(230, 180, 60, 30)];
    const placed = (x: number, y: number, about: DOMRect[]) => {
      openField(lab, { x, y }, { ...field, about, submit: async () => null });
      const { style } = lab.querySelector("form")!;
      return [style.left, style.top];
    };
    expect(placed(250, 190, [])).toEqual(["250px", "190px"]);
    expect(placed(800, 590, [])).toEqual(["534px", "494px"]);
    expect(placed(250, 200, [left, right])).toEqual(["250px", "216px"]); // below both
    expect(placed(250, 590, [new DOMRect(230, 460, 60, 140)])).toEqual(["296px", "494px"]); // to the right
    expect(placed(800, 590, [new DOMRect(780, 570, 60, 30)])).toEqual(["474px", "494px"]); // to the left
    expect(placed(400, 300, [new DOMRect(0, 0, 840, 600)])).toEqual(["400px", "300px"]); // there is no other place
    for (const each of sizes) each.mockRestore();
  });

  it("does not close that of another lab", () => {
    const other = h("div", { class: "lrp-lab" });
    document.body.append(other);
    for (const host of [lab, other]) openField(host, at, { ...field, submit: async () => null });
    expect(document.querySelectorAll("form")).toHaveLength(2);
    other.remove();
  });

  it("has a style of its own: the settings of a real robot stay in their column", () => {
    const style = h("style", {}, readFileSync("src/style/drawing.css", "utf8"));
    document.head.append(style);
    const setting = { key: "port", label: "Port", value: "", choices: [], unit: "", press: "" };
    const panel: Panel = {
      title: "",
      fields: [{ ...setting, kind: "text" }],
      tables: [],
      buttons: [],
      questions: [],
    };
    lab.append(inputs(panel, () => {}).element);
    expect(getComputedStyle(lab.querySelector("label")!).position).not.toBe("absolute");
    style.remove();
  });
});
