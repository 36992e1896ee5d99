/** Why the program was restarted, beside the graph, with the switch that keeps it running next time. */

import type { Lab } from "../session/store";
import { button, setSwitch, toggle } from "../ui/button";
import { h, setText } from "../ui/dom";
import { prose } from "../ui/prose";

export function restartNotice(lab: Lab): HTMLElement {
  const { store } = lab;
  const reason = h("p", {});
  const keep = toggle(
    "Keep running next time",
    "What an edit of the active state does: restart, or go on",
    "keep",
    (on) => void lab.act({ do: "on_active_edit", name: on ? "keep" : "restart" }),
  );
  const notice = h(
    "div",
    { class: "lrp-notice", role: "status" },
    reason,
    h("div", { class: "lrp-row" }, keep, button({ icon: "close", title: "Dismiss", onclick: () => hide() })),
  );
  let seen = 0;
  const hide = () => {
    notice.hidden = true;
  };
  notice.hidden = true;
  store.watch(["restart", "settings", "snapshot"], (changed) => {
    const { restart, settings } = store.state;
    setSwitch(keep, settings.on_active_edit === "keep");
    const count = restart?.count ?? 0;
    if (count > seen && restart && !changed.has("snapshot")) {
      setText(reason, "");
      reason.append(`Restarted at tick ${restart.tick}: `, ...prose(restart.reason));
      notice.hidden = false;
    }
    seen = count;
  });
  return notice;
}
