/**
 * Fingers in the lab. One that has grabbed something does not scroll the page. A long press opens the menu that a right
 * click opens, because not every browser says so itself; where there is none, it shows an element's title.
 */

import { h } from "./dom";
import { giveUpDrags, isHolding } from "./drag";
import { isTouch, type Point, placeInSight } from "./point";
import { openPopup } from "./popup";

const LONG = 500; // ms
const STILL = 10; // px that a finger may move meanwhile
const ABOVE = 56; // px from a finger to what it would hide
const EDGE = 4; // px between a title and the edge of what can be seen
const TEXT = "input, textarea, select, .cm-content"; // has a long press of its own

export function useFingers(root: HTMLElement): void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let frame = 0;
  let begun: Point = { x: 0, y: 0 };
  let isDown = false;
  let wasLong = false; // and has done something: the rest of the touch does nothing more
  const isShort = () => {
    clearTimeout(timer);
    cancelAnimationFrame(frame);
  };
  const moved = (event: TouchEvent) => {
    const { clientX, clientY } = event.touches[0]!;
    if (Math.hypot(clientX - begun.x, clientY - begun.y) > STILL) isShort();
    if (event.cancelable && (wasLong || isHolding())) event.preventDefault();
  };
  const ended = (event: TouchEvent) => {
    isShort();
    isDown = event.touches.length > 0;
    if (event.cancelable && wasLong) event.preventDefault(); // or it would click
  };
  const follow = (element: HTMLElement) => {
    element.addEventListener("touchmove", moved, { passive: false });
    element.addEventListener("touchend", ended, { passive: false });
    element.addEventListener("touchcancel", ended, { passive: false });
  };
  follow(root);
  root.addEventListener(
    "touchstart",
    ({ touches, target }) => {
      isShort();
      isDown = true;
      wasLong = false;
      begun = { x: touches[0]!.clientX, y: touches[0]!.clientY };
      follow(target as HTMLElement); // drawn again, the old element alone is told of the rest of the touch
      if (touches.length > 1) return;
      const act = () => {
        wasLong = pressed(elementNow(target as Element, begun), begun);
        if (wasLong) giveUpDrags();
      };
      timer = setTimeout(() => {
        frame = requestAnimationFrame(act); // after a move that a busy page has not been told of yet
      }, LONG);
    },
    { passive: true },
  );
  root.addEventListener(
    "contextmenu",
    (event) => {
      if (!event.isTrusted || !(isDown || isTouch(event))) return;
      event.stopImmediatePropagation(); // the browser's own comes at another time, and opens the notebook's menu
      if (!(event.target as Element).closest(TEXT)) event.preventDefault();
    },
    true,
  );

  root.addEventListener("contextmenu", (event) => {
    if (!event.isTrusted) event.stopPropagation(); // from here: the notebook has a menu, too
  });

  /** What a finger has pressed, or what was drawn in its place meanwhile. */
  function elementNow(pressed: Element, { x, y }: Point): Element {
    const tree = root.getRootNode() as Document | ShadowRoot;
    const now = pressed.isConnected ? pressed : tree.elementFromPoint(x, y);
    return root.contains(now) ? now! : root;
  }

  /** Do what a long press does; return whether that is anything. */
  function pressed(target: Element, { x, y }: Point): boolean {
    const menu = new MouseEvent("contextmenu", {
      bubbles: true,
      cancelable: true,
      composed: true,
      button: 2,
      clientX: x,
      clientY: y,
    });
    if (!target.dispatchEvent(menu)) return true;
    const title = target.closest<HTMLElement>("[title]")?.title;
    if (!title || target.closest(TEXT)) return false;
    const tip = h("div", { class: "lrp-tip", role: "tooltip" }, title);
    openPopup(root, tip, () => placeInSight(root, tip, { x, y: y - ABOVE }, EDGE));
    return true;
  }
}
