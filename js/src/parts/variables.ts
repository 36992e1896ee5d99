/** The variables in scope of the machine shown, live, grouped by machine, changed in place. Paper: §6.5. */

import { isIn, nameOf } from "../language/paths";
import type { OutdatedView } from "../protocol";
import { inInstance, meant, placeOf, type Running } from "../session/instances";
import type { Topic } from "../session/state";
import type { Lab } from "../session/store";
import { ofVariable } from "../timeline/spark";
import { iconButton, linkButton, panel } from "../ui/button";
import { h, prose, reconcile, s, setAttribute, setHidden, setText } from "../ui/dom";
import { editing } from "../ui/editing";
import { readable } from "../ui/numbers";
import { hasFocus } from "../ui/root";
import { glow } from "../ui/timers";
import { history } from "./history";

/** The variables of a machine, in one of its instances. */
interface Group {
  machine: string;
  instance: string;
  place: string;
  /** By their paths in the text. */
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
      { class: "lrp-variables-group", "aria-label": titleOf(group) },
      h("div", { class: "lrp-group-title" }, titleOf(group)),
      h("ul", {}),
    );
  const updateGroup = (section: Element, { instance, place, variables }: Group) =>
    reconcile(
      section.lastElementChild!,
      variables.map((path) => {
        const at = inInstance(path, instance);
        return { path, at, named: place ? at : path };
      }),
      ({ named }) => named,
      ({ path, named }) => {
        const row = new Row(lab, path, named, () => update());
        rows.set(named, row);
        return row.element;
      },
      (_, { named, at }) => rows.get(named)?.update(at),
    );
  let groups: Group[] = [];
  const update = (changed?: ReadonlySet<Topic>) => {
    const isEdited = list.querySelector(".lrp-input");
    if (!isEdited || changed?.has("program")) groups = groupsInScope(store.state);
    reconcile(
      list,
      groups,
      ({ machine, instance, place }) => (place ? `${machine} ${instance}` : machine),
      makeGroup,
      updateGroup,
    );
    setAttribute(list, "data-empty", groups.length === 0 ? "No variables in scope." : null);
  };
  store.watch(["variables", "outdated", "program", "machine", "instances", "instance", "snapshot"], update);
  return element;
}

const titleOf = ({ machine, place }: Group) =>
  [machine ? nameOf(machine) : "global", place].filter(Boolean).join(" ");

/** Groups from the machine shown outward, the globals last; of a machine those of its instances that are meant. */
export function groupsInScope(
  state: Running & {
    program: { variables: string[]; machines: { path: string; variables: string[] }[] };
    machine: string;
  },
): Group[] {
  const { program, machine: shown } = state;
  const inside = program.machines
    .filter(({ path }) => isIn(shown, path))
    .reverse()
    .flatMap(({ path: machine, variables }) => {
      const found = meant(state, machine).map(({ path }) => path);
      return (found.length ? found : [machine]).map((instance) => {
        return { machine, instance, place: placeOf(state, instance), variables };
      });
    });
  const global = { machine: "", instance: "", place: "", variables: program.variables };
  return [...inside, global].filter(({ variables }) => variables.length);
}

class Row {
  readonly element: HTMLElement;
  private readonly value: HTMLButtonElement;
  private readonly spark: Spark;
  private readonly computed = h("div", { class: "lrp-variable-computed", hidden: true });
  private outdated: OutdatedView | undefined;
  private text: string | undefined;

  /** `named` is the path by which the kernel is told which variable is meant, `path` the one in the text. */
  constructor(
    private readonly lab: Lab,
    path: string,
    private readonly named: string,
    private readonly edited: () => void,
  ) {
    const name = nameOf(path);
    this.value = h("button", {
      type: "button",
      class: "lrp-value",
      onclick: () => this.edit(),
      ...history(ofVariable(named)),
    });
    this.spark = new Spark(named);
    const inspect = iconButton("search", `Inspect ${name}`, "inspect", () => lab.inspect("variable", named));
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
    const attributes = { class: "lrp-variable", "data-lrp-variable": named };
    this.element = h("li", attributes, source, this.spark.element, this.value, inspect, this.computed);
  }

  /** Show the value of the variable with this path as spawned. */
  update(at: string): void {
    const value = this.lab.store.state.variables[at];
    this.updateOutdated(at);
    const [text, number] = value ?? [];
    if (text !== undefined && this.text !== undefined && text !== this.text) glow(this.element);
    const truth = ["False", "True"].indexOf(text ?? "");
    if (truth >= 0) this.spark.addTruth(truth, this.lab.store.state.time);
    else if (value || this.text !== undefined) this.spark.add(number ?? null);
    this.text = text;
    const shown = text === undefined ? "—" : readable(text);
    setText(this.value, shown);
    setAttribute(this.value, "title", text && `${text}\nClick: change`);
    setAttribute(
      this.value,
      "aria-label",
      `${nameOf(this.named)} ${text === undefined ? "has no value" : `is ${shown}`}, change`,
    );
    this.value.disabled = text === undefined;
  }

  /** Say what the value was computed from if that has been assigned since, and offer to recompute it. */
  private updateOutdated(at: string): void {
    const outdated = this.lab.store.state.outdated[at];
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
    return this.lab.act({ do: "set_variable", path: this.named, expression }, true);
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
      this.edited();
    };
    const name = `New value of ${nameOf(this.named)}, a Python expression`;
    const shown = this.text ?? ""; // of a function `f()`, which would be called
    const submit = async (text: string) => (text === shown ? null : this.assign(text));
    const { input, error } = editing(shown, name, submit, close);
    input.addEventListener("blur", () => {
      if (!error.textContent && input.value === shown) close();
    });
    this.value.replaceWith(input);
    this.element.append(error);
    input.focus();
    input.select();
  }
}

const KEPT = 48;
const SECONDS = 30; // of truth values
const WIDTH = 48;
const HEIGHT = 14;

class Spark {
  readonly element: HTMLButtonElement;
  private readonly line = s("polyline", {});
  private values: number[] = [];
  private truths: Step[] = [];

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

  /** Add a truth value at a time, in seconds. */
  addTruth(value: number, time: number): void {
    const { truths } = this;
    this.values = [];
    if ((truths.at(-1)?.time ?? time) > time) truths.length = 0; // an earlier moment is looked at
    if (truths.at(-1)?.value !== value) truths.push({ time, value });
    while (truths[1] && truths[1].time < time - SECONDS) truths.shift();
    setHidden(this.element, truths.length < 2);
    setAttribute(this.line, "points", steps(truths, time));
  }

  add(value: number | null): void {
    this.truths = [];
    if (value === null || !Number.isFinite(value)) this.values = [];
    else if (value === this.values.at(-1)) return;
    else this.values = [...this.values.slice(1 - KEPT), value];
    setHidden(this.element, this.values.length < 3);
    setAttribute(this.line, "points", points(this.values));
  }
}

/** A truth value from a time on. */
export interface Step {
  time: number; // s
  value: number;
}

/** The points of a line that is high while a value is true; the present is at the right. */
export function steps(truths: readonly Step[], now: number): string {
  const x = ({ time }: Step) => Math.max(0, WIDTH * (1 - (now - time) / SECONDS)).toFixed(1);
  const y = ({ value }: Step) => (value ? 2 : HEIGHT - 2);
  const corners = truths.flatMap((each, i) => [
    ...(i ? [`${x(each)},${y(truths[i - 1]!)}`] : []),
    `${x(each)},${y(each)}`,
  ]);
  return [...corners, ...truths.slice(-1).map((last) => `${WIDTH},${y(last)}`)].join(" ");
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
