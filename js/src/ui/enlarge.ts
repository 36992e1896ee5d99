/**
 * One panel alone in the lab, or the lab alone in the window: by a double click on a panel's head, by its
 * button, by keys. The lab becomes a popover, because nothing of the page around it can cut off a popover.
 */

import type { Layout } from "./layout";
import { focusedAround } from "./root";

const CONTROL = "button, select, input, a, label";

/** `layout` is null where there is one panel only: that one fills the window. */
export function enlarging(host: HTMLElement, root: HTMLElement, layout: Layout | null) {
  const isFilling = () => host.hasAttribute("popover");
  const fill = (on: boolean) => {
    const focused = focusedAround(root) as HTMLElement | null;
    if (on) {
      host.setAttribute("popover", "manual");
      host.showPopover();
    } else host.removeAttribute("popover");
    root.toggleAttribute("data-fills", on);
    if (focused && root.contains(focused)) focused.focus({ preventScroll: true });
  };
  const enlarge = (panel: HTMLElement | null) => {
    if (!layout) fill(!isFilling());
    else if (panel) layout.maximise(panel.hasAttribute("data-maximised") ? null : panel);
  };
  const panelOf = (event: Event) => (event.target as Element).closest<HTMLElement>(".lrp-panel");
  root.addEventListener("click", (event) => {
    if ((event.target as Element).closest('[data-lrp-action="enlarge"]')) enlarge(panelOf(event));
  });
  root.addEventListener("dblclick", (event) => {
    const target = event.target as Element;
    if (target.closest(".lrp-head") && !target.closest(CONTROL)) enlarge(panelOf(event));
  });
  root.addEventListener("keydown", (event) => {
    if (event.key !== "F9" || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    if (event.shiftKey) fill(!isFilling());
    else enlarge(layout?.maximised ?? panelOf(event));
  });
  return { isFilling, fill };
}
