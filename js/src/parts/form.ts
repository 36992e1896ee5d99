/** A form in the place of the notes: a question with its answer, Cancel and Escape. */

import { h, setHidden } from "../ui/dom";

/** `answer` is the button that submits; `details` stand below the buttons. */
export function noteForm(
  name: string,
  submit: () => void,
  question: HTMLElement[],
  answer: HTMLButtonElement,
  details: HTMLElement[] = [],
): { element: HTMLElement; show(): void; close(): void } {
  const close = () => setHidden(element, true);
  const element = h(
    "form",
    {
      class: "lrp-note",
      hidden: true,
      "aria-label": name,
      onsubmit: (event: SubmitEvent) => {
        event.preventDefault();
        submit();
      },
      onkeydown: (event: KeyboardEvent) => {
        if (event.key === "Escape") close();
      },
    },
    ...question,
    answer,
    h("button", { class: "lrp-button", type: "button", onclick: close }, "Cancel"),
    ...details,
  );
  return { element, show: () => setHidden(element, false), close };
}
