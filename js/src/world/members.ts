/** The members of `robot`, with units and current values; a click inserts one into the block at the cursor, or copies it. */

import { history } from "../parts/history";
import type { MemberView } from "../protocol";
import type { Lab } from "../session/store";
import { ofReading } from "../timeline/spark";
import { button, panel } from "../ui/button";
import { h, reconcile, setAttribute, setText } from "../ui/dom";
import { readable } from "../ui/numbers";

export function robotView(lab: Lab): HTMLElement {
  const { store } = lab;
  const inspect = button({
    icon: "search",
    label: "Inspect",
    title: "Inspect the robot",
    action: "inspect-robot",
    onclick: () => lab.inspect("robot", ""),
  });
  const list = h("ul", {
    class: "lrp-members",
    tabindex: "0",
    "aria-label": "Members: click to insert or copy",
  });
  const { element } = panel("robot", "Robot", [inspect], list);
  const make = (member: MemberView) =>
    h(
      "li",
      {},
      h(
        "button",
        {
          ...{ type: "button", class: "lrp-member", onclick: () => lab.insert(member.insert) },
          ...(member.kind === "variable" ? history(ofReading(member.name)) : {}),
        },
        h("code", {}),
        h("span", { class: "lrp-member-value" }),
      ),
    );
  const update = (element: Element, member: MemberView) => {
    const row = element.firstElementChild!;
    const [name, value] = row.children;
    setText(name!, member.name);
    const now = store.state.members[member.name] ?? "";
    const unit = now && now !== "waiting" ? member.unit : "";
    const exact = [now, unit].filter(Boolean).join(" ");
    setText(value!, readable(exact));
    setAttribute(row, "title", [member.insert, member.doc, exact].filter(Boolean).join("\n"));
  };
  store.watch(["bridge", "members", "snapshot"], () => {
    const { members } = store.state.bridge;
    setAttribute(list, "data-empty", members.length ? null : "The program runs without a robot.");
    reconcile(list, members, (member) => member.name, make, update);
  });
  return element;
}
