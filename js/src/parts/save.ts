/** Save the program, or its world, under a chosen name; ask before another file is replaced. */

import type { Lab } from "../session/store";
import { h, setProse } from "../ui/dom";
import { noteForm } from "./form";

/** `what` is part of the names of the buttons. */
export function saveForm(
  lab: Lab,
  what: "file" | "world-file" = "file",
  suggested = () => `${lab.store.state.name || "program"}.lrp`,
  saved = () => {},
): { element: HTMLElement; open: () => void } {
  const input = h("input", {
    class: "lrp-input",
    "aria-label": what === "file" ? "File" : "File of the world",
    spellcheck: "false",
    oninput: () => ask(false),
  });
  const error = h("span", { class: "lrp-error", role: "alert" });
  const replace = h(
    "button",
    {
      class: "lrp-button",
      type: "button",
      "data-lrp-action": `replace-${what}`,
      onclick: () => void save(true),
    },
    "Replace",
  );
  const ask = (on: boolean) => {
    replace.hidden = !on;
    setProse(error, on ? "This file exists and was not written by this lab." : "");
    if (on) replace.focus();
  };
  const save = async (replacing: boolean) => {
    const name = input.value.trim();
    const reply = await lab.ask({ type: what === "file" ? "save" : "save_world", name, replace: replacing });
    ask(reply.exists ?? false);
    if (reply.error) setProse(error, reply.error);
    else if (!reply.exists) {
      form.close();
      lab.notify(`Saved as \`${name}\`.`);
      saved();
    }
  };
  const form = noteForm(
    what === "file" ? "Save the program" : "Save the world",
    () => void save(false),
    [h("label", {}, what === "file" ? "Save as " : "Save the world as "), input],
    h("button", { class: "lrp-button lrp-primary", "data-lrp-action": `save-${what}` }, "Save"),
    [error, replace],
  );
  return {
    element: form.element,
    open() {
      input.value ||= suggested();
      ask(false);
      form.show();
      input.focus();
      input.select();
    },
  };
}
