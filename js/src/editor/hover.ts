/** The card under the pointer: what a name or keyword is, its documentation, and the value a name has now. */

import { EditorState, type Extension } from "@codemirror/state";
import { closeHoverTooltips, hoverTooltip } from "@codemirror/view";
import { outlineOf, treeOf } from "../language/lrp";
import { machineOf, nameOf } from "../language/paths";
import { lookedAt } from "../parts/study";
import type { HoverView } from "../protocol";
import { addressed, instancesOf, placeOf, scopeOf, stateOf, valuesOf } from "../session/instances";
import type { Lab } from "../session/store";
import { spark } from "../timeline/spark";
import { h, prose } from "../ui/dom";
import { readable } from "../ui/numbers";
import { chainAt, contextAt, namedAt } from "./context";
import { FORMS } from "./forms";
import { subjectAt } from "./history";
import { scrubbed } from "./scrub";

/** What a card says is about the text as it was, and the card lies over what is being typed; not over a number's steps. */
const closedByEdits = EditorState.transactionExtender.of((transaction) =>
  transaction.docChanged && !transaction.annotation(scrubbed) ? { effects: closeHoverTooltips } : null,
);

export function hover(lab: Lab): Extension {
  return [closedByEdits, cards(lab)];
}

function cards(lab: Lab): Extension {
  return hoverTooltip(
    async (view, offset) => {
      const chain = chainAt(view.state, offset);
      if (!chain || /Comment|String/.test(treeOf(view.state).resolveInner(offset, 1).name)) return null;
      const place = contextAt(view.state, offset);
      const card =
        place.wanted === "python"
          ? await ofPython(lab, view.state, chain.text, place.scope)
          : await withReason(lab, ofProgram(lab, view.state, chain));
      if (!card) return null;
      const subject = lab.store.state.settings.quiet ? null : subjectAt(lab, view.state, offset);
      return {
        pos: chain.from,
        end: chain.to,
        above: true,
        create: () => {
          const [dom, told] = [cardOf(card), lookedAt(lab, card.title)];
          const shown = subject && spark(lab, subject);
          if (shown) dom.append(shown.element);
          const destroy = () => {
            told();
            shown?.close();
          };
          return { dom, destroy };
        },
      };
    },
    { hoverTime: 350 },
  );
}

/** Add to the card of a state or a transition why it is active, or did not fire. */
async function withReason(lab: Lab, card: ProgramCard | null): Promise<HoverView | null> {
  if (!card?.path || (card.kind !== "state" && card.kind !== "transition")) return card;
  const { state } = lab.store;
  const { why } = await lab.ask({ type: "why", kind: card.kind, path: addressed(state, card.path) });
  return why ? { ...card, doc: `${card.doc}. ${why.sentence}` } : card;
}

interface ProgramCard extends HoverView {
  kind?: string;
  path?: string;
}

function ofProgram(lab: Lab, state: EditorState, chain: { text: string; from: number }): ProgramCard | null {
  const form = treeOf(state).resolveInner(chain.from, 1).name === "Keyword" && FORMS[chain.text];
  if (form) return { title: form.usage, type: "", value: "", doc: form.doc };
  const { entered, fired } = lab.store.state;
  const item = namedAt(state, chain.from, chain.text);
  if (!item) return null;
  const { kind, path } = item;
  const card = { title: `${kind} ${item.name}`, type: "", value: "", doc: "", kind, path };
  if (item.kind === "state") {
    const [visits] = entered[item.path] ?? [0];
    return {
      ...card,
      value: activeIn(lab, item.path),
      doc: `entered ${visits} ${visits === 1 ? "time" : "times"}`,
    };
  }
  if (item.kind === "transition") return { ...card, doc: `fired ${fired[item.path]?.[0] ?? 0} times` };
  if (item.kind === "event") return { ...card, value: allValues(lab, item.kind, item.path) ?? "" };
  if (item.kind === "variable")
    return { ...card, value: allValues(lab, item.kind, item.path) ?? "no value now" };
  const running = instancesOf(lab.store.state, path).map((each) => {
    const place = placeOf(lab.store.state, each.path);
    return `in ${nameOf(stateOf(lab.store.state, each))}${place && ` (${place})`}`;
  });
  return { ...card, value: running.join("\n") || "not running" };
}

/** Whether a state is active; where its machine runs in several places, in which. */
function activeIn({ store: { state } }: Lab, path: string): string {
  const all = instancesOf(state, machineOf(path));
  const places = all
    .filter((each) => all.length > 1 && stateOf(state, each) === path)
    .map((each) => placeOf(state, each.path));
  if (places.length) return `active in ${places.join(", ")}`;
  return state.lit.includes(path) ? "active" : "";
}

/** The value of a variable or an event; where its machine runs in several places, in each. */
function allValues(lab: Lab, kind: "variable" | "event", path: string): string | undefined {
  const values = valuesOf(lab.store.state, kind, path, true);
  return values.length > 1
    ? values.map(({ place, text }) => `${place}: ${text}`).join("\n")
    : values[0]?.text;
}

async function ofPython(
  lab: Lab,
  state: EditorState,
  chain: string,
  scope: string,
): Promise<HoverView | null> {
  const { bridge, members } = lab.store.state;
  const member = chain.startsWith("robot.") && bridge.members.find(({ name }) => `robot.${name}` === chain);
  if (member) {
    const value = [members[member.name], member.unit].filter(Boolean).join(" ");
    return { title: chain, type: member.type, value, doc: member.doc };
  }
  const variable = outlineOf(state)
    .inScope("variable", scope)
    .find(({ name }) => name === chain);
  const { hover } = await lab.ask({ type: "hover", chain, scope: scopeOf(lab.store.state, scope) });
  if (!hover || !variable) return hover ?? null;
  return { ...hover, value: allValues(lab, "variable", variable.path) ?? hover.value };
}

function cardOf({ title, type, value, doc }: HoverView): HTMLElement {
  const kind = type && h("span", { class: "lrp-faint" }, ` ${type}`);
  return h(
    "div",
    { class: "lrp-card" },
    h("div", { class: "lrp-card-title" }, h("code", {}, title), kind),
    value && h("div", { class: "lrp-card-value", title: value }, readable(value)),
    doc && h("div", { class: "lrp-card-doc" }, ...prose(doc)),
  );
}
