/** A small form in the graph: a name or a trigger is written where it is drawn. */

import { consume, freshId, h, prose, setProse } from "../ui/dom";
import { type Point, placeInSight } from "../ui/point";
import { openPopup } from "../ui/popup";

const EDGE = 6; // px between the form and the edge of what can be seen
const MOST_LINES = 8; // of code that are seen at a time

export interface Entry {
  label: string;
  value?: string;
  placeholder?: string;
  /** Where the cursor begins; all is selected without it. */
  cursor?: number;
  options?: readonly string[];
  optional?: boolean;
}

interface Field {
  title: string;
  entries: Entry[];
  /** What can be written. */
  note?: string;
  /** What it is about, and must not cover: rectangles of the window. */
  about?: readonly DOMRect[];
  /** A switch below the entries. */
  check?: string;
  /** Apply what was written; resolves to the sentence that refuses it, or null. */
  submit(values: string[], checked: boolean): Promise<string | null>;
  closed?(): void;
}

/** Open a form at a point of the window, inside `host`; Enter applies it, Escape and a press elsewhere close it. */
export function openField(host: HTMLElement, at: Point, field: Field): void {
  const error = h("p", { class: "lrp-error", role: "alert" });
  const inputs = field.entries.map((entry) => input(entry));
  const check = field.check ? h("input", { type: "checkbox" }) : null;
  let isSent = false;
  const form = h(
    "form",
    {
      class: "lrp-field",
      "aria-label": field.title,
      onkeydown: (event: KeyboardEvent) => {
        if (event.key === "Escape") close(true);
        else if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) {
          consume(event);
          form.requestSubmit();
        }
      },
      onsubmit: async (event: Event) => {
        event.preventDefault();
        const empty = inputs.find(
          ({ control }, index) => !control.value.trim() && !field.entries[index]!.optional,
        );
        if (empty) {
          empty.control.focus();
          return;
        }
        if (isSent) return;
        isSent = true;
        const values = inputs.map(({ control }) => control.value.trim());
        const refusal = await field.submit(values, check?.checked ?? false);
        isSent = false;
        if (refusal) setProse(error, refusal);
        else close(true);
      },
    },
    ...inputs.map(({ row }) => row),
    field.note && h("p", { class: "lrp-field-note lrp-faint" }, ...prose(field.note)),
    check && h("label", { class: "lrp-field-check" }, check, field.check),
    error,
    h("button", { type: "submit", class: "lrp-button lrp-primary lrp-field-apply" }, "OK"),
  );
  const place = () => placeInSight(host, form, at, EDGE, field.about);
  const close = openPopup(host, form, place, field.closed);
  const first = inputs[0]!.control;
  first.focus({ preventScroll: true });
  const { cursor } = field.entries[0]!;
  if (cursor === undefined) first.select();
  else first.setSelectionRange(cursor, cursor);
}

/** Several lines stay so: there Enter begins another one, and Ctrl+Enter applies. */
function input(entry: Entry): { row: HTMLElement; control: HTMLInputElement | HTMLTextAreaElement } {
  const { value = "" } = entry;
  const lines = value.split("\n").length;
  const list = entry.options?.length && lines === 1 ? freshId() : null;
  const about = {
    class: "lrp-input",
    placeholder: entry.placeholder ?? "",
    spellcheck: "false",
    autocomplete: "off",
    "aria-label": entry.label,
  };
  const control =
    lines > 1
      ? h("textarea", { ...about, rows: Math.min(lines, MOST_LINES), title: "Ctrl+Enter applies" }, value)
      : h("input", { ...about, type: "text", value, list });
  const options = entry.options?.map((value) => h("option", { value })) ?? [];
  const offer = list && h("datalist", { id: list }, ...options);
  const row = h("label", {}, h("span", {}, entry.label), control, offer);
  return { row, control };
}
