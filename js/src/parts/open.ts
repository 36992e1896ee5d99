/** Ask before another program replaces the text and the name of the lab. */

import type { Lab } from "../session/store";
import { h, prose, setHidden } from "../ui/dom";

/** `open` opens a bundled program, at once if there is no text to replace. */
export function openForm(
  lab: Lab,
  text: () => string,
): { element: HTMLElement; open: (name: string) => void } {
  let wanted = "";
  const question = h("p", {});
  const ok = h("button", { class: "lrp-button lrp-primary", "data-lrp-action": "open" }, "Open");
  const close = () => setHidden(element, true);
  const load = async () => {
    if (!(await lab.act({ do: "load", name: wanted }))) close();
  };
  const element = h(
    "form",
    {
      class: "lrp-note",
      hidden: true,
      "aria-label": "Open a program",
      onsubmit: (event: SubmitEvent) => {
        event.preventDefault();
        void load();
      },
      onkeydown: (event: KeyboardEvent) => {
        if (event.key === "Escape") close();
      },
    },
    question,
    ok,
    h("button", { class: "lrp-button", type: "button", onclick: close }, "Cancel"),
  );
  return {
    element,
    open(name) {
      wanted = name;
      if (!text().trim()) return void load();
      const sentence = `Replace \`${lab.store.state.name}\` by \`${name}\`? Its text stays in the versions.`;
      question.replaceChildren(...prose(sentence));
      element.hidden = false;
      ok.focus();
    },
  };
}
