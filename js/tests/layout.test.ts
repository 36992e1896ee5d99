// @vitest-environment happy-dom

import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { h } from "../src/ui/dom";
import { Layout, type Panels } from "../src/ui/layout";

const NAMES = ["goal", "editor", "tree", "graph", "world", "variables", "issues"] as const;

function layoutOf(width: number): Layout {
  const panels = Object.fromEntries(NAMES.map((name) => [name, h("section", { class: "lrp-panel" })]));
  panels.goal?.toggleAttribute("data-goalless", true);
  const layout = new Layout(panels as Panels);
  Object.defineProperty(layout.element, "clientWidth", { value: width });
  layout.maximise(null); // computes the places
  return layout;
}

const height = (layout: Layout, name: keyof Panels) =>
  layout.panels[name].style.getPropertyValue("--lrp-box-height");

describe("the layout", () => {
  let layout: Layout;
  beforeEach(() => localStorage.clear());
  afterEach(() => layout.close());

  it("gives the panel of a real robot more room than the picture of a world", async () => {
    layout = layoutOf(900);
    expect(height(layout, "world")).toBe("44%");
    layout.panels.world.toggleAttribute("data-worldless", true);
    await new Promise((resolve) => setTimeout(resolve, 20));
    expect(height(layout, "world")).toBe("58%");
  });

  it("puts a challenge at the left of the program, over its world", async () => {
    layout = layoutOf(1400);
    const left = (name: keyof Panels) => layout.panels[name].style.getPropertyValue("--lrp-box-left");
    expect(layout.panels.goal.hasAttribute("data-away")).toBe(true);
    expect(left("editor")).toBe("0%");
    layout.panels.goal.toggleAttribute("data-goalless", false);
    await new Promise((resolve) => setTimeout(resolve, 20));
    expect([left("goal"), left("world"), left("editor")]).toEqual(["0%", "0%", "42%"]);
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

  it("keeps for the next lab which panels are hidden, and what its user's bars have set", () => {
    layout = layoutOf(900);
    layout.show("issues", false);
    const bar = layout.element.querySelector<HTMLElement>('[aria-label="Height of the world"]');
    bar?.dispatchEvent(new KeyboardEvent("keydown", { key: "End" }));
    layout.close();
    layout = layoutOf(900);
    expect(layout.panels.issues.hidden).toBe(true);
    expect(height(layout, "world")).toBe("85%");
  });
});
