// @vitest-environment happy-dom
import { describe, expect, it, vi } from "vitest";
import type { Field, Panel, Table } from "../src/protocol";
import { type Lab, Store } from "../src/session/store";
import { h } from "../src/ui/dom";
import { inputs, values } from "../src/world/fields";
import { bridgePanel } from "../src/world/panel";
import { tableOf } from "../src/world/table";

function field(key: string, more: Partial<Field> = {}): Field {
  return { key, label: key, kind: "text", value: "", choices: [], unit: "", press: "", ...more };
}

function panel(...fields: Field[]): Panel {
  return { title: "", fields, tables: [], buttons: [], questions: [] };
}

function drawn(view: Panel, press: (key: string, row: string) => void = () => {}) {
  const filled = inputs(view, press);
  filled.refresh(view);
  const input = (key: string) => filled.element.querySelector<HTMLInputElement>(`[data-field="${key}"]`)!;
  return { ...filled, input };
}

describe("the fields of a panel", () => {
  it("keep what was typed until the bridge reports another value", () => {
    const { input, refresh, element } = drawn(panel(field("topic"), field("speed", { value: "50" })));
    input("topic").value = "/od";
    refresh(panel(field("topic"), field("speed", { value: "50" })));
    expect(values(element)).toEqual({ topic: "/od", speed: "50" });
    refresh(panel(field("topic", { value: "/odom" }), field("speed", { value: "50" })));
    expect(input("topic").value).toBe("/odom");
  });

  it("are cleared after their button, except those that the bridge fills in", () => {
    const empty = panel(
      field("topic"),
      field("file", { value: "a.json" }),
      field("late", { kind: "number" }),
      field("on", { kind: "switch" }),
    );
    const { input, clear, refresh } = drawn(empty);
    input("topic").value = "/odom";
    input("late").value = "0.5";
    input("on").checked = true;
    clear();
    refresh(empty);
    expect(["topic", "file", "late"].map((key) => input(key).value)).toEqual(["", "a.json", ""]);
    expect(input("on").checked).toBe(true);
  });

  it("press their button when one of the choices is selected", () => {
    const press = vi.fn();
    const { input } = drawn(panel(field("topic", { choices: ["/odom"], press: "pick" })), press);
    for (const typed of ["/od", "/odom"]) {
      input("topic").value = typed;
      input("topic").dispatchEvent(new Event("input"));
    }
    expect(press.mock.calls).toEqual([["pick", "/odom"]]);
  });

  it("are gone to when a row of a table is picked for them", async () => {
    const [store, act] = [new Store(), vi.fn(async () => null)];
    const topics: Table = {
      key: "topics",
      title: "Topics",
      columns: ["topic"],
      keys: ["/odom"],
      rows: [["/odom"]],
      buttons: [{ key: "pick", label: "Pick" }],
    };
    store.state.panel = { ...panel(field("variable"), field("topic", { press: "pick" })), tables: [topics] };
    const shown = bridgePanel({ store, act, root: document.body } as unknown as Lab);
    document.body.append(shown);
    await new Promise((over) => requestAnimationFrame(over));
    shown.querySelector<HTMLElement>('[data-lrp-action="panel-pick"]')!.click();
    await vi.waitFor(() => expect((document.activeElement as HTMLElement).dataset.field).toBe("topic"));
    expect(act).toHaveBeenCalledWith(expect.objectContaining({ key: "pick", row: "/odom" }));
    shown.remove();
  });

  it("keep what was chosen in a list, while the choices are the same", () => {
    const mode = (value: string, ...choices: string[]) =>
      panel(field("mode", { kind: "choice", choices, value }));
    const { element, input, refresh } = drawn(mode("a", "a", "b", "c"));
    const options = [...input("mode").children];
    input("mode").value = "b";
    refresh(mode("a", "a", "b", "c"));
    expect(values(element)).toEqual({ mode: "b" });
    expect([...input("mode").children]).toEqual(options);
    refresh(mode("a", "x", "a"));
    expect(values(element)).toEqual({ mode: "a" });
  });

  it("are switches and lists, too", () => {
    const { element, input } = drawn(
      panel(
        field("on", { kind: "switch", value: "true" }),
        field("mode", { kind: "choice", choices: ["a", "b"], value: "b" }),
      ),
    );
    expect(values(element)).toEqual({ on: "true", mode: "b" });
    input("on").checked = false;
    expect(values(element).on).toBe("false");
  });
});

describe("what a panel only shows", () => {
  it("has its code marked, as the sentence above it", async () => {
    const store = new Store();
    const by = field("backend", { kind: "value", value: "rosbridge, because `ws://turtle:9090` answers" });
    store.state.panel = panel(by);
    const shown = bridgePanel({ store, root: document.body } as unknown as Lab);
    await new Promise((over) => requestAnimationFrame(over));
    const output = shown.querySelector('[data-show="backend"]')!;
    expect(output.querySelector("code")?.textContent).toBe("ws://turtle:9090");
    expect(output.textContent).toBe("rosbridge, because ws://turtle:9090 answers");
  });
});

describe("a table of a panel", () => {
  const table: Table = {
    key: "motors",
    title: "Motors",
    columns: ["motor", "type", "count (deg)"],
    keys: ["a", "b"],
    rows: [
      ["a", "large motor", "12"],
      ["b", "", ""],
    ],
    buttons: [{ key: "stop", label: "Stop" }],
  };

  it("names the columns of numbers in its cards", () => {
    const { element, refresh } = tableOf(table, ({ label }) => h("button", {}, label));
    refresh(table);
    const cells = [...element.querySelectorAll("[data-row=a] td[data-column]")];
    expect(cells.map((cell) => cell.getAttribute("data-label"))).toEqual([null, null, "count (deg)"]);
  });

  it("keeps the rows that stay, with the focus in them", () => {
    const { element, refresh } = tableOf(table, ({ label }) => h("button", {}, label));
    refresh(table);
    const row = element.querySelector("[data-row=b]");
    refresh({
      ...table,
      keys: ["c", "b"],
      rows: [
        ["c", "", ""],
        ["b", "touch", "1"],
      ],
    });
    expect(element.querySelector("[data-row=b]")).toBe(row);
    expect(row?.textContent).toContain("touch");
    expect(element.querySelector("[data-row=a]")).toBeNull();
  });

  it("marks the code in its sentences", () => {
    const { element, refresh } = tableOf(table, ({ label }) => h("button", {}, label));
    const row = ["c", "Set `light` to port 2, where one is.", "1"];
    refresh({ ...table, keys: ["c"], rows: [row] });
    const cell = element.querySelector<HTMLElement>('[data-column="type"]')!;
    expect(cell.querySelector("code")?.textContent).toBe("light");
    expect(cell.title).toBe("Set light to port 2, where one is.");
    const code = cell.firstElementChild;
    refresh({ ...table, keys: ["c"], rows: [row] });
    expect(cell.firstElementChild).toBe(code);
  });

  it("shows that it is empty", () => {
    const { element, refresh } = tableOf(table, ({ label }) => h("button", {}, label));
    refresh({ ...table, keys: [], rows: [] });
    expect(element.querySelector<HTMLElement>(".lrp-empty")?.hidden).toBe(false);
  });
});
