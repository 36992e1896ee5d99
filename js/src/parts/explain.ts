/** What a code means, and what to do: the kernel's explanation on a card, without a network. */

import type { ExplanationView } from "../protocol";
import type { Lab } from "../session/store";
import { linkButton } from "../ui/button";
import { openCard } from "../ui/card";
import { h, prose } from "../ui/dom";
import { below, type Point } from "../ui/point";
import { looked } from "./study";

export function codeButton(lab: Lab, code: string, text = code): HTMLButtonElement {
  const button = linkButton(text, {
    class: "lrp-link lrp-code",
    title: `What ${text} means`,
    "data-lrp-action": "explain",
    onclick: () => void explain(lab, code, below(button)),
  });
  return button;
}

async function explain(lab: Lab, code: string, at: Point): Promise<void> {
  const { explanation, error } = await lab.ask({ type: "explain", code });
  if (explanation) show(lab, explanation, at);
  else lab.notify(error ?? "Nothing is known about this.");
}

function show(lab: Lab, { code, title, ...parts }: ExplanationView, at: Point): void {
  const paragraph = (text: string) => h("p", { class: "lrp-why-sentence" }, ...prose(text));
  const source = (text: string) => text && h("pre", { class: "lrp-source", tabindex: "0" }, text);
  const body = h(
    "div",
    { class: "lrp-explanation" },
    paragraph(parts.explanation),
    source(parts.example),
    source(parts.script),
    h("strong", {}, "What to do"),
    paragraph(parts.remedy),
    source(parts.repaired),
    /^https?:/.test(parts.address) && // where the documentation is published
      h("a", { href: parts.address, target: "_blank", rel: "noopener" }, "In the documentation"),
  );
  const heading = [h("span", {}, ...prose(title)), h("span", { class: "lrp-faint" }, ` ${code}`)];
  looked(lab, "explain", code, true);
  openCard(lab, at, "close-explanation", heading, [body], () => looked(lab, "explain", code, false));
}
