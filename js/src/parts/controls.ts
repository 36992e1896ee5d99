/** The controls: run, pause, step, reset, stop; rate and speed; the bridge. */

import type { Lab } from "../session/store";
import { button, iconButton, setSwitch, toggle } from "../ui/button";
import { h, setAttribute, setChoices, setHidden, setText, unmarked } from "../ui/dom";
import { icon } from "../ui/icons";
import { menuButton } from "../ui/menu";
import { below } from "../ui/point";
import { askToArm } from "./arming";
import { type Choices, labMenu } from "./menu";
import { rateSlider, speedSelect } from "./rate";
import { showReach, whyLate } from "./reach";
import { pausedBy, statusLine } from "./status";
import { recorded, showLock } from "./study";

const RUNS = "Run or pause the program";
const STOPS = "Stop all motors, then pause";
const DISARMED = "While disarmed, commands are shown but not sent";
const HOLDS = "Edits take effect only when you choose Apply (Ctrl+Enter)";

/** `restarts` counts them. */
export function controls(lab: Lab, choices: Choices, restarts: HTMLElement): HTMLElement {
  const { store } = lab;
  const isOn = () => store.state.status === "running" || store.state.status === "hung";
  const go = (act: "step" | "step_back" | "reset" | "stop") => () => void lab.act({ do: act });
  const run = button({
    icon: "run",
    label: "Run",
    title: RUNS,
    action: "run",
    onclick: () => void lab.act({ do: isOn() ? "pause" : "run" }),
  });
  const step = iconButton("step", "Step: exactly one tick", "step", go("step"));
  const back = iconButton("step_back", "Step back by one tick", "step-back", go("step_back"));
  const reset = button({
    icon: "reset",
    label: "Reset",
    title: "Reset the program: start it from scratch; the world stays",
    action: "reset",
    onclick: go("reset"),
  });
  const stop = button({
    icon: "stop",
    label: "Stop robot",
    title: STOPS,
    action: "stop",
    onclick: go("stop"),
  });
  stop.classList.add("lrp-stop");
  store.watch(["link", "late"], () => {
    showReach(stop, store.state, "Stop robot", STOPS);
    setAttribute(run, "title", whyLate(store.state) || RUNS);
  });
  const more = menuButton(lab.root, { title: "More", action: "menu" }, "Lab", () => labMenu(lab, choices));
  const hold = toggle("Hold edits", HOLDS, "hold", (on) => void lab.act({ do: "hold", on }));
  store.watch(["settings"], () => {
    const { settings } = store.state;
    setSwitch(hold, settings.edits === "hold");
    showLock(hold, settings, HOLDS);
  });
  store.watch(["status"], () => {
    const on = isOn();
    const name = on ? "pause" : "run";
    setAttribute(run, "data-lrp-action", name);
    setAttribute(run, "aria-label", on ? "Pause" : "Run");
    run.replaceChildren(icon(name), h("span", { class: "lrp-button-label" }, on ? "Pause" : "Run"));
    run.classList.toggle("lrp-primary", !on);
    back.disabled = step.disabled = on;
  });
  return h(
    "div",
    { class: "lrp-controls", "data-lrp": "controls", role: "toolbar", "aria-label": "Controls" },
    nameplate(lab),
    h("div", { class: "lrp-group" }, run, back, step, reset),
    stop,
    rateSlider(lab),
    speedSelect(lab),
    h("div", { class: "lrp-told" }, statusLine(lab), pausedBy(lab), restarts, recorded(lab)),
    bridgeChip(lab),
    hold,
    more,
  );
}

function nameplate(lab: Lab): HTMLElement {
  const name = h("strong", { class: "lrp-name" });
  const mark = button({
    label: "Not kept",
    title: "",
    action: "unkept",
    class: "lrp-button lrp-unkept",
    onclick: () => lab.notify(reason()),
  });
  const reason = () => lab.store.state.unkept || lab.store.state.unsaved;
  lab.store.watch(["name", "unkept", "unsaved", "link", "snapshot"], () => {
    const { name: text, unkept, link } = lab.store.state;
    setText(name, text);
    setText(mark.firstElementChild!, unkept ? "Not kept" : "Not saved");
    setHidden(mark, !reason() || (unkept !== "" && link === "dead")); // then the page keeps it
    setAttribute(mark, "title", unmarked(reason()));
  });
  return h("div", { class: "lrp-group", role: "status" }, name, mark);
}

function bridgeChip(lab: Lab): HTMLElement {
  const { store } = lab;
  const dot = h("span", { class: "lrp-dot", "aria-hidden": "true" });
  const select = h("select", {
    class: "lrp-select",
    "aria-label": "Bridge to the robot",
    "data-lrp-action": "bridge",
    onchange: async () => {
      await lab.act({ do: "bridge", name: select.value });
      select.value = store.state.bridge.name; // the one in use, if this one was refused
    },
  });
  const armed = toggle("Armed", DISARMED, "armed", (on) =>
    on ? askToArm(lab, below(armed)) : void lab.act({ do: "armed", on }),
  );
  const chip = h("span", { class: "lrp-bridge" }, dot, select, armed);
  store.watch(["bridge", "choices", "snapshot"], () => {
    const { bridge, choices } = store.state;
    const names = choices.bridges.includes(bridge.name) ? choices.bridges : [bridge.name, ...choices.bridges];
    const offered = names.map((name) => [name, name] as const);
    setChoices(select, offered, bridge.name);
    setAttribute(dot, "data-status", bridge.status);
    setAttribute(chip, "title", `${bridge.status}${bridge.sentence ? `: ${unmarked(bridge.sentence)}` : ""}`);
    setSwitch(armed, bridge.armed);
    setAttribute(armed, "title", bridge.armed ? unmarked(bridge.failsafe) : DISARMED);
    armed.hidden = !bridge.hardware;
  });
  return chip;
}
