/** Restarts by an edit: the last one for some seconds, then their number, with a list. */

import type { Lab } from "../session/store";
import { button, setSwitch, toggle } from "../ui/button";
import { h, prose, reconcile, setHidden, setText } from "../ui/dom";

const FADES_AFTER = 8000; // ms

export function restarts(lab: Lab): { notice: HTMLElement; counter: HTMLElement } {
  const { store } = lab;
  const reason = h("p", {});
  const hide = () => setHidden(notice, true);
  const notice = h(
    "div",
    { class: "lrp-note lrp-note-warning lrp-notice", role: "status" },
    reason,
    keepRunning(lab),
    button({ icon: "close", title: "Dismiss", onclick: hide }),
  );
  const count = h("summary", {});
  const list = h("ol", { class: "lrp-restart-list" });
  const counter = h(
    "details",
    {
      class: "lrp-restarts",
      onkeydown: (event: KeyboardEvent) => {
        if (event.key !== "Escape") return;
        counter.open = false;
        count.focus();
      },
    },
    count,
    h("div", { class: "lrp-sheet" }, list, keepRunning(lab)),
  );
  let seen = 0;
  let timer: ReturnType<typeof setTimeout> | undefined;
  const fade = () => {
    if (notice.matches(":hover, :focus-within")) timer = setTimeout(fade, FADES_AFTER);
    else hide();
  };
  notice.hidden = true;
  store.watch(["restarts", "snapshot"], (changed) => {
    const all = Object.entries(store.state.restarts).sort(([a], [b]) => Number(b) - Number(a));
    const [number, last] = all[0] ?? ["0", null];
    counter.hidden = !last;
    setText(count, number === "1" ? "1 restart" : `${number} restarts`);
    reconcile(
      list,
      all,
      ([key]) => key,
      ([, { tick, reason: why }]) => h("li", {}, `Tick ${tick}: `, ...prose(why)),
      () => {},
    );
    if (last && Number(number) > seen && !changed.has("snapshot")) {
      reason.replaceChildren(`Restarted at tick ${last.tick}: `, ...prose(last.reason));
      notice.hidden = false;
      clearTimeout(timer);
      timer = setTimeout(fade, FADES_AFTER);
    }
    seen = Number(number);
  });
  return { notice, counter };
}

function keepRunning(lab: Lab): HTMLElement {
  const { store } = lab;
  const keep = toggle(
    "Keep running next time",
    "Do not restart when the active state is edited",
    "keep",
    (on) => void lab.act({ do: "on_active_edit", name: on ? "keep" : "restart" }),
  );
  store.watch(["settings"], () => setSwitch(keep, store.state.settings.on_active_edit === "keep"));
  return keep;
}
