// @vitest-environment happy-dom

import { beforeEach, describe, expect, it } from "vitest";
import { controls } from "../src/parts/controls";
import type { BridgeView } from "../src/protocol";
import { type Lab, Store } from "../src/session/store";
import { bridgePanel } from "../src/world/panel";

const FAILSAFE = "If this program dies, a guard stops the robot, or `lrp guard` does.";
const ROS: BridgeView = {
  name: "ros",
  status: "connected",
  sentence: "Connected.",
  hardware: true,
  armed: false,
  failsafe: FAILSAFE,
  members: [],
};
const STOP = { key: "stop", label: "Stop robot" };

describe("arming a robot", () => {
  const stops = () => [...root.querySelectorAll<HTMLButtonElement>(".lrp-stop")];

  let root: HTMLElement;
  let store: Store;
  const acts: unknown[] = [];
  const find = (selector: string) => root.querySelector<HTMLElement>(selector);
  const press = (action: string) => find(`[data-lrp-action="${action}"]`)!.click();
  const set = async (bridge: Partial<BridgeView>) => {
    store.set("bridge", { ...store.state.bridge, ...bridge });
    await new Promise((over) => requestAnimationFrame(over));
  };
  beforeEach(() => {
    acts.length = 0;
    store = new Store();
    store.state.bridge = ROS;
    store.state.panel = { title: "ROS", fields: [], tables: [], buttons: [STOP], questions: [] };
    root = document.createElement("div");
    document.body.replaceChildren(root);
    const act = async (each: unknown) => void acts.push(each);
    const lab = { store, root, act } as unknown as Lab;
    const choices = { bridges: [], programs: [], worlds: [] };
    root.append(controls(lab, choices as never, document.createElement("div")), bridgePanel(lab));
  });

  for (const [place, action] of [
    ["the switch", "armed"],
    ["the panel", "panel-arm"],
  ] as const) {
    it(`says first who stops it, in ${place}`, () => {
      press(action);
      const dialog = find('[role="dialog"]')!;
      expect(dialog.getAttribute("aria-label")).toBe("Arm ros?");
      expect(dialog.querySelector(".lrp-failsafe")!.textContent).toBe(FAILSAFE.replaceAll("`", ""));
      expect(dialog.querySelector(".lrp-failsafe code")!.textContent).toBe("lrp guard");
      expect(acts).toEqual([]);
      press("confirm-arm");
      expect(acts).toEqual([{ do: "armed", on: true }]);
      expect(find('[role="dialog"]')).toBeNull();
    });
  }

  it("says first that a stop may come late, and what holds then", async () => {
    store.set("late", "While a cell runs, `Stop` waits.");
    press("armed");
    const words = [...find('[role="dialog"]')!.querySelectorAll("p:not([hidden])")].map((p) => p.textContent);
    expect(words.slice(1)).toEqual(["While a cell runs, Stop waits.", FAILSAFE.replaceAll("`", "")]);
    store.set("late", "");
    await set({});
    expect(find(".lrp-arm-late")!.hidden).toBe(true);
  });

  it("is not done when the question is closed", () => {
    press("armed");
    press("close-arming");
    expect(find('[role="dialog"]')).toBeNull();
    expect(acts).toEqual([]);
  });

  it("needs no question the other way round", async () => {
    await set({ armed: true });
    press("armed");
    expect(acts).toEqual([{ do: "armed", on: false }]);
    expect(find('[role="dialog"]')).toBeNull();
  });

  it("is no longer a question when it was armed elsewhere, or it is another robot", async () => {
    for (const answer of [{ armed: true }, { name: "ev3" }]) {
      await set(ROS);
      press("armed");
      expect(find('[role="dialog"]')).not.toBeNull();
      await set(answer);
      expect(find('[role="dialog"]')).toBeNull();
    }
  });

  it("shows in the panel, and in the question, when that changes", async () => {
    press("armed");
    await set({ failsafe: "Nothing stops the robot." });
    const shown = [...root.querySelectorAll(".lrp-failsafe")].map((each) => each.textContent);
    expect(shown).toEqual(["Nothing stops the robot.", "Nothing stops the robot."]);
    expect(find('[data-lrp-action="armed"]')!.title).toContain("While disarmed");
    await set({ armed: true });
    expect(find('[data-lrp-action="armed"]')!.title).toBe("Nothing stops the robot.");
  });

  it("has nothing to say of a simulated robot", async () => {
    await set({ name: "sim", hardware: false, armed: true, failsafe: "" });
    expect(find(".lrp-failsafe")!.hidden).toBe(true);
  });

  it.each([
    ["live", "", "Stop robot", false],
    ["busy", "", "Stop robot", false],
    ["live", "It waits.", "Stop after cells", false],
    ["busy", "It waits.", "Stops after the cell", false],
    ["lost", "It waits.", "Not reachable", false],
    ["dead", "", "Not reachable", true],
  ] as const)("each button to stop it says how far it reaches: %s, %s", async (link, why, label, off) => {
    store.set("link", link);
    store.set("late", why);
    await set({});
    expect(stops().map(({ dataset }) => dataset.lrpAction)).toEqual(["stop", "panel-stop"]);
    for (const stop of stops()) {
      expect([stop.textContent, stop.disabled]).toEqual([label, off]);
      expect(stop.hasAttribute("data-away")).toBe(label === "Not reachable");
      expect(stop.title).toContain(label === "Not reachable" ? "does not answer" : why || "Stop");
    }
  });
});
