/** What a screen reader hears: changes of state, at most one a second. */

import type { Lab } from "../session/store";
import { h } from "../ui/dom";

const PAUSE = 1000; // ms

export function announcer(lab: Lab): HTMLElement {
  const region = h("div", { class: "lrp-hidden", "aria-live": "polite", role: "status" });
  let _timer: ReturnType<typeof setTimeout> | undefined;
  let said = "";
  const speak = () => {
    const { active, status } = lab.store.state;
    const states = active.map((path) =>
      path
        .split("/")
        .filter((_, i) => i % 2)
        .join(", "),
    );
    const words = `${status === "running" ? "" : `${status}. `}${states.length ? `In ${states.join(" and ")}` : ""}`;
    if (words !== said) region.textContent = said = words;
  };
  lab.store.watch(["active", "status"], () => {
    _timer ??= setTimeout(() => {
      _timer = undefined;
      speak();
    }, PAUSE);
  });
  return region;
}
