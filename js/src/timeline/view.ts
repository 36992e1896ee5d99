/** The timeline below the panels: what happened, a playhead that takes the whole lab back, and what if. */

import { keepButton } from "../parts/keep";
import { looked } from "../parts/study";
import { newest } from "../session/newest";
import type { Lab } from "../session/store";
import { button, iconButton } from "../ui/button";
import { consume, h, s, setAttribute, setHidden } from "../ui/dom";
import { trackDrag } from "../ui/drag";
import { isOn, keep, keepOn, kept } from "../ui/kept";
import { item, openMenu } from "../ui/menu";
import { readableNumber } from "../ui/numbers";
import { onPinch } from "../ui/pinch";
import { pointOf, reachOf } from "../ui/point";
import { TRAIL_COLORS, trailStyles } from "../world/legend";
import { clearAxis, type Drawing, draw, heightOf, laneAt, roomFor, widthOf } from "./draw";
import { Happened, lanesOf, type Segment, segmentAt, valueAt } from "./happened";
import { band, type Looking, type Moment } from "./looking";
import { labelsOf } from "./plots";
import { nearestX, timeOf } from "./scale";
import { Visits } from "./visits";
import { whatIfWords } from "./what_if";
import { TimeWindow } from "./window";

const INTERVAL = 250; // ms between two drawings of a run that goes on
const NEWS_AFTER = 500; // ms between an answer and the next question
const ALL_AFTER = 3000; // ms, where the page itself sees nothing new: what was done by hand, commands
const CALM = 300; // ms after an edit: first it is applied and drawn
const NARROW = 700; // px of a lab in which the timeline is closed at first
const OPEN = "timeline";
const PLOTS = "plots:";
const NEAR = 4; // px
const MARGIN = 60; // px above and below what is in sight, to be scrolled to
const STEPS = 10; // ticks, with Shift
const STILL = 1500; // ms

/** `keepRun` opens the form that keeps the present run. */
export function timelineView(lab: Lab, looking: Looking, keepRun: () => void): HTMLElement {
  const { store } = lab;
  let happened = new Happened();
  let plots: readonly string[] = [];
  let answered = Number.NEGATIVE_INFINITY; // when, in ms
  let drawn = Number.NEGATIVE_INFINITY;
  let isNews = true; // whether there is something to ask for
  let edited = Number.NEGATIVE_INFINITY;
  let drawing: Drawing | null = null;
  let styleOf = trailStyles(store.state.program, TRAIL_COLORS);
  let stillUntil = 0; // nothing moves away under a pointer that is aiming
  const shown = new TimeWindow(store, () => now());
  let later: ReturnType<typeof setTimeout> | undefined; // draws what a pointer has put off
  let next: ReturnType<typeof setTimeout> | undefined; // asks what it was too soon to ask

  const svg = s("svg", { class: "lrp-timeline-drawing", "aria-hidden": "true" });
  const playhead = h("div", {
    class: "lrp-playhead",
    role: "slider",
    tabindex: "0",
    "aria-label": "Moment that the lab shows",
    title:
      "Drag, or use the keys. ←, →: one tick, with Shift ten. Page Up, Down: next, previous change. Home: start. End, Escape: now. Enter, ?: why. +, −: zoom",
  });
  const area = h("div", { class: "lrp-timeline-area" }, svg, playhead);
  const body = h("div", { class: "lrp-timeline-body" }, area);
  const more = button({
    label: "Plot…",
    title: "Choose variables and readings to plot",
    action: "plot",
    "aria-haspopup": "menu",
    onclick: () => plotMenu(),
  });
  const zoomOut = iconButton("minus", "Zoom out", "timeline-out", () => zoom(2));
  const zoomIn = iconButton("plus", "Zoom in", "timeline-in", () => zoom(0.5));
  const tools = h("div", { class: "lrp-tools" }, keepButton(lab, keepRun), more, zoomOut, zoomIn);
  const opener = iconButton("right", "Open or close the timeline", "timeline", () => open(body.hidden, true));
  const title = h("div", { class: "lrp-title" }, "Timeline");
  const said = band(lab, looking);
  const head = h("header", { class: "lrp-timeline-head" }, opener, title, said, tools);
  const element = h(
    "section",
    { class: "lrp-timeline", "data-lrp": "timeline", "aria-label": "Timeline" },
    head,
    body,
  );

  const open = (on: boolean, chosen = false) => {
    setHidden(body, !on);
    setHidden(tools, !on);
    element.toggleAttribute("data-open", on);
    setAttribute(opener, "aria-expanded", String(on));
    if (chosen) {
      keepOn(OPEN, on);
      looked(lab, "panel", "timeline", on);
    }
    if (on) askNow();
  };

  /* ---------------------------------------------------------------- data */

  const now = () => {
    const { looking: moment, time } = store.state;
    return Math.max(happened.end, moment ? moment.time + moment.ago : time);
  };
  const askNow = () => {
    isNews = true;
    ask();
  };
  const ask = newest(
    lab.closed,
    () => Math.max(drawn + INTERVAL, edited + CALM),
    async () => {
      if (body.hidden || !store.state.tick) return;
      drawn = performance.now();
      clearTimeout(next);
      const wait = answered + (isNews || plots.length ? NEWS_AFTER : ALL_AFTER) - drawn;
      if (wait <= 0) await read();
      else next = setTimeout(ask, wait); // a paused program has no tick to come that would ask
      clearTimeout(later);
      if (performance.now() >= stillUntil) redraw();
      else later = setTimeout(redraw, stillUntil - performance.now());
    },
  );
  const read = async () => {
    isNews = false;
    const wanted = Object.fromEntries(plots.map((name) => [name, happened.plots.get(name)?.tick ?? 0]));
    const run = happened; // another one after a snapshot
    const { epoch, last } = run;
    const { timeline } = await lab.ask({ type: "timeline", epoch, tick: last, plots: wanted });
    answered = performance.now();
    if (timeline) run.merge(timeline);
    else if (store.state.link !== "dead") askNow(); // the kernel was too busy to answer in time
  };

  /* ---------------------------------------------------------------- drawing */

  const redraw = () => {
    const whole = area.clientWidth;
    if (body.hidden || !whole) return;
    const left = Math.min(130, Math.max(110, whole * 0.12));
    const { whatIf, looking: moment } = store.state;
    const { scrollTop, clientHeight } = body;
    drawing = {
      span: shown.span,
      sight: { top: scrollTop - MARGIN, bottom: scrollTop + clientHeight + MARGIN },
      left,
      width: whole - left - 14,
      now: now(),
      machines: store.state.program.machines.length,
      lanes: happened.lanes(),
      marks: happened.marks(),
      plots: plots.flatMap((name) => {
        const plotted = happened.plots.get(name);
        return plotted ? [[name, plotted] as [string, typeof plotted]] : [];
      }),
      other:
        whatIf && moment
          ? {
              lanes: lanesOf(whatIf.changed.happenings),
              end: whatIf.end,
              divergence: whatIf.divergence,
            }
          : null,
      labels: labelsOf(plots, happened.names),
      styleOf,
    };
    draw(svg, drawing);
    area.style.height = `${heightOf(drawing)}px`;
    body.style.height = `${roomFor(drawing)}px`;
    point();
  };
  /** Put the playhead where it belongs. */
  const point = () => {
    if (!drawing) return;
    const moment = store.state.looking;
    const { wanted } = looking;
    const at = (wanted && "time" in wanted ? wanted.time : moment?.time) ?? now();
    const x = nearestX(drawing, at);
    playhead.style.transform = `translateX(${x.toFixed(1)}px)`;
    playhead.toggleAttribute("data-past", isPast());
    const isRight = x > drawing.left + drawing.width / 2;
    playhead.toggleAttribute("data-right", isRight);
    playhead.style.setProperty("--lrp-beside", `${Math.floor(isRight ? x : area.clientWidth - x)}px`);
    setAttribute(playhead, "aria-valuemin", happened.begin);
    setAttribute(playhead, "aria-valuemax", now().toFixed(1));
    setAttribute(playhead, "aria-valuenow", at.toFixed(1));
    const { whatIf } = store.state;
    const words = whatIf ? whatIfWords(whatIf) : "";
    const ago = `${at.toFixed(1)} s, ${Math.max(0, now() - at).toFixed(1)} s ago${words && `, ${words}`}`;
    setAttribute(playhead, "aria-valuetext", isPast() ? ago : "now"); // or it would be read out in every tick
    const label = `${at.toFixed(1)} s${valuesAt(at)}${words && ` · ${words}`}`;
    playhead.dataset.label = label;
    const covers: [number, number][] = [];
    if (isPast()) covers.push(isRight ? [x - widthOf(label), x] : [x, x + widthOf(label)]);
    if (tools.offsetParent === head)
      covers.push([Math.min(tools.offsetLeft, said.offsetLeft || tools.offsetLeft), area.clientWidth]);
    clearAxis(svg, covers);
  };
  const valuesAt = (time: number) => {
    const labels = labelsOf(plots, happened.names);
    return plots
      .map((name) => {
        const plotted = happened.plots.get(name);
        const value = plotted ? valueAt(plotted, time) : null;
        if (value === null || !plotted) return "";
        const text = plotted.kind === "truth" ? (value ? "True" : "False") : readableNumber(value);
        return ` · ${labels.get(name)} ${text}`;
      })
      .join("");
  };

  const zoom = (factor: number, moment?: number) => {
    shown.zoom(factor, moment);
    redraw();
  };

  /* ---------------------------------------------------------------- pointer and keys */

  /** The time at a point of the window, in seconds. */
  const timeAt = (x: number): number => {
    if (!drawing) return 0;
    return timeOf(drawing, x - area.getBoundingClientRect().left);
  };
  const isAtName = ({ clientX }: MouseEvent) =>
    clientX < area.getBoundingClientRect().left + (drawing?.left ?? 0) - NEAR;
  const isPast = () => Boolean(store.state.looking ?? looking.wanted);
  /** Show the moment at the pointer; the present has no moment, nor has what comes after it. */
  const go = (event: MouseEvent) => {
    const time = timeAt(event.clientX);
    if (!happened.last || (time > now() && !isPast())) return;
    void look({ time: Math.max(happened.begin, Math.min(now(), time)) });
  };
  /** Show a moment; the window stands still from now on. Resolves to whether it is shown. */
  const look = async (moment: Moment) => {
    shown.stop();
    const isShown = await looking.at(moment);
    if (!isShown && !store.state.looking) returnToNow();
    return isShown;
  };
  const returnToNow = () => {
    shown.follow();
    looking.back();
    redraw();
  };
  const visits = new Visits(lab, () => happened, look);
  area.addEventListener("pointermove", () => {
    stillUntil = performance.now() + STILL;
  });
  area.addEventListener("pointerleave", () => {
    stillUntil = 0;
  });
  onPinch(area, (factor, middle, dx) => {
    shown.zoom(1 / factor, timeAt(middle.x));
    shown.pan(-dx / (drawing?.width ?? 1));
    redraw();
  });
  area.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || isAtName(event)) return;
    const border = borderAt(event);
    const mark = (event.target as Element).closest("[data-lrp-mark]");
    const { looking: before } = store.state;
    playhead.focus({ preventScroll: true });
    event.preventDefault();
    trackDrag(area, event, {
      scrolls: event.target === playhead ? undefined : "down",
      move: (last) => go(last),
      end: (last, moved) => {
        if (!last && before) void look({ tick: before.tick });
        else if (!last || timeAt(last.clientX) > now()) {
          if (isPast()) returnToNow();
        } else if (moved) return;
        else if (mark) void look({ tick: Number(mark.getAttribute("data-tick")) });
        else if (border) void visits.whyFired(border, pointOf(last));
        else go(last);
      },
    });
  });
  /** The visit at the pointer, at a time in seconds. */
  const visitAt = ({ clientY }: MouseEvent, time: number): Segment | null => {
    const lane = drawing && laneAt(drawing, clientY - area.getBoundingClientRect().top);
    return lane && segmentAt(lane, time);
  };
  /** The visit whose beginning is at the pointer, if a transition led to it and there is room to aim at it. */
  const borderAt = (event: PointerEvent): Segment | null => {
    if (!drawing) return null;
    const { span, width } = drawing;
    const near = (reachOf(event, NEAR) / width) * (span.to - span.from); // s
    const time = timeAt(event.clientX);
    const visit = visitAt(event, time + near);
    if (!visit?.by || Math.abs(visit.begin - time) > near) return null;
    return Math.min(visit.end, now()) - visit.begin > 3 * near ? visit : null;
  };
  area.addEventListener("contextmenu", (event) => {
    const time = Math.min(now(), timeAt(event.clientX));
    const visit = isAtName(event) ? null : visitAt(event, time);
    if (!visit) return;
    consume(event);
    const at = pointOf(event);
    visits.open(at, [visit], time, `Visit of ${visits.nameOf(visit)}`);
  });
  area.addEventListener(
    "wheel",
    (event) => {
      if (event.ctrlKey || event.metaKey) zoom(Math.exp(event.deltaY * 0.002), timeAt(event.clientX));
      else if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
        shown.pan((event.deltaX || event.deltaY) / (drawing?.width ?? 1));
        redraw();
      } else return;
      event.preventDefault();
    },
    { passive: false },
  );
  body.addEventListener("scroll", () => {
    const { scrollTop, clientHeight } = body;
    area.style.setProperty("--lrp-scrolled", `${scrollTop}px`);
    if (!drawing || scrollTop < drawing.sight.top || scrollTop + clientHeight > drawing.sight.bottom)
      redraw();
  });
  playhead.addEventListener("keydown", (event) => {
    const { looking: moment, tick: present } = store.state;
    const { wanted } = looking;
    const tick = (wanted && "tick" in wanted ? wanted.tick : moment?.tick) ?? present;
    const by = event.shiftKey ? STEPS : 1;
    const { key } = event;
    if (key === "ArrowLeft" || key === "ArrowDown") step(tick - by);
    else if (key === "ArrowRight" || key === "ArrowUp") step(tick + by);
    else if (key === "PageUp" || key === "PageDown")
      step(
        happened.changeFrom(tick, key === "PageUp") ?? (key === "PageUp" ? Number.POSITIVE_INFINITY : tick),
      );
    else if (key === "Home") step(happened.first);
    else if (key === "End" || key === "Escape") returnToNow();
    else if (key === "+" || key === "=") zoom(0.5);
    else if (key === "-") zoom(2);
    else if (key === "Enter" || key === "?") whyMenu();
    else return;
    consume(event);
  });
  const step = (tick: number) => {
    if (tick > (isPast() ? happened.last : store.state.tick)) {
      if (isPast()) returnToNow();
    } else void look({ tick: Math.max(happened.first, tick) });
  };
  /** Ask about the states that are active at the playhead. */
  const whyMenu = () => {
    const time = store.state.looking?.time ?? now();
    const { left, top } = playhead.getBoundingClientRect();
    const active = happened.lanes().flatMap((lane) => segmentAt(lane, time) ?? []);
    if (active.length) visits.open({ x: left, y: top }, active, time, "States at this moment");
  };
  const plotMenu = () => {
    const { left, top } = more.getBoundingClientRect();
    const items = [...new Set([...plots, ...happened.names])].map((name) =>
      item(
        name,
        `plot-${name}`,
        () => choose(plots.includes(name) ? plots.filter((each) => each !== name) : [...plots, name]),
        { checked: plots.includes(name) },
      ),
    );
    const none = item("No numeric values to plot yet", "plot-none", () => {}, { disabled: true });
    openMenu(lab.root, { x: left, y: top }, items.length ? items : [none], "Plots");
  };
  const choose = (names: string[]) => store.set("plots", names);

  /* ---------------------------------------------------------------- what changes it */

  store.watch(["settings", "looking"], () => {
    const { settings, looking: moment } = store.state;
    const { quiet } = settings;
    if (quiet && !body.hidden) open(false);
    else if (!quiet && opener.hidden) open(isOn(OPEN, lab.root.clientWidth > NARROW));
    setHidden(opener, quiet);
    setHidden(title, quiet);
    setHidden(element, quiet && !moment); // a run of a check is shown, and the way back from it
  });
  store.watch(["snapshot"], () => {
    happened = new Happened();
    const names: unknown = JSON.parse(kept(PLOTS + store.state.name) ?? "[]");
    plots = Array.isArray(names) ? names.filter((name) => typeof name === "string") : [];
    store.set("plots", plots);
  });
  store.watch(["plots"], () => {
    if (plots === store.state.plots) return;
    plots = store.state.plots;
    keep(PLOTS + store.state.name, JSON.stringify(plots));
    if (body.hidden) open(true, true);
    redraw();
    askNow();
  });
  store.watch(["snapshot", "revision", "issues", "status", "active", "entered", "fired"], (changed) => {
    if (changed.has("revision") && !changed.has("snapshot")) edited = performance.now();
    askNow();
  });
  store.watch(["tick", "looking"], () => {
    const { looking: moment, bridge } = store.state;
    if (!moment || bridge.hardware) ask(); // a simulation stands still while its past is shown
  });
  store.watch(["looking"], () => {
    shown.hold();
    const { from, to } = shown.span;
    if (drawing?.span.from === from && drawing.span.to === to) point();
    else redraw();
  });
  store.watch(["whatIf"], () => {
    shown.makeRoom();
    redraw();
  });
  store.watch(["program"], () => {
    styleOf = trailStyles(store.state.program, TRAIL_COLORS);
    redraw();
  });
  new ResizeObserver(() => {
    if (body.hasAttribute("data-new") && !opener.hidden && lab.root.clientWidth) {
      body.removeAttribute("data-new");
      open(isOn(OPEN, lab.root.clientWidth > NARROW));
    }
    redraw();
  }).observe(element);
  body.setAttribute("data-new", "");
  open(false);
  looking.moved = point;
  return element;
}
