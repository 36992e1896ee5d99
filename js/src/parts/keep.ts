/** Keep the present run as an example, and show those of another folder, too. */

import type { Lab } from "../session/store";
import { type ButtonOptions, button, disabledDuring } from "../ui/button";
import { h, setAttribute, setHidden, setProse, unmarked } from "../ui/dom";
import { proposing } from "./expected";
import { noteForm } from "./form";

const KEEPS = "Keep this run, from its beginning until now, as an example that runs again after every edit";

/** A form that asks the kernel; it closes when that has agreed, and what it refuses stays as it was typed. */
function asking(
  name: string,
  question: HTMLElement[],
  answer: HTMLButtonElement,
  details: HTMLElement[],
  ask: () => Promise<string | null>,
) {
  const error = h("p", { class: "lrp-error", role: "alert" });
  const submit = async () => {
    if (answer.disabled) return;
    const refusal = await disabledDuring(answer, ask()); // it may take a moment
    setProse(error, refusal ?? "");
    if (!refusal) form.close();
  };
  const form = noteForm(name, () => void submit(), question, answer, [...details, error]);
  return {
    element: form.element,
    show(first: HTMLInputElement) {
      setProse(error, "");
      form.show();
      first.focus();
      first.select();
    },
  };
}

function field(label: string, more: Record<string, string> = {}): HTMLInputElement {
  return h("input", {
    ...{ class: "lrp-input", "aria-label": label, spellcheck: "false", autocomplete: "off" },
    ...more,
  });
}

function primary(label: string, action: string): HTMLButtonElement {
  return h("button", { class: "lrp-button lrp-primary", "data-lrp-action": action }, label);
}

/** The form for a run that is to be kept: its name, and what is expected of it. */
export function keepForm(lab: Lab): { element: HTMLElement; open: () => void } {
  const name = field("Name of the run", { placeholder: "a name" });
  const expected = field("What is expected of it");
  const proposals = h("div", {});
  const form = asking(
    "Keep this run",
    [h("label", {}, "Keep this run as "), name, h("label", {}, "and expect "), expected],
    primary("Keep", "keep-run-now"),
    [proposals],
    () => lab.act({ do: "keep_run", name: name.value.trim(), expected: expected.value.trim() }, true),
  );
  return {
    element: form.element,
    open() {
      if (form.element.hidden) {
        name.value = "";
        expected.value = lab.store.state.runs?.expected ?? "";
        proposals.replaceChildren(proposing(expected, lab.store.state));
      }
      form.show(name);
    },
  };
}

/** The form for the folder of runs that are to be shown, too. */
export function attachForm(lab: Lab): { element: HTMLElement; open: () => void } {
  const folder = field("Folder with recordings", { placeholder: "runs/" });
  const form = asking(
    "Attach runs",
    [h("label", {}, "Show and run the recordings in the folder "), folder],
    primary("Attach", "attach-runs-now"),
    [],
    () => lab.act({ do: "attach_runs", folder: folder.value.trim() }, true),
  );
  return { element: form.element, open: () => form.show(folder) };
}

/** A button that opens the form; it says why the present run cannot be kept. */
export function keepButton(
  { store }: Lab,
  open: () => void,
  more: Partial<ButtonOptions> = {},
): HTMLButtonElement {
  const element = button({
    ...{ icon: "save", label: "Keep this run", title: KEEPS, action: "keep-run", onclick: open },
    ...more,
  });
  store.watch(["runs"], () => {
    const { runs } = store.state;
    setHidden(element, !runs);
    element.disabled = Boolean(runs?.keeps);
    setAttribute(element, "title", unmarked(runs?.keeps || KEEPS));
  });
  return element;
}
