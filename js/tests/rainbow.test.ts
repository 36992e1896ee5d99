// @vitest-environment happy-dom

import { forceParsing } from "@codemirror/language";
import { EditorView } from "@codemirror/view";
import { expect, it } from "vitest";
import { rainbow } from "../src/editor/rainbow";
import { lrp } from "../src/language/lrp";

/** Every bracket that is coloured, with its depth. */
function depths(text: string): string {
  const view = new EditorView({ doc: text, extensions: [lrp(), rainbow], parent: document.body });
  forceParsing(view, text.length, 10_000);
  const found = [...view.dom.querySelectorAll("[class^=lrp-bracket]")];
  view.destroy();
  return found.map((span) => span.textContent + span.className.replace("lrp-bracket-", "")).join(" ");
}

it("a bracket has the colour of its depth, and of the one it belongs to", () => {
  expect(depths("(state a (running [x]))")).toBe("(0 (1 [2 ]2 )1 )0");
  expect(depths("(eps {a b} -> c)")).toBe("(0 {1 }1 )0");
  expect(depths("(event e [f(x[1])])")).toBe("(0 [1 (2 [3 ]3 )2 ]1 )0");
});
