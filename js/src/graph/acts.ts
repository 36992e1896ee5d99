/** The acts on a state graph, as fields that ask for a name or a trigger, and as menus: everything by keyboard. */

import type { Act, Pen } from "../editor/pen";
import { nameOf, parentOf } from "../language/paths";
import type { Lab } from "../session/store";
import type { MenuItem } from "../ui/menu";
import { type Entry, openField } from "./field";
import { showMachine } from "./shown";

export interface Point {
  x: number;
  y: number;
}

const TRIGGER = "event, n > 3, 2 s, or eps";

/** What a block contains, in its brackets. */
const block = (text: string) => (/^\s*(\[[\s\S]*\]|\(spawn\b[\s\S]*\))\s*$/.test(text) ? text : `[${text}]`);

export class Acts {
  constructor(
    readonly lab: Lab,
    private readonly pen: Pen,
    private readonly host: HTMLElement,
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

  newState(at: Point, place: readonly [number, number] | null = null): void {
    const { machine } = this;
    openField(this.host, at, {
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
  ): void {
    const machine = parentOf(source);
    const entries: Entry[] = [
      {
        label: "When",
        placeholder: TRIGGER,
        optional: true,
        options: ["eps", ...this.pen.triggers(machine)],
      },
    ];
    if (!destination)
      entries.unshift({ label: "To", value: this.freeName(machine), options: this.statesOf(machine) });
    openField(this.host, at, {
      title: `Transition from ${nameOf(source)}`,
      entries,
      ...(closed ? { closed } : {}),
      ...(nameOf(source) === "*" ? {} : { check: "from any state" }),
      submit: (values, every) => {
        const form = values.at(-1)!;
        const to = destination || values[0]!;
        const fresh = !this.statesOf(machine).includes(to);
        const path = every ? `${machine}/*` : source;
        return this.pen.draw({ act: "transition", kind: "state", path, to, form }, () => {
          if (fresh) this.pin(machine, to, place);
        });
      },
    });
  }

  rename(at: Point, kind: "state" | "machine", path: string): void {
    openField(this.host, at, {
      title: `New name of ${kind} ${nameOf(path)}`,
      entries: [{ label: "Name", value: nameOf(path) }],
      submit: ([to = ""]) => this.pen.draw({ act: "rename", kind, path, to }),
    });
  }

  /** Write a transition in another way. */
  change(at: Point, path: string): void {
    openField(this.host, at, {
      title: `Transition ${path}`,
      entries: [{ label: "Transition", value: this.pen.source("transition", path) }],
      submit: ([form = ""]) => this.pen.draw({ act: "change", kind: "transition", path, form }),
    });
  }

  private form(
    at: Point,
    kind: "state" | "machine",
    path: string,
    title: string,
    entry: Entry,
    before: string,
  ) {
    openField(this.host, at, {
      title,
      entries: [entry],
      submit: ([text = ""]) =>
        this.pen.draw({ act: "form", kind, path, form: before ? `${before} ${block(text)}` : text }),
    });
  }

  /** A variable or an event: its name and its block. */
  private named(at: Point, keyword: "var" | "event", label: string): void {
    const { machine } = this;
    const sign = keyword === "var" ? " :=" : "";
    openField(this.host, at, {
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
    openField(this.host, at, {
      title: label,
      entries: [{ label, options: names }],
      submit: ([to = ""]) => this.pen.draw({ ...act, to }),
    });
  }

  ofState(path: string, at: Point): MenuItem[] {
    const machine = parentOf(path);
    const others = this.statesOf(machine).filter((name) => name !== nameOf(path));
    const inside = machine.includes("/");
    const action = (keyword: string, title: string) => ({
      label: `${title}…`,
      action: `draw-${keyword}`,
      run: () => this.form(at, "state", path, title, { label: title, placeholder: "Python" }, keyword),
    });
    return [
      {
        label: "New transition…",
        action: "draw-transition",
        hint: "T",
        run: () => this.newTransition(at, path, ""),
      },
      action("onentry", "On entry"),
      action("running", "While active"),
      action("onexit", "On exit"),
      { label: "New machine inside…", action: "draw-inside", run: () => this.newMachine(at, path) },
      {
        label: "Start here",
        action: "draw-start",
        run: () => void this.draw({ act: "start", kind: "state", path }),
      },
      {
        label: "Move into…",
        action: "draw-nest",
        disabled: !others.length,
        run: () => this.other(at, "Move into", { act: "nest", kind: "state", path }, others),
      },
      ...(inside
        ? [
            {
              label: `Move out of ${nameOf(parentOf(machine))}`,
              action: "draw-unnest",
              run: () => void this.draw({ act: "unnest", kind: "state", path }),
            },
          ]
        : []),
      { label: "Delete", action: "draw-delete", hint: "Del", run: () => void this.delete("state", path) },
    ];
  }

  ofTransition(path: string, at: Point): MenuItem[] {
    const names = this.statesOf(path.slice(0, path.indexOf(":")));
    const lead = (act: "source" | "destination", label: string) => ({
      label: `${label}…`,
      action: `draw-${act}`,
      run: () => this.other(at, label, { act, kind: "transition", path }, names),
    });
    return [
      { label: "Edit…", action: "draw-change", hint: "F2", run: () => this.change(at, path) },
      lead("source", "From another state"),
      lead("destination", "To another state"),
      {
        label: "Reverse",
        action: "draw-reverse",
        run: () => void this.draw({ act: "reverse", kind: "transition", path }),
      },
      {
        label: "Delete",
        action: "draw-delete",
        hint: "Del",
        run: () => void this.delete("transition", path),
      },
    ];
  }

  /** The menu of the free space. */
  ofSpace(at: Point, place: readonly [number, number] | null): (MenuItem | null)[] {
    const { machine } = this;
    const ofMachine = machine
      ? [
          { label: "Rename machine…", action: "draw-rename", run: () => this.rename(at, "machine", machine) },
          {
            label: "Delete machine",
            action: "draw-delete",
            run: () => void this.draw({ act: "delete", kind: "machine", path: machine }),
          },
        ]
      : [];
    return [
      { label: "New state…", action: "draw-state", hint: "N", run: () => this.newState(at, place) },
      { label: "New variable…", action: "draw-var", run: () => this.named(at, "var", "Value") },
      { label: "New event…", action: "draw-event", run: () => this.named(at, "event", "Condition") },
      { label: "New machine…", action: "draw-machine", run: () => this.newMachine(at, "") },
      {
        label: "Other form…",
        action: "draw-form",
        run: () =>
          this.form(
            at,
            "machine",
            "",
            "Other form",
            { label: "Form", placeholder: "onpause [robot.stop()]" },
            "",
          ),
      },
      ...(ofMachine.length ? [null, ...ofMachine] : []),
    ];
  }

  /** A machine in a state, or at the top; it is shown at once. */
  private newMachine(at: Point, path: string): void {
    openField(this.host, at, {
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

  delete(kind: "state" | "transition", path: string): Promise<string | null> {
    return this.draw({ act: "delete", kind, path });
  }
}
