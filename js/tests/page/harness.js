/**
 * A fake kernel: it plays a recording, and answers the page's requests as far as the page can be viewed
 * with it. `?theme=dark&view=graph&case=issues` choose what is shown; `window.sent` holds the messages.
 */

import lab from "../../../lrp_jupyter/static/lab.js";

const options = new URLSearchParams(location.search);
document.body.className = options.get("theme") ?? "light";
const recording = await (await fetch(options.get("recording") ?? "./recording.json")).json();
const listeners = new Set();
window.sent = [];
let view = "";
let revision = 1;
let text = "";
let number = 1;
let credit = 3;
let answers = 0;
let playing = options.get("case") !== "paused";
let at = 0;
const state = {
  settings: { hold: options.get("case") === "hold", on_active_edit: "restart", pause_on_issue: false },
};

const deliver = (message, buffers = []) => {
  for (const listener of listeners) listener({ json: JSON.stringify({ view, ...message }) }, buffers);
};
const bytes = (text) => new DataView(Uint8Array.from(atob(text), (char) => char.charCodeAt(0)).buffer);
const frame = (fields = {}) => deliver({ type: "frame", frame: ++number, ...fields });
const range = (line, column, end_column) => ({ line, column, end_line: line, end_column });

/** Some runs of the follower: as recorded, with a difference, one that is run again, one with a real robot. */
function keptRuns() {
  const names = ["oval", "from the wall", "bump at the end", "second lap", "turtlebot in the corridor"];
  const states = [
    "moving",
    "looking",
    "moving",
    "looking",
    "bumpback",
    "bumpturn",
    "looking",
    "moving",
    "end",
  ];
  const course = (scale, count) =>
    states.slice(0, count).map((name, index) => [scale * index * (index + 2), `follower/${name}`]);
  const run = (fields) => ({
    expected: "as recorded",
    seconds: 63.2,
    state: "passed",
    reason: "",
    differs: null,
    open_loop: "",
    lane: "follower",
    recorded: course(0.7, 9),
    now: course(0.7, 9),
    issues: 0,
    ...fields,
  });
  const other = [12.3, "`looking` is not entered; in the original run it is."];
  const kept_runs = {
    [names[0]]: run(),
    [names[1]]: run({
      state: "failed",
      reason: `differs at 12.3 s: ${other[1]}`,
      differs: other,
      now: [...course(0.7, 3), [12.3, "follower/bumpback"], [13.3, "follower/bumpturn"], [16.4, ""]],
      issues: 1,
    }),
    [names[2]]: run({ expected: "reaches follower/end within 60 s, never touches", seconds: 41 }),
    [names[3]]: run({ state: "waiting", seconds: 0, recorded: [], now: [] }),
    [names[4]]: run({
      state: "failed",
      expected: "never enters follower/bumpback",
      reason: "`follower/bumpback` is entered at 16.8 s.",
      differs: [5.6, "`looking` is entered; in the original run it is not."],
      open_loop:
        "A real robot was recorded: from the first difference on, its readings are those of the recorded drive, not what the robot would have read with this program.",
      now: course(0.6, 6),
    }),
  };
  const coverage = {
    states: { "follower/moving": [0, 1, 2, 3, 4], "follower/looking": [0, 1, 2], "follower/bumpback": [4] },
    transitions: { "follower/tlooking": [0, 1, 2], "follower/tmoving": [0, 1], "follower/tbump": [4] },
    conditions: { "follower/tmoving": "never false", "follower/tend": "never true" },
    words:
      "Reached: 3 of 9 states, 3 of 10 transitions, both outcomes of 0 of 2 conditions. Never entered: `follower/end`.",
  };
  const runs = { folder: "follower.runs", attached: ["../accidents"], names, coverage };
  return { runs: { ...runs, expected: "reaches follower/end", keeps: "", error: "" }, kept_runs };
}

/** What a search for the smallest change has found. */
function foundChanges() {
  const changes = [
    ["`lightlim` 121 instead of 128 (line 7) passes in 19 of 20 runs (now 3).", 7],
    ["Swapping `tlost` and `tend` (lines 28 and 29) passes in 18 of 20 runs (now 3).", 28],
  ].map(([sentence, line]) => ({ sentence, line }));
  const answer = "Changing `maxlook` does not help.";
  return { busy: false, made: 120, planned: 120, changes, answer, stale: false, error: "" };
}

const cases = {
  issues: {
    issues: {
      1: {
        id: 1,
        code: "LRP601",
        severity: "error",
        kind: "exception",
        element: "state `follower/moving`",
        message: "`moving.running` raised `ZeroDivisionError: division by zero`.",
        revision: 1,
        finding: "",
        range: range(27, 15, 40),
        traceback:
          'Traceback (most recent call last):\n  File "<lrp follower>", line 27, in moving.running\n    robot.move(linear=1/0)\nZeroDivisionError: division by zero',
        first_tick: 12,
        last_tick: 95,
        count: 83,
        resolved: false,
      },
      2: {
        id: 2,
        code: "LRP604",
        severity: "warning",
        kind: "unknown state",
        element: "transition `follower:tlost`",
        message: "The machine `follower` has no state `lost`.",
        revision: 1,
        finding: "",
        range: range(28, 3, 20),
        traceback: "",
        first_tick: 3,
        last_tick: 3,
        count: 1,
        resolved: true,
      },
    },
    restarts: { 1: { tick: 118, reason: "`moving` is active and its `running` changed." } },
    printed: { 0: "light 212", 1: "light 180", 2: "on the line" },
  },
  runs: { ...keptRuns(), search: foundChanges() },
  busy: {},
  hold: { settings: state.settings },
};

/** The text after changes, in CodeMirror's JSON form. */
function changed(before, changes) {
  let at = 0;
  return changes
    .map((section) => {
      const [length, ...lines] = Array.isArray(section) ? section : [section];
      at += length;
      return Array.isArray(section) ? lines.join("\n") : before.slice(at - length, at);
    })
    .join("");
}

function answer(message) {
  text = message.updates.reduce(changed, text);
  revision += message.updates.length;
  const lines = text.split("\n");
  const open = (text.match(/\(/g) ?? []).length !== (text.match(/\)/g) ?? []).length;
  const typo = lines.findIndex((line) => line.includes("lightlin "));
  const findings = [];
  if (open)
    findings.push({
      id: "open",
      code: "LRP101",
      severity: "error",
      message: "This machine is not closed. Put its `)` at the end of line 30.",
      range: range(lines.length, 1, 2),
      fix: null,
    });
  if (typo >= 0) {
    const column = lines[typo].indexOf("lightlin") + 1;
    const place = range(typo + 1, column, column + 8);
    findings.push({
      id: "typo",
      code: "LRP501",
      severity: "error",
      message: "`lightlin` is not defined where this block can see it. Did you mean `lightlim`?",
      range: place,
      fix: { title: "Write `lightlim`", edits: [{ range: place, text: "lightlim" }] },
    });
  }
  deliver({
    type: "answer",
    number: ++answers,
    seq: message.seq,
    revision,
    updates: message.updates.map((changes) => ({ view, changes })),
    findings,
    accepted: !open,
    applied: !open,
    reason: "",
    half_typed: false,
    running: null,
    pending: state.settings.hold
      ? { added: ["state `follower/lost`"], removed: [], changed: ["event `follower/bumping`"], moved: [] }
      : null,
  });
}

function command(message) {
  let error = null;
  if (message.do === "pause" || message.do === "stop") {
    playing = false;
    frame({ status: "paused" });
  } else if (message.do === "run") {
    playing = true;
    frame({ status: "running" });
  } else if (message.do === "step") play();
  else if (message.do === "hold") {
    state.settings = { ...state.settings, hold: message.on };
    frame({ settings: state.settings });
  } else if (message.do === "on_active_edit") {
    state.settings = { ...state.settings, on_active_edit: message.name };
    frame({ settings: state.settings });
  } else if (message.do === "set_variable") {
    const value = Number(message.expression);
    if (Number.isNaN(value)) error = `NameError: name '${message.expression}' is not defined`;
    else frame({ variables: { [message.path]: [message.expression, value] } });
  } else if (message.do === "expect")
    error = `\`${message.expected}\` is not something that can be expected of a run.`;
  else if (message.do === "pin") {
    const layouts = structuredClone(recording.snapshot.frame.layouts);
    const shape = layouts[message.path].states.find(({ name }) => name === message.name);
    if (shape) [shape.x, shape.y] = [message.x, message.y];
    frame({ layouts: { [message.path]: layouts[message.path] } });
  }
  if (message.id) setTimeout(() => deliver({ type: "reply", id: message.id, error }), 5);
}

function request(message) {
  const replies = {
    complete: {
      options: [
        { label: "math", kind: "module", detail: "module", info: "" },
        { label: "random", kind: "module", detail: "", info: "" },
      ],
    },
    hover: { hover: { title: message.chain, type: "builtin", value: "", doc: "From the notebook." } },
    references: {
      references: {
        kind: "state",
        path: "follower/moving",
        name: "moving",
        definition: range(26, 10, 16),
        references: [range(26, 10, 16), range(28, 17, 23)],
      },
    },
    inspect: {
      inspect: {
        title: message.path,
        type: "State",
        text: message.path,
        source: "(state moving\n  (running [robot.move(linear=forward)]))",
        facets: [
          { step: "onentry", label: "onentry", type: "tuple", text: "()", deep: false },
          { step: "running", label: "running", type: "tuple", text: "(Block(…),)", deep: true },
          { step: "visits", label: "entered", type: "int", text: "14", deep: false },
        ],
        more: 0,
      },
    },
  };
  setTimeout(() => deliver({ type: "reply", id: message.id, error: null, ...replies[message.type] }), 5);
}

function play() {
  const next = recording.frames[at++ % recording.frames.length];
  if (credit < 1) return;
  credit -= 1;
  deliver({ type: "frame", ...next.frame, frame: ++number, asks: true, view }, [bytes(next.poses)]);
}

const model = {
  get: (name) => ({ view: options.get("view") ?? "lab" })[name],
  on: (event, callback) => event === "msg:custom" && listeners.add(callback),
  off: (_, callback) => listeners.delete(callback),
  send({ json }) {
    const message = JSON.parse(json);
    window.sent.push(message);
    view ||= message.view;
    if (options.get("case") === "lost") {
      if (window.sent.length > 1) return;
    }
    if (message.type === "hello") {
      const snapshot = structuredClone(recording.snapshot);
      snapshot.frame.view = view;
      Object.assign(snapshot.frame, cases[options.get("case")] ?? {});
      snapshot.frame.restarts = {};
      if (options.get("case") === "empty") Object.assign(snapshot, { text: "", running: "" });
      if (options.get("case") === "empty")
        Object.assign(snapshot.frame, { program: { variables: [], events: [], machines: [] }, layouts: {} });
      text = snapshot.text;
      setTimeout(() => {
        deliver(snapshot);
        const more = cases[options.get("case")];
        if (more?.restarts) setTimeout(() => frame({ restarts: more.restarts }), 200);
      }, 10);
    } else if (message.type === "credit") credit++;
    else if (options.get("case") === "busy") return;
    else if (message.type === "text") setTimeout(() => answer(message), 20);
    else if (message.type === "command") command(message);
    else if (message.id) request(message);
  },
};

window.close = lab.render({ model, el: document.getElementById("host") });
if (options.get("case") !== "lost") {
  setInterval(() => {
    if (playing && view) play();
    else if (view) frame();
  }, 100);
}
