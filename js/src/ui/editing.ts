/** Editing a text in place. */

import { h, setAttribute, setProse } from "./dom";

/** A field: Enter submits its text and closes it, or shows in `error` why the text is refused; Escape closes it. */
export function editing(
  text: string,
  label: string,
  submit: (text: string) => Promise<string | null>,
  close: () => void,
): { input: HTMLInputElement; error: HTMLElement } {
  const error = h("div", { class: "lrp-error", role: "alert" });
  const input = h("input", {
    class: "lrp-input",
    value: text,
    spellcheck: "false",
    "aria-label": label,
    onkeydown: async (event: KeyboardEvent) => {
      if (event.key === "Escape") close();
      if (event.key !== "Enter") return;
      event.preventDefault();
      const refusal = await submit(input.value);
      setAttribute(input, "aria-invalid", refusal ? "true" : null);
      setProse(error, refusal ?? "");
      if (!refusal) close();
    },
  });
  return { input, error };
}
