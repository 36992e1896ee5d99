// @vitest-environment happy-dom

import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { arrange } from "../src/ui/boxes";
import { h } from "../src/ui/dom";
import { Layout, type Panels } from "../src/ui/layout";
import { ARRANGEMENTS, HEAD, PROGRAM, planFor, type Shape } from "../src/ui/plans";

const NAMES = [
  "goal",
  "editor",
  "tree",
  "graph",
  "world",
  "variables",
  "robot",
  "issues",
  "runs",
  "breakpoints",
] as const;
/** Of the bundled worlds: width / height. */
const ASPECTS = { line: 2.49, oval: 1.65, maze: 1.24, crossing: 1.97, convoy: 4.8 };
/** Labs in windows of 1280×800 with files open and without, 1440×900, 1920×1080; and the room for their panels. */
const LABS = [
  [848, 667, 557],
  [1100, 667, 557],
  [1008, 767, 657],
  [1488, 947, 837],
] as const;

function boxesOf(
  [width, high, height]: readonly [number, number, number],
  aspect: number,
  shape: Shape = "work",
  hasGoal = false,
) {
  const plan = planFor({ width, height, lab: width * high }, { hasGoal, aspect }, shape);
  const { boxes } = arrange(plan, (name) => hasGoal || name !== "goal");
  const inPx = (name: string) => {
    const box = boxes.get(name)!;
    return { width: (box.width * width) / 100, height: (box.height * height) / 100 };
  };
  const { width: across, height: down } = inPx("world");
  const picture = { width: Math.min(across, (down - HEAD) * aspect), height: down - HEAD };
  return { boxes, inPx, across, picture, share: (across * picture.height) / (width * high) };
}

describe("the plans", () => {
  it("give a world a quarter of the lab and more, in its proportions, and the program its lines", () => {
    for (const lab of LABS)
      for (const [name, aspect] of Object.entries(ASPECTS)) {
        const { inPx, across, picture, share } = boxesOf(lab, aspect);
        const least = { convoy: 0.14, maze: 0.21, crossing: 0.21 }[name] ?? 0.25;
        expect(share, `${name} ${lab}`).toBeGreaterThanOrEqual(least);
        expect(picture.width / across, `${name} ${lab}`).toBeGreaterThan(0.97); // nothing beside it is empty
        expect(inPx("editor").height, `${name} ${lab}`).toBeGreaterThanOrEqual(PROGRAM + HEAD - 0.01);
        expect(inPx("editor").width).toBeGreaterThanOrEqual(359);
        expect(inPx("lists").height).toBeGreaterThanOrEqual(160);
        expect(inPx("machines").width).toBeGreaterThanOrEqual(199);
      }
  });

  it("give a program the whole height where graph and lists have room under the world", () => {
    const of = (index: number, aspect: number) => boxesOf(LABS[index]!, aspect);
    for (const aspect of [ASPECTS.line, ASPECTS.oval, ASPECTS.crossing]) {
      const { inPx, share } = of(3, aspect);
      expect(inPx("editor").height).toBeCloseTo(LABS[3][2]);
      expect(share).toBeGreaterThanOrEqual(0.3);
      expect(inPx("machines").height).toBeGreaterThan(289);
      for (const index of [0, 1, 2]) expect(of(index, aspect).inPx("editor").height).toBeLessThan(500);
    }
  });

  it("leave every panel some height in a lab that its user has made low", () => {
    for (const aspect of Object.values(ASPECTS).filter((each) => each < 4)) {
      const { inPx, picture } = boxesOf([848, 380, 270], aspect);
      expect(picture.height, `${aspect}`).toBeGreaterThan(95);
      for (const name of ["editor", "machines", "lists"])
        expect(inPx(name).height, `${name} ${aspect}`).toBeGreaterThan(90);
    }
  });

  it("leave the tools and the legend of a flat world their room under a goal", () => {
    for (const lab of LABS)
      expect(boxesOf(lab, 5, "work", true).picture.height, `${lab}`).toBeGreaterThanOrEqual(159);
  });

  it("make the world larger where that is wanted, and keep every panel in sight", () => {
    for (const lab of LABS)
      for (const aspect of Object.values(ASPECTS)) {
        const work = boxesOf(lab, aspect).picture.width;
        const large = boxesOf(lab, aspect, "world");
        expect(large.picture.width, `${aspect} ${lab}`).toBeGreaterThan(1.1 * work);
        for (const shape of [...ARRANGEMENTS, "past"] as const)
          for (const hasGoal of [false, true]) {
            const { inPx } = boxesOf(lab, aspect, shape, hasGoal);
            for (const name of ["editor", "machines", "lists", ...(hasGoal ? ["goal"] : [])]) {
              const { width, height } = inPx(name);
              expect(Math.min(width, height), `${name} ${aspect} ${shape} ${lab}`).toBeGreaterThan(95);
            }
          }
      }
  });

  it("leave the program at the top left, and as wide as it is over a world, when the world becomes larger", () => {
    for (const lab of LABS)
      for (const [name, aspect] of Object.entries(ASPECTS)) {
        const [work, past] = [boxesOf(lab, aspect), boxesOf(lab, aspect, "past")];
        const before = work.boxes.get("editor")!;
        const after = past.boxes.get("editor")!;
        expect([after.left, after.top], `${name} ${lab}`).toEqual([0, 0]);
        const isOver = (boxes: typeof work.boxes) => boxes.get("world")!.left === 0;
        expect(isOver(past.boxes)).toBe(isOver(work.boxes));
        if (isOver(past.boxes)) expect(after.width).toBe(before.width);
        else expect(after.height).toBe(before.height);
        expect(past.picture.width, `${name} ${lab}`).toBeGreaterThan(1.1 * work.picture.width);
      }
  });
});

function layoutOf(width: number, height = 600): Layout {
  const panels = Object.fromEntries(
    NAMES.map((name) => [name, h("section", { class: "lrp-panel" }, h("div", { class: "lrp-title" }, name))]),
  );
  for (const name of ["goal", "runs"]) panels[name]?.toggleAttribute("data-absent", true);
  const layout = new Layout(panels as Panels);
  Object.defineProperty(layout.element, "clientWidth", { value: width });
  Object.defineProperty(layout.element, "clientHeight", { value: height });
  layout.maximise(null); // computes the places
  return layout;
}

const place = (layout: Layout, name: keyof Panels, side: string) =>
  Number.parseFloat(layout.panels[name].style.getPropertyValue(`--lrp-box-${side}`));
const tab = (layout: Layout, name: string) =>
  layout.element.querySelector<HTMLElement>(`[data-lrp-tab="${name}"]`)!;
const inFront = (layout: Layout) =>
  (["variables", "robot", "issues", "breakpoints"] as const).filter(
    (name) => !layout.panels[name].hasAttribute("data-behind"),
  );

describe("the layout", () => {
  let layout: Layout;
  beforeEach(() => localStorage.clear());
  afterEach(() => layout.close());

  it("puts a wide world below the program where it is larger there, another and a robot's panel beside it", async () => {
    layout = layoutOf(900);
    expect(place(layout, "world", "top")).toBe(0);
    expect(place(layout, "world", "left")).toBeGreaterThan(0);
    layout.panels.world.setAttribute("data-aspect", "2.5");
    await vi.waitFor(() => expect(place(layout, "world", "left")).toBe(0));
    expect(place(layout, "world", "top")).toBeGreaterThan(0);
    expect(place(layout, "editor", "top")).toBe(0);
  });

  it("moves a bar by each press of a key, and has it again where its arrangement comes back", () => {
    layout = layoutOf(900);
    const bar = layout.element.querySelector<HTMLElement>('[aria-label="Width of the world"]')!;
    const count = () => layout.element.querySelectorAll(".lrp-splitter").length;
    const [bars, before] = [count(), place(layout, "world", "left")];
    for (const key of ["ArrowLeft", "ArrowLeft", "ArrowLeft"])
      bar.dispatchEvent(new KeyboardEvent("keydown", { key }));
    expect(place(layout, "world", "left")).toBeCloseTo(before - 6, 0);
    expect([count(), bar.hidden]).toEqual([bars, false]);
    layout.arrangement = "demo";
    expect(bar.hidden).toBe(true);
    layout.arrangement = "work";
    expect(bar.hidden).toBe(false);
  });

  it("puts a challenge over its world, at the left of the program", async () => {
    layout = layoutOf(1400);
    expect(layout.panels.goal.hasAttribute("data-away")).toBe(true);
    expect(place(layout, "editor", "left")).toBe(0);
    layout.panels.goal.toggleAttribute("data-absent", false);
    await vi.waitFor(() => expect(place(layout, "goal", "left")).toBe(0));
    expect(place(layout, "world", "left")).toBe(0);
    expect(place(layout, "editor", "left")).toBeGreaterThanOrEqual(44);
  });

  it("stacks the panels where there is little room, but not one that is shown alone", () => {
    layout = layoutOf(600);
    expect(layout.element.hasAttribute("data-stacked")).toBe(true);
    layout.maximise(layout.panels.graph);
    expect(layout.element.hasAttribute("data-stacked")).toBe(false);
    expect(layout.panels.editor.hasAttribute("data-away")).toBe(true);
    layout.maximise(null);
    expect(layout.panels.editor.hasAttribute("data-away")).toBe(false);
  });

  it("shows at the button of a panel that it is enlarged, and that the button makes it small again", () => {
    layout = layoutOf(900);
    const enlarge = h("button", { "data-lrp-action": "enlarge" });
    layout.panels.graph.append(enlarge);
    layout.maximise(layout.panels.graph);
    expect(enlarge.getAttribute("aria-pressed")).toBe("true");
    layout.maximise(layout.panels.world);
    expect(enlarge.getAttribute("aria-pressed")).toBe("false");
  });

  it("keeps for the next lab its arrangement, hidden panels, the tab, and what its user's bars have set", () => {
    layout = layoutOf(900);
    layout.arrangement = "demo";
    layout.show("issues", false);
    tab(layout, "robot").click();
    const bar = layout.element.querySelector<HTMLElement>('[aria-label="Height of the world"]:not([hidden])');
    bar?.dispatchEvent(new KeyboardEvent("keydown", { key: "End" }));
    layout.close();
    layout = layoutOf(900);
    expect(layout.arrangement).toBe("demo");
    expect(layout.panels.issues.hidden).toBe(true);
    expect(tab(layout, "issues").hidden).toBe(true);
    expect(inFront(layout)).toEqual(["robot"]);
    expect(place(layout, "world", "height")).toBe(85);
  });

  it("makes the world larger while its user looks back, without moving what is read, and returns", () => {
    layout = layoutOf(900);
    layout.panels.world.setAttribute("data-aspect", "1.6");
    layout.maximise(null);
    let changes = 0;
    layout.holding = (change) => {
      changes += 1;
      change();
    };
    const before = place(layout, "world", "width");
    layout.lookBack(true);
    layout.lookBack(true);
    expect(place(layout, "world", "width")).toBeGreaterThan(before + 5);
    layout.lookBack(false);
    expect(place(layout, "world", "width")).toBe(before);
    expect(changes).toBe(2);
  });

  it("brings a tab to the front while it is called, unless its user chooses another, by pointer or key", () => {
    layout = layoutOf(900);
    const looked: [string, boolean][] = [];
    layout.told = (name, on) => looked.push([name, on]);
    expect(inFront(layout)).toEqual(["variables"]);
    layout.call("issues");
    expect(inFront(layout)).toEqual(["issues"]);
    layout.call(null);
    expect(inFront(layout)).toEqual(["variables"]);
    layout.call("issues");
    tab(layout, "issues").dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true }));
    expect(inFront(layout)).toEqual(["breakpoints"]);
    tab(layout, "breakpoints").dispatchEvent(
      new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true }),
    );
    expect(inFront(layout)).toEqual(["variables"]);
    expect(tab(layout, "variables").getAttribute("tabindex")).toBe("0");
    expect(looked).toEqual([
      ["issues", false],
      ["breakpoints", true],
      ["breakpoints", false],
      ["variables", true],
    ]);
  });
});
