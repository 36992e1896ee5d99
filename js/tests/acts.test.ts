// @vitest-environment happy-dom
import { EditorState } from "@codemirror/state";
import { EditorView } from "@codemirror/view";
import { expect, it } from "vitest";
import { Pen } from "../src/editor/pen";
import { Acts } from "../src/graph/acts";
import { lrp } from "../src/language/lrp";
import { type Lab, Store } from "../src/session/store";

function actsOn(doc: string): Acts {
  const view = new EditorView({ state: EditorState.create({ doc, extensions: [lrp()] }) });
  const lab = { store: new Store() } as unknown as Lab;
  lab.store.set("machine", "finger");
  return new Acts(lab, new Pen(view, lab), document.body);
}

it("a machine that was just drawn is drawn on, also before the kernel has told of it", () => {
  expect(actsOn("(machine finger)\n").machine).toBe("finger");
  expect(actsOn("; nothing\n").machine).toBe("");
});
