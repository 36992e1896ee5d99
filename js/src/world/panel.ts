/** A bridge's panel, drawn from plain data: fields, tables, buttons, questions. Paper: §7.1, §7.2, §7.3. */

import type { PanelButton, PanelField, PanelQuestion, PanelTable, PanelView } from "../protocol";
import type { Lab } from "../session/store";
import { button } from "../ui/button";
import { h } from "../ui/dom";

export function bridgePanel(lab: Lab): HTMLElement {
  const { store } = lab;
  const body = h("div", { class: "lrp-bridge-panel" });
  let shape = "";
  store.watch(["panel", "snapshot"], () => {
    const { panel } = store.state;
    body.hidden = !panel;
    if (!panel) return;
    const now = shapeOf(panel);
    if (now === shape) refresh(body, panel);
    else body.replaceChildren(...build(panel, lab, body));
    shape = now;
  });
  return body;
}

/** Everything but values: while that stays, what the person has typed into fields stays too. */
function shapeOf(panel: PanelView): string {
  return JSON.stringify({
    ...panel,
    fields: panel.fields.map((field) => ({ ...field, value: "" })),
    tables: panel.tables.map((table) => ({ ...table, rows: [] })),
  });
}

function values(body: HTMLElement): Record<string, string> {
  const all: Record<string, string> = {};
  for (const input of body.querySelectorAll<HTMLInputElement | HTMLSelectElement>("[data-field]")) {
    const on = input instanceof HTMLInputElement && input.type === "checkbox";
    all[input.dataset.field!] = on ? String(input.checked) : input.value;
  }
  return all;
}

function build(panel: PanelView, lab: Lab, body: HTMLElement): HTMLElement[] {
  const press = (key: string, row?: string) =>
    void lab.act("panel", { key, values: values(body), ...(row === undefined ? {} : { row }) });
  return [
    ...panel.questions.map((question) => questionForm(question, lab)),
    h("div", { class: "lrp-fields" }, ...panel.fields.map(fieldRow)),
    ...panel.tables.map((table) => tableOf(table, press)),
    h("div", { class: "lrp-row" }, ...panel.buttons.map((one) => pressable(one, () => press(one.key)))),
  ];
}

function pressable({ key, label }: PanelButton, onclick: () => void): HTMLButtonElement {
  return button({ label, title: label, action: `panel-${key}`, onclick });
}

function questionForm({ key, text, default: value }: PanelQuestion, lab: Lab): HTMLElement {
  const input = h("input", { class: "lrp-input", value, "data-field": key });
  return h(
    "form",
    {
      class: "lrp-question",
      onsubmit: (event: SubmitEvent) => {
        event.preventDefault();
        void lab.act("panel", { key, values: { [key]: input.value } });
      },
    },
    h("label", {}, text, input),
    h("button", { class: "lrp-button lrp-primary", "data-lrp-action": `answer-${key}` }, "Connect"),
  );
}

function fieldRow(field: PanelField): HTMLElement {
  return h(
    "label",
    { class: "lrp-field" },
    h("span", {}, field.label),
    control(field),
    field.unit && h("span", { class: "lrp-faint" }, field.unit),
  );
}

function control({ key, kind, value, choices }: PanelField): HTMLElement {
  if (kind === "value") return h("output", { "data-show": key }, value);
  if (kind === "switch")
    return h("input", { type: "checkbox", checked: value === "true", "data-field": key });
  if (kind === "choice") {
    const list = choices.map((choice) => h("option", { value: choice, selected: choice === value }, choice));
    return h("select", { class: "lrp-select", "data-field": key }, ...list);
  }
  return h("input", {
    class: "lrp-input",
    type: kind === "number" ? "number" : "text",
    value,
    "data-field": key,
  });
}

function tableOf(table: PanelTable, press: (key: string, row: string) => void): HTMLElement {
  const head = h(
    "tr",
    {},
    ...table.columns.map((name) => h("th", { scope: "col" }, name)),
    table.buttons.length ? h("td") : null,
  );
  const rows = table.rows.map((cells, index) => {
    const row = table.keys[index] ?? "";
    const buttons = table.buttons.map((one) => pressable(one, () => press(one.key, row)));
    return h(
      "tr",
      { "data-row": row },
      ...cells.map((cell) => h("td", {}, cell)),
      buttons.length ? h("td", {}, ...buttons) : null,
    );
  });
  return h(
    "table",
    { class: "lrp-table", "data-table": table.key },
    h("caption", {}, table.title),
    h("thead", {}, head),
    h("tbody", {}, ...rows),
  );
}

/** New values into what stands there. */
function refresh(body: HTMLElement, panel: PanelView): void {
  for (const { key, value } of panel.fields) {
    const output = body.querySelector(`[data-show="${CSS.escape(key)}"]`);
    if (output && output.textContent !== value) output.textContent = value;
  }
  for (const table of panel.tables) {
    const rows = body.querySelectorAll(`[data-table="${CSS.escape(table.key)}"] tbody tr`);
    table.rows.forEach((cells, index) => {
      cells.forEach((cell, column) => {
        const place = rows[index]?.children[column];
        if (place && place.textContent !== cell) place.textContent = cell;
      });
    });
  }
}
