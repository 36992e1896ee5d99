/** A kernel that is busy for a moment is not shown as busy: only after a second, and then for a second at least. */

import { BUSY_AFTER } from "./connection";
import type { Link } from "./state";

const SECOND = 1000;

/** Pass on each change of the link until `closed`; `busy` late and for a while. */
export function steady(show: (link: Link) => void, closed: AbortSignal): (link: Link) => void {
  let shown: Link = "connecting";
  let since = 0;
  let timer: ReturnType<typeof setTimeout> | undefined;
  const become = (link: Link) => {
    shown = link;
    since = performance.now();
    show(link);
  };
  closed.addEventListener("abort", () => clearTimeout(timer));
  return (link) => {
    clearTimeout(timer);
    let wait = 0;
    if (link === "busy") wait = SECOND - BUSY_AFTER;
    else if (link === "live" && shown === "busy") wait = since + SECOND - performance.now();
    if (wait > 0) timer = setTimeout(() => become(link), wait);
    else become(link);
  };
}
