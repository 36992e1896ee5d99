/** The card that says why: why a transition did not fire, why a state is active, why the robot does what it does. */

import { machineOf } from "../language/paths";
import type { ElementKind, WhyView } from "../protocol";
import { inInstance, instancesOf, meant, placeOf } from "../session/instances";
import { newest } from "../session/newest";
import type { Lab } from "../session/store";
import { openCard } from "../ui/card";
import { h, setProse } from "../ui/dom";
import type { Point } from "../ui/point";
import { codeButton } from "./explain";
import { looked } from "./study";

const INTERVAL = 500; // ms between two questions while the program runs

/**
 * Ask, and show the answer beside a point of the window; it follows the program until it is closed. Where a machine
 * runs in several places it is about the instance that is given, or that was meant when there first were several.
 */
export function askWhy(lab: Lab, kind: ElementKind, path: string, at: Point, instance = ""): void {
  let chosen = instance;
  let where = "";
  const choose = () => {
    const { state } = lab.store;
    const several = kind === "robot" ? [] : instancesOf(state, machineOf(path));
    if (!chosen && several.length > 1) chosen = meant(state, machineOf(path))[0]!.path;
    where = placeOf(state, chosen) || where;
    return chosen ? inInstance(path, chosen) : path;
  };
  choose();
  const sentence = h("p", { class: "lrp-why-sentence", role: "status" });
  const lines = h("div", { class: "lrp-why-lines" });
  const name = path.slice(Math.max(path.lastIndexOf("/"), path.indexOf(":")) + 1);
  const title = h("span", {}, titleOf(kind, name, "", where));
  const when = h("span", { class: "lrp-faint" });
  const meaning = h("div", {});
  let answered = Number.NEGATIVE_INFINITY; // when, in ms
  let shown = "";
  let isOpen = true;
  const show = (why: WhyView) => {
    when.textContent = ` at ${why.time.toFixed(1)} s`;
    if (card.dataset.code !== why.code) {
      card.dataset.code = why.code;
      const asked = kind === "robot" ? "command" : kind;
      meaning.replaceChildren(codeButton(lab, `${asked}-${why.code}`, why.code));
    }
    title.textContent = titleOf(kind, why.name, why.code, where);
    card.setAttribute("aria-label", title.textContent);
    const content = JSON.stringify([why.sentence, why.lines, why.present]);
    if (content === shown) return;
    if (shown) sentence.removeAttribute("role"); // only the first answer is read out by itself
    shown = content;
    setProse(sentence, why.sentence);
    lines.replaceChildren(
      ...why.lines.map(({ line, text }) => {
        const range = { line, column: 1, end_line: line, end_column: 1 };
        const go = () => lab.goToRange(range, true);
        return h(
          "button",
          { type: "button", class: "lrp-why-line", disabled: !why.present, onclick: go },
          h("span", { class: "lrp-faint" }, String(line)),
          h("code", {}, text),
        );
      }),
    );
  };
  const fail = (error: string) => {
    shown = "";
    when.textContent = "";
    setProse(sentence, error);
    lines.replaceChildren();
    meaning.replaceChildren();
    delete card.dataset.code;
  };
  const ask = newest(
    lab.closed,
    () => answered + INTERVAL,
    async () => {
      if (!isOpen) return;
      const reply = await lab.ask({ type: "why", kind, path: choose() });
      answered = performance.now();
      if (!isOpen) return;
      if (reply.why) show(reply.why);
      else fail(reply.error ?? "Nothing is known about this.");
      place();
    },
  );
  const subject = `${kind} ${choose()}`.trim();
  looked(lab, "why", subject, true);
  const { card, place } = openCard(lab, at, "close-why", [title, when], [sentence, lines, meaning], () => {
    isOpen = false;
    unwatch();
    looked(lab, "why", subject, false);
  });
  const unwatch = lab.store.watch(["tick", "status", "program", "looking"], ask);
}

function titleOf(kind: ElementKind, name: string, code = "", place = ""): string {
  if (kind === "robot") return "Why does the robot do this?";
  const what = place ? `${name} in ${place}` : name;
  return kind === "state" || code === "fired" ? `Why ${what}?` : `Why not ${what}?`;
}
