/** What can be expected of a run: proposals for a field. */

import type { LabState } from "../session/state";
import { linkButton } from "../ui/button";
import { freshId, h } from "../ui/dom";

/** Make a field propose what can be expected; returns what stands below it: how such a line can begin. */
export function proposing(input: HTMLInputElement, { program, goal, runs }: LabState): HTMLElement {
  const states = program.machines.flatMap((machine) => machine.states.map(({ path }) => path));
  const meets = goal && runs ? [runs.expected] : [];
  const forms = ["as recorded", "never touches", ...meets, "reaches ", "never enters "];
  const lines = forms.flatMap((form) => (form.endsWith(" ") ? states.map((state) => form + state) : [form]));
  const id = freshId();
  const list = h("datalist", { id }, ...lines.map((value) => h("option", { value })));
  input.setAttribute("list", id);
  const write = (text: string) => {
    const before = /^.*,/.exec(input.value)?.[0] ?? "";
    input.value = input.value.trim().endsWith(",") ? `${before} ${text}` : text;
    input.focus();
    if (text.endsWith(" ")) show(input);
  };
  const buttons = [...forms, ...(meets.length ? [] : ["meets "])].map((text) =>
    linkButton(text.endsWith(" ") ? `${text}…` : text, {
      "data-lrp-action": "expectation",
      onclick: () => write(text),
    }),
  );
  return h("div", { class: "lrp-expectations" }, list, ...buttons);
}

/** Open the list of a field, in browsers that can. */
function show(input: HTMLInputElement): void {
  try {
    input.showPicker?.();
  } catch {} // it was not pressed, but called
}
