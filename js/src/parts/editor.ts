/** The editor's panel: the text, its status, and bundled programs to start with when it is empty. */

import type { Editor } from "../editor/editor";
import type { LabState } from "../session/state";
import type { Lab } from "../session/store";
import { button, panel } from "../ui/button";
import { h, setAttribute, setProse, unmarked } from "../ui/dom";
import { isAway, LINKS } from "./reach";

export function editorPanel(lab: Lab, editor: Editor): HTMLElement {
  const host = h("div", { class: "lrp-editor" }, editor.view.dom);
  return panel("editor", "Program", [verdict(lab)], host, beginnings(lab, editor)).element;
}

/** One line: whether this text runs, and if not, why. */
function verdict(lab: Lab): HTMLElement {
  const { store } = lab;
  const line = h("span", { class: "lrp-verdict", role: "status" });
  store.watch(["findings", "accepted", "patch", "pending", "status", "link", "snapshot"], () => {
    const [state, words] = verdictOf(store.state);
    setAttribute(line, "data-state", state);
    setAttribute(line, "title", unmarked(words));
    setProse(line, words);
  });
  return line;
}

function verdictOf({ findings, accepted, patch, pending, status, link }: LabState): [string, string] {
  if (isAway({ link })) return ["waits", LINKS[link]!];
  if (!accepted) {
    const errors = findings.filter(({ severity }) => severity === "error").length;
    const words = errors === 1 ? "1 error" : errors ? `${errors} errors` : "unfinished";
    const goesOn = status === "running" ? "; the last valid program keeps running" : "";
    return [errors ? "broken" : "waits", words + goesOn];
  }
  if (status === "broken") return ["waits", "not running"];
  if (pending) return ["held", "held"];
  if (patch) return ["waits", patch];
  return ["runs", status === "running" ? "runs" : "applied"];
}

/** Offer the bundled programs while the text is empty. */
function beginnings(lab: Lab, editor: Editor): HTMLElement {
  const { store } = lab;
  const list = h("div", { class: "lrp-row" });
  const offer = h("div", { class: "lrp-beginnings" }, h("p", {}, "Start with"), list);
  const update = () => {
    offer.hidden = editor.text.trim() !== "" || store.state.choices.programs.length === 0;
  };
  store.watch(["choices", "snapshot"], () => {
    const buttons = store.state.choices.programs.map((name) =>
      button({
        label: name,
        title: `Open ${name}`,
        action: `begin-${name}`,
        onclick: () => void lab.act({ do: "load", name }),
      }),
    );
    list.replaceChildren(...buttons);
  });
  store.watch(["choices", "snapshot", "findings", "revision", "program"], update);
  return offer;
}
