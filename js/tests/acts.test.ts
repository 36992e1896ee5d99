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

it("a machine that was just drawn is drawn on, also before the kernel has told of it", () => {
  expect(actsOn("(machine finger)\n").machine).toBe("finger");
  expect(actsOn("; nothing\n").machine).toBe("");
});
