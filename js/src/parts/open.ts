/** Ask before another program replaces the text and the name of the lab. */

import type { Lab } from "../session/store";
import { h, setProse } from "../ui/dom";
import { noteForm } from "./form";

/** `open` opens a bundled program, at once if there is no text to replace. */
export function openForm(
  lab: Lab,
  text: () => string,
): { element: HTMLElement; open: (name: string) => void } {
  let wanted = "";
  const question = h("p", {});
  const ok = h("button", { class: "lrp-button lrp-primary", "data-lrp-action": "open" }, "Open");
  const load = async () => {
    if (!(await lab.act({ do: "load", name: wanted }))) form.close();
  };
  const form = noteForm("Open a program", () => void load(), [question], ok);
  return {
    element: form.element,
    open(name) {
      wanted = name;
      if (!text().trim()) return void load();
      const sentence = `Replace \`${lab.store.state.name}\` with \`${name}\`? Its text is kept: see Versions… in the menu.`;
      setProse(question, sentence);
      form.show();
      ok.focus();
    },
  };
}
