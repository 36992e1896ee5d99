/** What can be expected of a run: proposals for a field. */

import type { LabState } from "../session/state";
import { linkButton } from "../ui/button";
import { freshId, h } from "../ui/dom";

/** Every line that is proposed, with the states of the program, and the challenge that it is written for. */
export function expectations({ program, goal }: Pick<LabState, "program" | "goal">): string[] {
  const states = program.machines.flatMap((machine) => machine.states.map(({ path }) => path));
  return [
    "as recorded",
    "never touches",
    ...(goal ? [`meets ${goal.name}`] : []),
    ...["reaches", "never enters"].flatMap((verb) => states.map((state) => `${verb} ${state}`)),
  ];
}

/** Make a field propose what can be expected; returns what stands below it: how such a line can begin. */
export function proposing(input: HTMLInputElement, state: LabState): HTMLElement {
  const id = freshId();
  const list = h("datalist", { id }, ...expectations(state).map((value) => h("option", { value })));
  input.setAttribute("list", id);
  const write = (text: string) => {
    const before = /^.*,/.exec(input.value)?.[0] ?? "";
    input.value = input.value.trim().endsWith(",") ? `${before} ${text}` : text;
    input.focus();
    if (text.endsWith(" ")) show(input);
  };
  const { goal } = state;
  const words = [
    "as recorded",
    "reaches ",
    "never enters ",
    "never touches",
    goal ? `meets ${goal.name}` : "meets ",
  ];
  const buttons = words.map((text) =>
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
