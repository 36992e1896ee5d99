/** A bridge's panel, drawn from plain data: fields, tables, buttons, questions. Paper: §7.1, §7.2, §7.3. */

import { askToArm, failsafeText } from "../parts/arming";
import { showReach } from "../parts/reach";
import type { Button, Panel, Question } from "../protocol";
import type { Lab } from "../session/store";
import { button } from "../ui/button";
import { focusLab, h, prose, setAttribute, setProse, setText } from "../ui/dom";
import { below } from "../ui/point";
import { hasFocus } from "../ui/root";
import { type Inputs, inputs, values } from "./fields";
import { type DrawnTable, tableOf } from "./table";

/** The status sentence is always at the top. */
const AT_THE_HEAD = "status";

export function bridgePanel(lab: Lab): HTMLElement {
  const { store } = lab;
  const body = h("div", { class: "lrp-bridge-panel" });
  let shape = "";
  let parts: Parts | null = null;
  store.watch(["panel", "bridge", "snapshot", "link", "late"], () => {
    const { panel } = store.state;
    body.hidden = !panel;
    if (!panel) return;
    const now = shapeOf(panel);
    if (!parts || now !== shape) {
      parts = build(panel, lab, body);
      if (hasFocus(body)) focusLab(body);
      body.replaceChildren(...parts.elements);
    }
    shape = now;
    parts.refresh(panel);
  });
  return body;
}

/** The structure of a panel without its values: while it is unchanged, elements and typed texts are kept. */
function shapeOf({ title, fields, tables, buttons, questions }: Panel): string {
  return JSON.stringify([
    title,
    fields.map(({ key, kind, label, unit, press }) => [key, kind, label, unit, press]),
    tables.map(({ key, title: name, columns, buttons: each }) => [key, name, columns, each]),
    buttons,
    questions.map(({ key, text }) => [key, text]),
  ]);
}

interface Parts {
  elements: HTMLElement[];
  refresh(panel: Panel): void;
}

/** From top to bottom: status, questions, the first table with its fields, the other tables. */
function build(panel: Panel, lab: Lab, body: HTMLElement): Parts {
  const press = async (key: string, row?: string) => {
    const known = row === undefined ? {} : { row };
    return lab.act({ do: "panel", key, values: values(body), ...known });
  };
  const state = head(panel, lab, press);
  const facts = factList();
  const asked = panel.questions.length ? questions(panel.questions, lab) : null;
  const filled: Inputs = inputs(panel, (key, row) => void press(key, row));
  const pressed = async (key: string) => {
    if (!(await press(key))) filled.clear();
  };
  const chosen = async (key: string, row: string) => {
    await press(key, row);
    filled.show(key);
  };
  const others = panel.buttons.filter(({ key }) => key !== "stop");
  const form = h(
    "div",
    { class: "lrp-form" },
    filled.element,
    h("div", { class: "lrp-row" }, ...others.map((one) => pressable(one, () => void pressed(one.key)))),
  );
  const tables: DrawnTable[] = panel.tables.map((table) =>
    tableOf(table, (one, row) => pressable(one, () => void chosen(one.key, row))),
  );
  const [first, ...more] = tables;
  return {
    elements: [
      state.element,
      facts.element,
      asked?.element,
      first?.element,
      form,
      ...more.map((t) => t.element),
    ].filter((element): element is HTMLElement => Boolean(element)),
    refresh(now) {
      state.refresh();
      facts.refresh(now);
      asked?.refresh(now.questions);
      filled.refresh(now);
      now.tables.forEach((table, index) => tables[index]?.refresh(table));
    },
  };
}

function pressable({ key, label }: Button, onclick: () => void): HTMLButtonElement {
  return button({ label, title: label, action: `panel-${key}`, onclick });
}

/** The connection's status and the arming switch; lists the commands that were not sent. */
function head(panel: Panel, lab: Lab, press: (key: string) => unknown) {
  const dot = h("span", { class: "lrp-dot", "aria-hidden": "true" });
  const sentence = h("p", { class: "lrp-sentence", "data-show": AT_THE_HEAD });
  const stop = panel.buttons.find(({ key }) => key === "stop");
  const arm = button({
    label: "Arm",
    title: "Let commands move the robot",
    action: "panel-arm",
    onclick: () => askToArm(lab, below(arm)),
  });
  const disarmed = h("p", { class: "lrp-disarmed" }, h("span", {}, "Disarmed: commands are not sent."), arm);
  const failsafe = failsafeText();
  const stopButton =
    stop &&
    button({
      label: stop.label,
      icon: "stop",
      title: stop.label,
      action: "panel-stop",
      onclick: () => void press("stop"),
    });
  stopButton?.classList.add("lrp-stop");
  const element = h("div", { class: "lrp-state" }, dot, sentence, stopButton, disarmed, failsafe.element);
  return {
    element,
    refresh() {
      const { bridge } = lab.store.state;
      setAttribute(dot, "data-status", bridge.status);
      setProse(sentence, bridge.sentence);
      disarmed.hidden = !bridge.hardware || bridge.armed;
      failsafe.show(bridge.failsafe);
      if (stop && stopButton) showReach(stopButton, lab.store.state, stop.label, stop.label);
    },
  };
}

/** Read-only values, in one line where there is room. */
function factList() {
  const element = h("div", { class: "lrp-facts" });
  return {
    element,
    refresh({ fields }: Panel) {
      const shown = fields.filter(({ key, kind, value }) => kind === "value" && key !== AT_THE_HEAD && value);
      while (element.children.length < shown.length)
        element.append(h("span", { class: "lrp-fact" }, h("span", { class: "lrp-faint" }), h("output")));
      while (element.children.length > shown.length) element.lastElementChild!.remove();
      shown.forEach(({ key, label, value, unit }, index) => {
        const [name, text] = element.children[index]!.children as Iterable<HTMLElement>;
        setText(name!, label);
        setProse(text!, unit ? `${value} ${unit}` : value);
        setAttribute(text!, "data-show", key);
      });
    },
  };
}

/** The dialog with a bridge's questions: open until the first is answered and the robot is connected. */
function questions(all: Question[], lab: Lab) {
  const forms = all.map((question) => questionForm(question, lab));
  const element = h(
    "details",
    { class: "lrp-questions" },
    h("summary", {}, "Connection"),
    ...forms.map((form) => form.element),
  );
  let asked: boolean | null = null;
  return {
    element,
    refresh(now: Question[]) {
      const { status } = lab.store.state.bridge;
      const asks = status === "disconnected" || status === "connecting" || !now[0]?.default;
      if (asks !== asked) element.open = asks;
      asked = asks;
      now.forEach((question, index) => forms[index]?.refresh(question));
    },
  };
}

function questionForm({ key, text, button: label }: Question, lab: Lab) {
  const input = h("input", {
    class: "lrp-input",
    "data-question": key,
    spellcheck: "false",
    onkeydown: (event: KeyboardEvent) => {
      if (event.key !== "Enter") return;
      event.preventDefault(); // in a notebook Enter does not submit by itself
      element.requestSubmit();
    },
  });
  let received: string | null = null;
  const element = h(
    "form",
    {
      class: "lrp-question",
      onsubmit: (event: SubmitEvent) => {
        event.preventDefault();
        void lab.act({ do: "panel", key, values: { [key]: input.value } });
      },
    },
    h("label", {}, h("span", {}, ...prose(text)), input),
    h("button", { class: "lrp-button lrp-primary", "data-lrp-action": `answer-${key}` }, label),
  );
  return {
    element,
    refresh({ default: value }: Question) {
      if (value !== received) input.value = value;
      received = value;
    },
  };
}
