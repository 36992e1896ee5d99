/** Save the program under a chosen name. */

import type { Lab } from "../session/store";
import { h } from "../ui/dom";

export function saveForm(lab: Lab): { element: HTMLElement; open: () => void } {
  const input = h("input", { class: "lrp-input", "aria-label": "File", spellcheck: "false" });
  const error = h("span", { class: "lrp-error", role: "alert" });
  const close = () => {
    element.hidden = true;
  };
  const element = h(
    "form",
    {
      class: "lrp-note",
      hidden: true,
      onsubmit: async (event: SubmitEvent) => {
        event.preventDefault();
        const refusal = await lab.act({ do: "save", name: input.value.trim() }, true);
        error.textContent = refusal ?? "";
        if (!refusal) {
          close();
          lab.notify(`Saved as ${input.value.trim()}.`);
        }
      },
      onkeydown: (event: KeyboardEvent) => {
        event.stopPropagation();
        if (event.key === "Escape") close();
      },
    },
    h("label", {}, "Save as "),
    input,
    h("button", { class: "lrp-button lrp-primary", "data-lrp-action": "save-file" }, "Save"),
    h("button", { class: "lrp-button", type: "button", onclick: close }, "Cancel"),
    error,
  );
  return {
    element,
    open() {
      input.value ||= `${lab.store.state.name || "program"}.lrp`;
      element.hidden = false;
      input.focus();
      input.select();
    },
  };
}
