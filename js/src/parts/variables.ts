/** The variables in scope of the machine shown, live, grouped by machine, changed in place. Paper: §6.5. */

import { isIn, nameOf } from "../language/paths";
import type { OutdatedView } from "../protocol";
import type { Lab } from "../session/store";
import { ofVariable } from "../timeline/spark";
import { iconButton, linkButton, panel } from "../ui/button";
import { h, prose, reconcile, s, setAttribute, setHidden, setText } from "../ui/dom";
import { editing } from "../ui/editing";
import { hasFocus } from "../ui/root";
import { glow } from "../ui/timers";
import { history } from "./history";

interface Group {
  machine: string;
  variables: string[];
}

export function variablesView(lab: Lab): HTMLElement {
  const { store } = lab;
  const list = h("div");
  const group = { class: "lrp-variables", tabindex: "0", role: "group", "aria-label": "Variables" };
  const { element } = panel("variables", "Variables", [], h("div", group, list));
  const rows = new Map<string, Row>();
  const makeGroup = (group: Group) =>
    h(
      "section",
      { class: "lrp-variables-group", "aria-label": group.machine || "global" },
      h("div", { class: "lrp-group-title" }, group.machine ? nameOf(group.machine) : "global"),
      h("ul", {}),
    );
  const updateGroup = (section: Element, group: Group) =>
    reconcile(
      section.lastElementChild!,
      group.variables,
      (path) => path,
      (path) => {
        const row = new Row(lab, path);
        rows.set(path, row);
        return row.element;
      },
      (_, path) => rows.get(path)?.update(),
    );
  store.watch(["variables", "outdated", "program", "machine", "snapshot"], () => {
    const groups = groupsInScope(store.state.program, store.state.machine);
    reconcile(list, groups, ({ machine }) => machine, makeGroup, updateGroup);
    setAttribute(list, "data-empty", groups.length === 0 ? "No variables in scope." : null);
  });
  return element;
}

/** Groups from the machine shown outward, the globals last. */
export function groupsInScope(
  program: { variables: string[]; machines: { path: string; variables: string[] }[] },
  machine: string,
): Group[] {
  const inside = program.machines
    .filter(({ path }) => isIn(machine, path))
    .map(({ path, variables }) => ({ machine: path, variables }))
    .reverse();
  return [...inside, { machine: "", variables: program.variables }].filter(
    ({ variables }) => variables.length,
  );
}

class Row {
  readonly element: HTMLElement;
  private readonly value: HTMLButtonElement;
  private readonly spark: Spark;
  private readonly computed = h("div", { class: "lrp-variable-computed", hidden: true });
  private outdated: OutdatedView | undefined;
  private text: string | undefined;

  constructor(
    private readonly lab: Lab,
    private readonly path: string,
  ) {
    const name = nameOf(path);
    this.value = h("button", {
      type: "button",
      class: "lrp-value",
      title: "Change",
      onclick: () => this.edit(),
      ...history(ofVariable(path)),
    });
    this.spark = new Spark(path);
    const inspect = iconButton("search", `Inspect ${name}`, "inspect", () => lab.inspect("variable", path));
    const source = h(
      "button",
      {
        type: "button",
        class: "lrp-variable-name",
        title: "Go to source",
        onclick: () => lab.goTo("variable", path),
      },
      name,
    );
    const named = { class: "lrp-variable", "data-lrp-variable": path };
    this.element = h("li", named, source, this.spark.element, this.value, inspect, this.computed);
  }

  update(): void {
    const value = this.lab.store.state.variables[this.path];
    this.updateOutdated();
    const [text, number] = value ?? [];
    if (text !== undefined && this.text !== undefined && text !== this.text) glow(this.element);
    if (value || this.text !== undefined) this.spark.add(number ?? null);
    this.text = text;
    setText(this.value, text ?? "—");
    setAttribute(
      this.value,
      "aria-label",
      `${nameOf(this.path)} ${text === undefined ? "has no value" : `is ${text}`}, change`,
    );
    this.value.disabled = text === undefined;
  }

  /** Say what the value was computed from if that has been assigned since, and offer to recompute it. */
  private updateOutdated(): void {
    const outdated = this.lab.store.state.outdated[this.path];
    if (outdated === this.outdated) return;
    this.outdated = outdated;
    setHidden(this.computed, !outdated);
    if (!outdated) return;
    const { computed, initial } = outdated;
    const again = linkButton("Recompute", {
      "data-lrp-action": "compute",
      title: `Assign the present value of ${initial}`,
      onclick: () => void this.assign(initial),
    });
    this.computed.replaceChildren(...prose(computed), " ", ...(initial ? [again] : []));
  }

  private assign(expression: string): Promise<string | null> {
    return this.lab.act({ do: "set_variable", path: this.path, expression }, true);
  }

  private edit(): void {
    let open = true;
    const close = () => {
      if (!open) return;
      open = false; // removing the field blurs it, which closes it
      const focused = hasFocus(input);
      error.remove();
      input.replaceWith(this.value);
      if (focused) this.value.focus();
    };
    const name = `New value of ${nameOf(this.path)}, a Python expression`;
    const shown = this.text ?? ""; // of a function `f()`, which would be called
    const submit = async (text: string) => (text === shown ? null : this.assign(text));
    const { input, error } = editing(shown, name, submit, close);
    input.addEventListener("blur", () => {
      if (!error.textContent) close();
    });
    this.value.replaceWith(input);
    this.element.append(error);
    input.focus();
    input.select();
  }
}

const KEPT = 48;
const WIDTH = 48;
const HEIGHT = 14;

class Spark {
  readonly element: HTMLButtonElement;
  private readonly line = s("polyline", {});
  private values: number[] = [];

  constructor(path: string) {
    const view = { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, "aria-hidden": "true" };
    const name = { "data-lrp-action": "pin", "aria-label": `Plot ${nameOf(path)} in the timeline` };
    const attributes = { type: "button", class: "lrp-spark", hidden: true };
    this.element = h(
      "button",
      { ...attributes, ...name, ...history(ofVariable(path)) },
      s("svg", view, this.line),
    );
  }

  add(value: number | null): void {
    if (value === null || !Number.isFinite(value)) this.values = [];
    else if (value === this.values.at(-1)) return;
    else this.values = [...this.values.slice(1 - KEPT), value];
    setHidden(this.element, this.values.length < 3);
    setAttribute(this.line, "points", points(this.values));
  }
}

/** The points of the line, newest at the right. */
export function points(values: readonly number[]): string {
  const least = Math.min(...values);
  const span = Math.max(...values) - least || 1;
  const step = WIDTH / (KEPT - 1);
  const first = WIDTH - (values.length - 1) * step;
  return values
    .map(
      (value, i) =>
        `${(first + i * step).toFixed(1)},${(HEIGHT - 2 - ((value - least) / span) * (HEIGHT - 4)).toFixed(1)}`,
    )
    .join(" ");
}
