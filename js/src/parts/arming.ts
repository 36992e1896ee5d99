/** The question before a robot is armed: who stops it when this program or this computer dies, or a page cannot. */

import type { Lab } from "../session/store";
import { button } from "../ui/button";
import { openCard } from "../ui/card";
import { h, setProse } from "../ui/dom";
import type { Point } from "../ui/point";

/** Ask, beside a point of the window; the robot is armed when the answer is yes. */
export function askToArm(lab: Lab, at: Point): void {
  const { store } = lab;
  const { name } = store.state.bridge;
  const late = h("p", { class: "lrp-why-sentence lrp-arm-late" });
  const failsafe = failsafeText();
  const arm = button({
    label: "Arm",
    title: "Let commands move the robot",
    action: "confirm-arm",
    class: "lrp-button lrp-primary",
    onclick: () => {
      close(true);
      void lab.act({ do: "armed", on: true });
    },
  });
  const { place, close } = openCard(
    lab,
    at,
    "close-arming",
    [h("span", {}, `Arm ${name}?`)],
    [
      h("p", { class: "lrp-why-sentence" }, "Then commands move the robot. Keep clear of it."),
      late,
      failsafe.element,
      h("div", { class: "lrp-row" }, arm),
    ],
    () => unwatch(),
  );
  let unwatch = () => {};
  unwatch = store.watch(["bridge", "late"], () => {
    const { bridge } = store.state;
    late.hidden = !store.state.late;
    setProse(late, store.state.late);
    failsafe.show(bridge.failsafe);
    place();
    if (bridge.armed || bridge.name !== name) close(false); // answered elsewhere, or it is another robot
  });
}

/** A paragraph that says who stops the robot. */
export function failsafeText(): { element: HTMLElement; show(sentence: string): void } {
  const element = h("p", { class: "lrp-failsafe" });
  return {
    element,
    show(sentence) {
      element.hidden = !sentence;
      setProse(element, sentence);
    },
  };
}
