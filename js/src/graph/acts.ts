/** The acts on a state graph, as fields that ask for a name or a trigger, and as menus: everything by keyboard. */

import type { Act, Pen } from "../editor/pen";
import { machineOf, nameOf, parentOf } from "../language/paths";
import type { TransitionShape } from "../protocol";
import type { Lab } from "../session/store";
import { item, type MenuItem } from "../ui/menu";
import type { Point } from "../ui/point";
import type { Drawn } from "./elements";
import { type Entry, openField } from "./field";
import { showMachine } from "./shown";

const TRIGGER = "event, n > 3, or 2 s";
const AT_ONCE = "An event, a condition or a time. Nothing, or `eps`: at once, without waiting.";

const HOLDING = /^(on|exit)$/;
const SETTINGS = "What is left empty has the machine's own value.";

/** What a drawn transition is known to be before one is asked: its possible sources, and what it waits for. */
interface Known {
  sources?: readonly string[];
  trigger?: string;
}

/** A delay as one reads it: `2000` as `2 s`. */
function duration(delay: string): string {
  const ms = /^\d+$/.test(delay) ? Number(delay) : Number.NaN;
  return Number.isNaN(ms) ? delay : ms % 1000 ? `${ms} ms` : `${ms / 1000} s`;
}

/** What a block contains, in its brackets. */
const block = (text: string) => (/^\s*(\[[\s\S]*\]|\(spawn\b[\s\S]*\))\s*$/.test(text) ? text : `[${text}]`);

export class Acts {
  constructor(
    readonly lab: Lab,
    private readonly pen: Pen,
    /** The rectangles of states in the window, by their paths. */
    private readonly boxes: (...paths: string[]) => DOMRect[],
  ) {}

  /** The machine drawn on, also one that was drawn a moment ago, of which the kernel has not told yet. */
  get machine(): string {
    const { program, machine } = this.lab.store.state;
    return program.machines.length || this.pen.source("machine", machine) ? machine : "";
  }

  /** Apply an act, and show the sentence that refuses it. */
  async draw(act: Act): Promise<string | null> {
    const refusal = await this.pen.draw(act);
    if (refusal) this.lab.notify(refusal);
    return refusal;
  }

  private statesOf(machine: string): string[] {
    return (this.lab.store.state.layouts[machine]?.states ?? [])
      .filter(({ kind }) => kind === "state")
      .map(({ name }) => name);
  }

  private freeName(machine: string): string {
    const taken = new Set(this.statesOf(machine));
    for (let number = 1; ; number++) if (!taken.has(`s${number}`)) return `s${number}`;
  }

  /** Put a state where it was asked for. This is said before the state is drawn, which would else be seen to jump. */
  private pin(path: string, name: string, place: readonly [number, number] | null): void {
    if (!place || !path) return;
    this.lab.send({ do: "pin", path, name, x: Math.round(place[0]), y: Math.round(place[1]) });
  }

  newState(at: Point, place: readonly [number, number] | null = null, machine = this.machine): void {
    openField(this.lab.root, at, {
      title: "New state",
      entries: [{ label: "State", value: this.freeName(machine) }],
      submit: ([name = ""]) =>
        this.pen.draw({ act: "state", kind: "machine", path: machine, to: name }, () =>
          this.pin(machine, name, place),
        ),
    });
  }

  /** Ask when a transition fires, and where it leads unless that is known. */
  newTransition(
    at: Point,
    source: string,
    destination: string,
    place: readonly [number, number] | null = null,
    closed?: () => void,
    { sources = [source], trigger }: Known = {},
  ): void {
    const machine = parentOf(source);
    const options = ["eps", ...this.pen.triggers(machine)];
    const when: Entry = {
      ...{ label: "When", placeholder: TRIGGER, optional: true, options },
      ...(trigger ? { value: trigger } : {}),
    };
    const to: Entry = { label: "To", value: this.freeName(machine), options: this.statesOf(machine) };
    const from: Entry = { label: "From", value: nameOf(source), options: sources.map(nameOf) };
    openField(this.lab.root, at, {
      title: `Transition from ${nameOf(source)}`,
      entries: [...(sources.length > 1 ? [from] : []), ...(destination ? [] : [to]), when],
      note: AT_ONCE,
      about: this.boxes(source, `${machine}/${destination}`),
      ...(closed ? { closed } : {}),
      ...(nameOf(source) === "*" ? {} : { check: "from any state" }),
      submit: (values, every) => {
        const form = values.at(-1)!;
        const to = destination || values.at(-2)!;
        const fresh = !this.statesOf(machine).includes(to);
        const begin = sources.length > 1 ? values[0]! : nameOf(source);
        const path = `${machine}/${every ? "*" : begin}`;
        return this.pen.draw({ act: "transition", kind: "state", path, to, form }, () => {
          if (fresh) this.pin(machine, to, place);
        });
      },
    });
  }

  rename(at: Point, kind: "state" | "machine", path: string): void {
    openField(this.lab.root, at, {
      title: `New name of ${kind} ${nameOf(path)}`,
      entries: [{ label: "Name", value: nameOf(path) }],
      about: this.boxes(path),
      submit: ([to = ""]) => this.pen.draw({ act: "rename", kind, path, to }),
    });
  }

  change(at: Point, path: string): void {
    openField(this.lab.root, at, {
      title: `Transition ${path}`,
      entries: [{ label: "Transition", value: this.pen.source("transition", path) }],
      submit: ([form = ""]) => this.pen.draw({ act: "change", kind: "transition", path, form }),
    });
  }

  /** When a transition fires, for how long that has to hold, and what it does then: each with what is there. */
  private trigger(at: Point, path: string): void {
    const written = this.pen.transition(path);
    const { keyword = "", trigger = "" } = written ?? {};
    const machine = machineOf(path);
    const sources = this.arrowsOf(path).map(({ source }) => source);
    const options = this.pen.triggers(machine, sources.includes("*") ? undefined : sources);
    const shown = /^\d+$/.test(trigger) ? duration(trigger) : `ontime ${trigger}`;
    const value = { eps: "eps", ontime: shown }[keyword] ?? trigger;
    const isExit = keyword === "exit";
    openField(this.lab.root, at, {
      title: `When ${path} fires`,
      entries: [{ label: "When", value, placeholder: TRIGGER, optional: !isExit, options }],
      ...(isExit ? {} : { note: AT_ONCE }),
      submit: ([form = ""]) => this.pen.draw({ act: "trigger", kind: "transition", path, form }),
    });
  }

  private hold(at: Point, path: string): void {
    const value = duration(this.pen.transition(path)?.hold ?? "");
    openField(this.lab.root, at, {
      title: `How long it has to hold before ${path} fires`,
      entries: [{ label: "Has to hold for", value, placeholder: "2 s", optional: true }],
      note: "A time, a variable or a `[block]` with milliseconds. Nothing: it fires at once.",
      submit: ([form = ""]) => this.pen.draw({ act: "hold", kind: "transition", path, form }),
    });
  }

  private effect(at: Point, path: string): void {
    const value = this.pen.transition(path)?.effect ?? "";
    openField(this.lab.root, at, {
      title: `Effect of ${path}`,
      entries: [{ label: "Effect", value, placeholder: "Python", optional: true }],
      note: "Runs when the transition fires, before anything is left.",
      submit: ([form = ""]) => this.pen.draw({ act: "effect", kind: "transition", path, form }),
    });
  }

  /** The values with which a state spawns a machine; only those that were changed are written. */
  private settings(at: Point, path: string, machine: string): void {
    const written = () => this.pen.spawns(path).find((each) => each.machine === machine);
    const { variables, settings } = written() ?? { variables: new Map(), settings: new Map() };
    const names = [...new Set([...variables.keys(), ...settings.keys()])];
    const to = nameOf(machine);
    openField(this.lab.root, at, {
      title: `Start values of ${to} in ${nameOf(path)}`,
      entries: names.map((label) => ({
        ...{ label, value: settings.get(label) ?? "", optional: true },
        placeholder: variables.get(label) ?? "",
      })),
      note: SETTINGS,
      about: this.boxes(path),
      submit: async (values) => {
        for (const [index, old] of names.entries()) {
          const form = values[index]!;
          if (form === (written()?.settings.get(old) ?? "")) continue;
          const refusal = await this.pen.draw({ act: "setting", kind: "state", path, to, old, form });
          if (refusal) return refusal;
        }
        return null;
      },
    });
  }

  private arrowsOf(path: string): TransitionShape[] {
    const { transitions = [] } = this.lab.store.state.layouts[machineOf(path)] ?? {};
    return transitions.filter(({ id, lands }) => id === path && !lands);
  }

  /** Let a transition wait for a state of a machine; what it waits for has to hold as long as before. */
  async awaitState(path: string, trigger: string): Promise<void> {
    const { hold = "" } = this.pen.transition(path) ?? {};
    const form = hold ? `${trigger} for ${hold}` : trigger;
    await this.draw({ act: "trigger", kind: "transition", path, form });
  }

  private form(
    at: Point,
    kind: "state" | "machine",
    path: string,
    title: string,
    entry: Entry,
    before: string,
  ) {
    openField(this.lab.root, at, {
      title,
      entries: [entry],
      about: this.boxes(path),
      submit: ([text = ""]) =>
        this.pen.draw({ act: "form", kind, path, form: before ? `${before} ${block(text)}` : text }),
    });
  }

  /** A variable or an event: its name and its block. */
  private named(at: Point, keyword: "var" | "event", label: string): void {
    const { machine } = this;
    const sign = keyword === "var" ? " :=" : "";
    openField(this.lab.root, at, {
      title: `New ${keyword === "var" ? "variable" : "event"}`,
      entries: [{ label: "Name" }, { label }],
      ...(machine ? { check: "for the whole program" } : {}),
      submit: ([name = "", text = ""], everywhere) =>
        this.pen.draw({
          act: "form",
          kind: "machine",
          path: everywhere ? "" : machine,
          form: `${keyword} ${name}${sign} [${text}]`,
        }),
    });
  }

  /** Ask for the other state of an act. */
  private other(at: Point, label: string, act: Act, names: readonly string[]): void {
    openField(this.lab.root, at, {
      title: label,
      entries: [{ label, options: names }],
      submit: ([to = ""]) => this.pen.draw({ ...act, to }),
    });
  }

  of({ kind, path }: Drawn, at: Point): MenuItem[] {
    return kind === "state" ? this.ofState(path, at) : this.ofTransition(path, at);
  }

  ofState(path: string, at: Point): MenuItem[] {
    const machine = parentOf(path);
    const others = this.statesOf(machine).filter((name) => name !== nameOf(path));
    const inside = machine.includes("/");
    const action = (keyword: string, title: string) =>
      item(`${title}…`, `draw-${keyword}`, () =>
        this.form(at, "state", path, title, { label: title, placeholder: "Python" }, keyword),
      );
    return [
      item("New transition…", "draw-transition", () => this.newTransition(at, path, ""), { hint: "T" }),
      action("onentry", "On entry"),
      action("running", "While active"),
      action("onexit", "On exit"),
      item("New machine inside…", "draw-inside", () => this.newMachine(at, path)),
      ...this.pen
        .spawns(path)
        .flatMap(({ machine, variables, settings }, index) =>
          variables.size + settings.size
            ? item(`Start values of ${nameOf(machine)}…`, `draw-settings${index ? `-${index}` : ""}`, () =>
                this.settings(at, path, machine),
              )
            : [],
        ),
      item("Start here", "draw-start", () => void this.draw({ act: "start", kind: "state", path })),
      item(
        "Move into…",
        "draw-nest",
        () => this.other(at, "Move into", { act: "nest", kind: "state", path }, others),
        { disabled: !others.length },
      ),
      ...(inside
        ? [
            item(
              `Move out of ${nameOf(parentOf(machine))}`,
              "draw-unnest",
              () => void this.draw({ act: "unnest", kind: "state", path }),
            ),
          ]
        : []),
      item("Delete", "draw-delete", () => void this.delete({ kind: "state", path }), { hint: "Del" }),
    ];
  }

  ofTransition(path: string, at: Point): MenuItem[] {
    const machine = machineOf(path);
    const canHold = HOLDING.test(this.pen.transition(path)?.keyword ?? "");
    const homes = Object.values(this.lab.store.state.layouts).filter(({ transitions }) =>
      transitions.some(({ id, lands }) => lands && id === path),
    );
    const ends = homes.length ? homes.map((home) => home.machine) : [machine];
    const names = {
      source: this.statesOf(machine),
      destination: ends.flatMap((each) => this.statesOf(each)),
    };
    const lead = (act: "source" | "destination", label: string) =>
      item(`${label}…`, `draw-${act}`, () =>
        this.other(at, label, { act, kind: "transition", path }, names[act]),
      );
    return [
      item("Edit…", "draw-change", () => this.change(at, path), { hint: "F2" }),
      item("When…", "draw-trigger", () => this.trigger(at, path)),
      ...(canHold ? [item("Has to hold for…", "draw-hold", () => this.hold(at, path))] : []),
      item("Effect…", "draw-effect", () => this.effect(at, path)),
      lead("source", "From another state"),
      lead("destination", "To another state"),
      item("Reverse", "draw-reverse", () => void this.draw({ act: "reverse", kind: "transition", path })),
      item("Delete", "draw-delete", () => void this.delete({ kind: "transition", path }), { hint: "Del" }),
    ];
  }

  ofSpace(at: Point, place: readonly [number, number] | null, machine = this.machine): (MenuItem | null)[] {
    const ofMachine = machine
      ? [
          item("Rename machine…", "draw-rename", () => this.rename(at, "machine", machine)),
          item(
            "Delete machine",
            "draw-delete",
            () => void this.draw({ act: "delete", kind: "machine", path: machine }),
          ),
        ]
      : [];
    return [
      item("New state…", "draw-state", () => this.newState(at, place, machine), { hint: "N" }),
      item("New variable…", "draw-var", () => this.named(at, "var", "Value")),
      item("New event…", "draw-event", () => this.named(at, "event", "Condition")),
      item("New machine…", "draw-machine", () => this.newMachine(at, "")),
      item("Other form…", "draw-form", () =>
        this.form(
          at,
          "machine",
          "",
          "Other form",
          { label: "Form", placeholder: "onpause [robot.stop()]" },
          "",
        ),
      ),
      ...(ofMachine.length ? [null, ...ofMachine] : []),
    ];
  }

  /** A machine in a state, or at the top; it is shown at once. */
  private newMachine(at: Point, path: string): void {
    openField(this.lab.root, at, {
      title: "New machine",
      entries: [{ label: "Machine" }],
      submit: async ([name = ""]) => {
        const kind = path ? "state" : "machine";
        const refusal = await this.pen.draw({ act: "form", kind, path, form: `machine ${name}` });
        if (!refusal) showMachine(this.lab.store, path ? `${path}/${name}` : name);
        return refusal;
      },
    });
  }

  edit({ kind, path }: Drawn, at: Point): void {
    if (kind === "state") this.rename(at, kind, path);
    else this.change(at, path);
  }

  delete({ kind, path }: Drawn): Promise<string | null> {
    return this.draw({ act: "delete", kind, path });
  }
}
