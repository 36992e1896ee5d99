/** Completion: words of the language and the program's names at once, Python and the robot from the kernel. */

import {
  autocompletion,
  type Completion,
  type CompletionContext,
  type CompletionResult,
  snippetCompletion,
} from "@codemirror/autocomplete";
import type { Extension } from "@codemirror/state";
import { outlineOf } from "../language/lrp";
import { nameOf, parentOf } from "../language/paths";
import { scopeOf, spawned, valuesOf } from "../session/instances";
import { besideGraph } from "../session/state";
import type { Lab } from "../session/store";
import { shortened } from "../ui/cut";
import { h, prose } from "../ui/dom";
import { readable } from "../ui/numbers";
import { contextAt, machineCalled, spawnable, visibleMachines } from "./context";
import { FORMS } from "./forms";

const PATIENCE = 250; // ms to wait for the kernel with what is known here

/** What is known besides the text: of a lab, its state, and what its kernel answers. */
export type Known = Pick<Lab, "ask"> & { readonly store: Pick<Lab["store"], "state"> };

export function completion(lab: Known): Extension {
  return autocompletion({
    override: [(context) => complete(context, lab)],
    icons: false,
    activateOnTyping: true,
    activateOnCompletion: ({ apply }) => typeof apply === "string" && apply.endsWith("."),
  });
}

export async function complete(context: CompletionContext, lab: Known): Promise<CompletionResult | null> {
  const word = context.matchBefore(/[\w\u0080-\uffff]+$/);
  const from = word?.from ?? context.pos;
  const place = contextAt(context.state, context.pos);
  if (place.wanted === "python") return python(context, lab, place.scope);
  const isBegun = word || /keyword|setting/.test(place.wanted) || context.matchBefore(/\.$/);
  if (!isBegun && !context.explicit) return null;
  return offered(context, from, ofProgram(context, lab, place));
}

/**
 * The options, while the word is not complete: after `rest`, Enter begins a line, whether or not there is
 * also a `restless`.
 */
export function offered(
  context: CompletionContext,
  from: number,
  options: Completion[],
): CompletionResult | null {
  const labels = new Set(options.map(({ label }) => label));
  const open = (word: string) => context.explicit || !labels.has(word);
  if (!options.length || !open(context.state.sliceDoc(from, context.pos))) return null;
  return { from, options, validFor: (word) => /^[\w\u0080-\uffff]*$/.test(word) && open(word) };
}

function ofProgram(
  context: CompletionContext,
  lab: Known,
  place: ReturnType<typeof contextAt>,
): Completion[] {
  switch (place.wanted) {
    case "keyword":
      return keywords(place.form);
    case "event":
      return [...events(lab, context, place.scope), ...machines(context, place.scope)];
    case "delay":
      return variables(lab, context, place.scope);
    case "held":
      return [...states(lab, context, place.machine), ...keywords("", "for")];
    case "state":
      return states(lab, context, place.machine);
    case "machine":
      return spawnable(context.state, context.pos, place.scope).map((path) => ({
        label: nameOf(path),
        type: "namespace",
      }));
    case "setting":
      return settings(context, place.machine);
    case "effect":
      return context.explicit
        ? [snippetCompletion("(effect [#{}])", { ...EFFECT, label: "(effect […])" })]
        : [];
    default:
      return [];
  }
}

/** The keywords that may stand in a form, or one of them. */
function keywords(form: string, only?: string): Completion[] {
  return Object.entries(FORMS)
    .filter(([label, { inside }]) =>
      only ? label === only : inside && (inside.split(" ").includes(form) || form === "Unknown"),
    )
    .map(([label, { template, detail, doc }]) => {
      const info = () => h("div", {}, ...prose(doc));
      return snippetCompletion(template, { label, detail, type: "keyword", info });
    });
}

function events(lab: Known, context: CompletionContext, scope: string): Completion[] {
  const run = besideGraph(lab.store.state);
  return outlineOf(context.state)
    .inScope("event", scope)
    .map(({ name, path }) => ({
      label: name,
      type: "property",
      detail: valuesOf(run, "event", path)[0]?.text ?? "event",
    }));
}

/** Machines whose state can be asked for, with the dot that this takes. */
function machines(context: CompletionContext, scope: string): Completion[] {
  const names = visibleMachines(context.state, scope).map(nameOf);
  return [...new Set(names)].map((label) => ({
    label,
    type: "namespace",
    detail: "machine",
    ...(context.state.sliceDoc(context.pos, context.pos + 1) === "." ? {} : { apply: `${label}.` }),
  }));
}

function states(lab: Known, context: CompletionContext, machine: string): Completion[] {
  const { lit } = besideGraph(lab.store.state);
  return outlineOf(context.state)
    .statesOf(machine)
    .map(({ name, path }) => ({ label: name, type: "class", detail: lit.includes(path) ? "active" : "" }));
}

/** The variables of a machine that its spawn can initialise, with what they begin with. */
function settings(context: CompletionContext, machine: string): Completion[] {
  const { state, pos } = context;
  const isWhole = /^[\w\u0080-\uffff]*\s*:=/.test(state.sliceDoc(pos, pos + NEAR));
  return variablesOf(context, machine).map(({ name, from, to }) => {
    const detail = shortened(/\[.*\]/s.exec(state.sliceDoc(from, to))?.[0] ?? "", 30);
    const option = { label: name, type: "variable", detail };
    return isWhole ? option : snippetCompletion(`${name} := [#{}]`, option);
  });
}

function variablesOf({ state }: CompletionContext, machine: string) {
  return outlineOf(state)
    .inScope("variable", machine)
    .filter(({ path }) => parentOf(path) === machine);
}

function variables(lab: Known, context: CompletionContext, scope: string): Completion[] {
  return outlineOf(context.state)
    .inScope("variable", scope)
    .map(({ name, path }) => ({
      label: name,
      type: "variable",
      detail: shortened(readable(lab.store.state.variables[spawned(lab.store.state, path)]?.[0] ?? ""), 30),
      boost: 2,
    }));
}

async function python(
  context: CompletionContext,
  lab: Known,
  scope: string,
): Promise<CompletionResult | null> {
  const compared = COMPARED.exec(context.state.sliceDoc(Math.max(0, context.pos - NEAR), context.pos));
  if (compared) {
    const [, machine, begun] = compared as unknown as [string, string, string];
    return offered(context, context.pos - begun.length, statesOf(lab, context, scope, machine));
  }
  const chain = context.matchBefore(/[\w.\u0080-\uffff]+$/);
  if (!chain && !context.explicit) return null;
  const prefix = chain?.text ?? "";
  if (/^\d/.test(prefix)) return null;
  const from = context.pos - (prefix.length - (prefix.lastIndexOf(".") + 1));
  const before = context.state.sliceDoc(Math.max(0, from - NEAR), from);
  const after = context.state.sliceDoc(context.pos, context.pos + NEAR);
  const command = filledBy(prefix, before, after);
  const own = command
    ? []
    : prefix.includes(".")
      ? [...members(lab, prefix), ...results(lab, context, scope, prefix)]
      : [...variables(lab, context, scope), ROBOT, ...computed(lab, context, scope)];
  const taking = prefix.includes(".") ? null : TAKING.exec(before);
  const questions = [command ?? prefix, ...(taking ? [`robot.${taking[1]}(${prefix}`] : [])];
  const begun = prefix.slice(prefix.lastIndexOf(".") + 1);
  const isKnown = own.some(({ label }) => label.startsWith(begun));
  const replies = questions.map((question) => {
    const reply = lab.ask({ type: "complete", prefix: question, scope: scopeOf(lab.store.state, scope) });
    return isKnown ? soon(reply) : reply; // without options here there is nothing to hold up
  });
  const [names, fields] = await Promise.all(replies);
  const known = new Set(own.map(({ label }) => label));
  const more = [...(fields?.options ?? []), ...(names?.options ?? [])]
    .filter(({ label }) => !known.has(label))
    .map(({ label, kind: type, detail, info }) => ({ label, type, detail, ...(info ? { info } : {}) }));
  return offered(context, from, [...own, ...more]);
}

/** Events and machines, which blocks read; a variable of the same name hides them. */
function computed(lab: Known, context: CompletionContext, scope: string): Completion[] {
  const hidden = new Set(
    outlineOf(context.state)
      .inScope("variable", scope)
      .map(({ name }) => name),
  );
  return [...events(lab, context, scope), ...machines(context, scope)].filter(
    ({ label }) => !hidden.has(label),
  );
}

/** What follows the dot of a machine: its state and its variables. */
function results(lab: Known, context: CompletionContext, scope: string, prefix: string): Completion[] {
  const [name, ...rest] = prefix.split(".");
  const machine = rest.length === 1 && machineIn(context, scope, name!);
  if (!machine) return [];
  const { variables, lit } = besideGraph(lab.store.state);
  const active = lit.find((path) => parentOf(path) === machine);
  const state = {
    label: "state",
    type: "property",
    detail: active ? `"${nameOf(active)}"` : "None",
    boost: 1,
  };
  const own = variablesOf(context, machine).map(({ name, path }) => ({
    label: name,
    type: "variable",
    detail: shortened(readable(variables[path]?.[0] ?? ""), 30),
  }));
  return [state, ...own.filter(({ label }) => label !== "state")];
}

/** In a string that is compared with the state of a machine. */
const COMPARED =
  /([\w\u0080-\uffff]+)\.state\s*(?:[!=]=|(?:not\s+)?in\s*[([{][^)\]}]*)\s*["']([\w\u0080-\uffff]*)$/;

function statesOf(lab: Known, context: CompletionContext, scope: string, name: string): Completion[] {
  const machine = machineIn(context, scope, name);
  return machine ? states(lab, context, machine) : [];
}

/** The machine that a name in a block means. */
function machineIn({ state }: CompletionContext, scope: string, name: string): string | undefined {
  const isVariable = outlineOf(state)
    .inScope("variable", scope)
    .some((item) => item.name === name);
  return isVariable ? undefined : machineCalled(state, scope, name);
}

/** The kernel's reply if it comes soon: a busy kernel must not hold up the other options. */
function soon<T>(reply: Promise<T>): Promise<T | null> {
  return Promise.race([reply, new Promise<null>((resolve) => setTimeout(() => resolve(null), PATIENCE))]);
}

const EFFECT = { type: "keyword", detail: FORMS.effect!.detail };
const NEAR = 1000; // characters in which a message gets its name
/** In the brackets of a command, where an argument begins. */
const TAKING = /\brobot\.([\w.]+)\((?:[^()]*,)?\s*$/;

/**
 * `msg.linear.` is `robot.move().linear.` where `msg` is the message that a command fills: by a lambda, in a
 * `with`, or by a `def` that is handed to it further down.
 */
export function filledBy(prefix: string, before: string, after: string): string | null {
  const [name, ...rest] = prefix.split(".");
  if (!name || !rest.length || name === "robot") return null;
  const filler = lastOf(before, `\\bdef\\s+(\\w+)\\(\\s*${name}\\b`);
  const command =
    (filler && lastOf(after, `robot\\.([\\w.]+)\\(\\s*${filler}\\b`)) ||
    lastOf(before, `robot\\.([\\w.]+)(?:\\(\\s*lambda\\s+|\\s+as\\s+)${name}\\s*:`);
  return command ? `robot.${command}().${rest.join(".")}` : null;
}

/** The first group of the last match of a pattern. */
function lastOf(text: string, pattern: string): string | undefined {
  return [...text.matchAll(new RegExp(pattern, "g"))].at(-1)?.[1];
}

const ROBOT: Completion = { label: "robot", type: "variable", detail: "the robot", boost: 1 };

/** Members of `robot` at the next dot, with the values they have now. */
function members(lab: Known, prefix: string): Completion[] {
  if (!prefix.startsWith("robot.")) return [];
  const { bridge, members: values } = lab.store.state;
  const path = prefix.slice("robot.".length);
  const parent = path.slice(0, path.lastIndexOf(".") + 1);
  const options = new Map<string, Completion>();
  for (const member of bridge.members) {
    if (!member.name.startsWith(parent)) continue;
    const label = member.name.slice(parent.length).split(".")[0]!;
    const whole = parent + label === member.name;
    if (options.has(label) && !whole) continue;
    const detail = whole ? [readable(values[member.name] ?? ""), member.unit].filter(Boolean).join(" ") : "";
    options.set(label, {
      label,
      type: member.kind,
      detail,
      ...(whole && member.doc ? { info: member.doc } : {}),
    });
  }
  return [...options.values()];
}
