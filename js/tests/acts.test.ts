// @vitest-environment happy-dom
import { EditorState } from "@codemirror/state";
import { EditorView } from "@codemirror/view";
import { beforeEach, describe, expect, it, onTestFinished, vi } from "vitest";
import { Pen } from "../src/editor/pen";
import { Acts } from "../src/graph/acts";
import { lrp } from "../src/language/lrp";
import { type Lab, Store } from "../src/session/store";
import { h } from "../src/ui/dom";
import type { MenuItem } from "../src/ui/menu";

/** On a machine that is held up while it opens the text, so that the editor reads it later. */
function actsOn(doc: string): Acts {
  const clock = vi.spyOn(Date, "now").mockReturnValueOnce(0).mockReturnValue(1000);
  const view = new EditorView({ state: EditorState.create({ doc, extensions: [lrp()] }) });
  onTestFinished(() => view.destroy());
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

describe("a field for one part", () => {
  const TEXT = `(machine car (var me := [robot]) (var n := [2]) (state go))
(machine m (state a (onentry (spawn car go (var n := [3])))) (state b)
  (on near for 1500 a -> b (effect [n = 1
k = 2]))
  (ontime 2000 b -> a) (exit [x] a -> z) (ontime [2 * d] b -> a c))`;
  let acts: Acts;
  let drawn: object[];
  beforeEach(() => {
    document.body.replaceChildren(h("div"));
    acts = actsOn(TEXT);
    drawn = [];
    const root = document.body.firstElementChild as HTMLElement;
    Object.assign(acts.lab, {
      root,
      ask: async (question: object) => {
        drawn.push(question);
        return { error: null, edits: [] };
      },
    });
  });
  const choose = (items: MenuItem[], label: string) => {
    items.find((each) => each.label === label)!.run();
    return [...document.querySelectorAll<HTMLInputElement>(".lrp-field .lrp-input")];
  };
  const apply = async (values: string[]) => {
    const fields = [...document.querySelectorAll<HTMLInputElement>(".lrp-field .lrp-input")];
    fields.forEach((field, index) => {
      field.value = values[index]!;
    });
    document.querySelector("form")!.dispatchEvent(new Event("submit", { cancelable: true }));
    await vi.waitFor(() => expect(document.querySelector("form")).toBeNull());
    return drawn.splice(0).map((act) => {
      const { type, text, ...rest } = act as Record<string, unknown>;
      return rest;
    });
  };
  const at = { x: 0, y: 0 };
  const ofTransition = (id: string) => acts.ofTransition(`m:${id}`, at);

  it("has what is there, in units that one reads", () => {
    const value = (id: string, label: string) => {
      const [field] = choose(ofTransition(id), label);
      document.querySelector("form")!.remove();
      return field!.value;
    };
    expect(value("on:a->b", "When…")).toBe("near for 1500");
    expect(value("on:a->b", "Has to hold for…")).toBe("1500 ms");
    expect(value("on:a->b", "Effect…")).toBe("[n = 1\nk = 2]");
    expect(value("ontime:b->a", "When…")).toBe("2 s");
    expect(value("c", "When…")).toBe("ontime [2 * d]");
    expect(value("exit:a->z", "When…")).toBe("[x]");
  });

  it("is offered for a time to hold only where there is a condition", () => {
    const labels = (id: string) => ofTransition(id).map(({ label }) => label);
    expect(labels("exit:a->z")).toContain("Has to hold for…");
    expect(labels("ontime:b->a")).not.toContain("Has to hold for…");
  });

  it("asks the kernel for one edit; nothing removes a time to hold and an effect", async () => {
    const about = { kind: "transition", path: "m:on:a->b" };
    choose(ofTransition("on:a->b"), "When…");
    expect(await apply(["car.go"])).toEqual([{ act: "trigger", ...about, form: "car.go" }]);
    choose(ofTransition("on:a->b"), "Has to hold for…");
    expect(await apply([""])).toEqual([{ act: "hold", ...about, form: "" }]);
    choose(ofTransition("on:a->b"), "Effect…");
    expect(await apply([""])).toEqual([{ act: "effect", ...about, form: "" }]);
  });

  it("gives a machine that is spawned its start values: those that were changed", async () => {
    const fields = choose(acts.ofState("m/a", at), "Start values of car…");
    expect(fields.map(({ value, placeholder }) => [value, placeholder])).toEqual([
      ["", "robot"],
      ["3", "2"],
    ]);
    const about = { act: "setting", kind: "state", path: "m/a", to: "car" };
    expect(await apply(["robot.follower", ""])).toEqual([
      { ...about, old: "me", form: "robot.follower" },
      { ...about, old: "n", form: "" },
    ]);
    expect(acts.ofState("m/b", at).some(({ label }) => label.startsWith("Start values"))).toBe(false);
  });

  it("of several lines keeps them: there Enter begins another one, Ctrl+Enter applies", () => {
    const [field] = choose(ofTransition("on:a->b"), "Effect…");
    const form = document.querySelector("form")!;
    const submitted = vi.fn((event: Event) => event.preventDefault());
    form.requestSubmit = () => void submitted(new Event("submit"));
    for (const ctrlKey of [false, true])
      field!.dispatchEvent(new KeyboardEvent("keydown", { key: "Enter", ctrlKey, bubbles: true }));
    expect([field!.tagName, submitted.mock.calls.length]).toEqual(["TEXTAREA", 1]);
  });

  it("keeps the time to hold of a transition that is to wait for a state of a machine", async () => {
    await acts.awaitState("m:on:a->b", "car.go");
    expect(drawn).toMatchObject([{ act: "trigger", path: "m:on:a->b", form: "car.go for 1500" }]);
  });
});
