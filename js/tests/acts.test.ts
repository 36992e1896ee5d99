// @vitest-environment happy-dom
import { EditorState } from "@codemirror/state";
import { EditorView } from "@codemirror/view";
import { expect, it, vi } from "vitest";
import { Pen } from "../src/editor/pen";
import { Acts } from "../src/graph/acts";
import { lrp } from "../src/language/lrp";
import { type Lab, Store } from "../src/session/store";

/** On a machine that is held up while it opens the text, so that the editor reads it later. */
function actsOn(doc: string): Acts {
  const clock = vi.spyOn(Date, "now").mockReturnValueOnce(0).mockReturnValue(1000);
  const view = new EditorView({ state: EditorState.create({ doc, extensions: [lrp()] }) });
  clock.mockRestore();
  const lab = { store: new Store() } as unknown as Lab;
  lab.store.set("machine", "finger");
  return new Acts(lab, new Pen(view, lab), () => []);
}

it("an exit can be led to the states among which it lands", () => {
  const acts = actsOn("(machine finger)\n");
  const layout = (machine: string, names: string[], transitions: object[] = []) => ({
    machine,
    transitions,
    states: names.map((name) => ({ name, kind: "state" })),
  });
  const layouts = {
    m: layout("m", ["a", "b"], [{ id: "m/a/i:t", lands: true }]),
    "m/a/i": layout("m/a/i", ["x", "y"], [{ id: "m/a/i:t", lands: false }]),
  };
  Object.assign(acts.lab.store.state, { layouts });
  const asked = vi.spyOn(acts as unknown as { other: () => void }, "other").mockReturnValue();
  for (const item of acts.ofTransition("m/a/i:t", { x: 0, y: 0 }))
    if (/To an|From an/.test(item.label)) item.run();
  expect(asked.mock.calls.map((call: unknown[]) => call[3])).toEqual([
    ["x", "y"],
    ["a", "b"],
  ]);
});

it("a machine that was just drawn is drawn on, also before the kernel has told of it", () => {
  expect(actsOn("(machine finger)\n").machine).toBe("finger");
  expect(actsOn("; nothing\n").machine).toBe("");
});
