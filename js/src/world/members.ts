/** The members of `robot`, with units and current values; a click inserts one into the block at the cursor, or copies it. */

import type { MemberView } from "../protocol";
import type { Lab } from "../session/store";
import { h, reconcile, setAttribute, setText } from "../ui/dom";

export function membersCard(lab: Lab): HTMLElement {
  const { store } = lab;
  const list = h("ul", { class: "lrp-members" });
  const title = h("summary", {}, h("code", {}, "robot"), " — click to insert or copy");
  const card = h("details", { class: "lrp-details", open: true }, title, list);
  const make = (member: MemberView) =>
    h(
      "li",
      {},
      h(
        "button",
        { type: "button", class: "lrp-member", onclick: () => lab.insert(member.insert) },
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
    setText(value!, [now, unit].filter(Boolean).join(" "));
    setAttribute(row, "title", `${member.insert}\n${member.doc}`);
  };
  store.watch(["bridge", "members", "snapshot"], () => {
    const { members } = store.state.bridge;
    card.hidden = !members.length;
    reconcile(list, members, (member) => member.name, make, update);
  });
  return card;
}
