/** The last texts that were replaced: read one, and return to it. */

import type { VersionView } from "../protocol";
import type { Lab } from "../session/store";
import { differentLines, drawDifference, scrollToDifference } from "../ui/difference";
import { h } from "../ui/dom";
import { noteForm } from "./form";

export function versionsForm(lab: Lab, present: () => string): { element: HTMLElement; open: () => void } {
  let known: VersionView[] = [];
  const list = h("select", { class: "lrp-select", "aria-label": "Version", onchange: () => show() });
  const text = h("pre", { class: "lrp-source", tabindex: "0", "aria-label": "Text of the version" });
  const nothing = h("span", { role: "status" });
  const use = h("button", { class: "lrp-button lrp-primary", "data-lrp-action": "use-version" }, "Use");
  const show = () => {
    const version = known[list.selectedIndex];
    text.replaceChildren(...(version ? drawDifference(differentLines(present(), version.text)) : []));
    scrollToDifference(text);
  };
  const load = async () => {
    const version = known[list.selectedIndex];
    if (version && !(await lab.act({ do: "version", key: version.key }))) form.close();
  };
  const question = [h("label", {}, "Version of "), list, nothing];
  const form = noteForm("Versions", () => void load(), question, use, [text]);
  return {
    element: form.element,
    async open() {
      const { error, versions } = await lab.ask({ type: "versions" });
      if (error) return lab.notify(error);
      known = versions ?? [];
      list.replaceChildren(...known.map((version) => h("option", { value: version.key }, title(version))));
      nothing.textContent = known.length ? "" : "No text has been replaced yet.";
      list.hidden = use.hidden = text.hidden = !known.length;
      form.show();
      show();
      (known.length ? list : form.element.querySelector<HTMLElement>("[type=button]"))?.focus();
    },
  };
}

function title({ when, text }: VersionView): string {
  const lines = text.trim().split("\n");
  const size = lines.length === 1 ? "1 line" : `${lines.length} lines`;
  return `${new Date(when * 1000).toLocaleString()}, ${size}`;
}
