/** What the page says where nothing in it reaches the kernel, or not while a cell runs. */

import type { LabState, Link } from "../session/state";
import { setAttribute, setText, unmarked } from "../ui/dom";

const AWAY = "The program does not answer: the robot cannot be stopped from here now";

/** What is known in place of the status of the program, which may be another one by now. */
export const LINKS: Partial<Record<Link, string>> = {
  busy: "kernel busy",
  lost: "not reachable",
  dead: "no kernel",
};

type Reach = Pick<LabState, "link" | "late">;

/** Whether nothing reaches the kernel. */
export function isAway({ link }: Pick<Reach, "link">): boolean {
  return link === "lost" || link === "dead";
}

/** Why a command may come late, or not at all; empty if it comes at once. */
export function whyLate(reach: Reach): string {
  return isAway(reach) ? AWAY : unmarked(reach.late);
}

/** Say on a button to stop the robot how far it reaches; `label` and `title` are what it says otherwise. */
export function showReach(stop: HTMLButtonElement, reach: Reach, label: string, title: string): void {
  const { link, late } = reach;
  const words = !late ? label : link === "busy" ? "Stops after the cell" : "Stop after cells";
  setText(stop.querySelector(".lrp-button-label")!, isAway(reach) ? "Not reachable" : words);
  setAttribute(stop, "title", whyLate(reach) || title);
  setAttribute(stop, "data-away", isAway(reach));
  setAttribute(stop, "data-late", Boolean(late));
  stop.disabled = link === "dead";
}
