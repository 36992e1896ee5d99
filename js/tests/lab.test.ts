// @vitest-environment happy-dom

import { undo } from "@codemirror/commands";
import { forEachDiagnostic, nextDiagnostic } from "@codemirror/lint";
import { activateHover } from "@codemirror/view";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { handsIn } from "../src/editor/hands";
import { WORD_AFTER } from "../src/editor/typing";
import { LOST_AFTER } from "../src/session/connection";
import { lostTexts } from "../src/session/lost";
import { Stage } from "../src/world/stage";
import { ANSWER, Page } from "./opened";
import recording from "./page/recording.json";

let page: Page;
beforeEach(async () => {
  vi.useFakeTimers({ toFake: ["setTimeout", "clearTimeout", "setInterval", "clearInterval", "performance"] });
  localStorage.clear();
  sessionStorage.clear();
  page = await new Page().begin();
});
afterEach(() => {
  page.close();
  page.host.remove();
  vi.useRealTimers();
});

describe("the editor", () => {
  it("takes the program of a cell that is pasted, without its first line", async () => {
    for (const [pasted, taken] of [
      ["%%lrp m --world line\n(machine m)", "(machine m)"],
      ["; %%lrp m\n(machine m)", "; %%lrp m\n(machine m)"],
    ]) {
      const clipboardData = new DataTransfer();
      clipboardData.setData("text/plain", pasted!);
      page.editor.dispatch({ selection: { anchor: 0, head: page.editor.state.doc.length } });
      page.editor.contentDOM.dispatchEvent(new ClipboardEvent("paste", { clipboardData, cancelable: true }));
      expect(page.editor.state.doc.toString()).toBe(taken);
    }
  });

  it("shows the session's text and sends what is typed", () => {
    const { text, revision } = recording.snapshot;
    expect(page.editor.state.doc.toString()).toBe(text);
    page.type("; x\n");
    expect(page.of("text")).toMatchObject([
      { seq: 1, base: revision, updates: [[[0, "; x", ""], text.length]] },
    ]);
  });

  it("never sends back a text that came from elsewhere", async () => {
    page.hears("(machine other)");
    expect(page.editor.state.doc.toString()).toBe("(machine other)");
    expect(page.of("text")).toEqual([]);
  });

  it("keeps what is typed while another's text comes in", () => {
    page.type("; mine\n");
    page.hears("(machine other)");
    page.type("m", 3);
    expect(page.editor.state.doc.toString()).toBe("; mmine\n(machine other)");
  });

  it("undoes only what was typed in it", () => {
    page.type("; mine\n");
    page.confirm();
    page.hears("; mine\n(machine other)");
    undo(page.editor);
    expect(page.editor.state.doc.toString()).toBe("(machine other)");
    page.confirm();
    expect(page.kernel.text.toString()).toBe("(machine other)");
  });

  it("undoes and redoes what was typed from wherever the focus is, but in fields", async () => {
    const text = () => page.editor.state.doc.toString();
    const press = (selector: string, key: string, shiftKey = false) => {
      const event = new KeyboardEvent("keydown", {
        key,
        ctrlKey: true,
        shiftKey,
        bubbles: true,
        cancelable: true,
      });
      page.find(selector).dispatchEvent(event);
    };
    const before = text();
    page.type("; mine\n");
    for (const place of ["[data-lrp-state]", ".lrp-playhead", ".lrp-variable-name", ".lrp-canvas"]) {
      for (const [key, shift] of [["y"], ["Z", true]] as const) {
        press(place, "z");
        expect(text()).toBe(before);
        press(place, key, shift);
        expect(text()).toBe(`; mine\n${before}`);
      }
    }
    press("input.lrp-input", "z");
    expect(text()).toBe(`; mine\n${before}`);
    page.find('[data-lrp-action="edit-world"]').click();
    press(".lrp-canvas", "z");
    expect(text()).toBe(`; mine\n${before}`);
  });

  it("types at every cursor, which it sends, and the other ones are drawn", async () => {
    const name = "moving";
    const text = page.editor.state.doc.toString();
    const from = text.indexOf(`(state ${name}`) + "(state ".length;
    page.editor.dispatch({ selection: { anchor: from, head: from + name.length } });
    const press = (key: string) =>
      page.editor.contentDOM.dispatchEvent(
        new KeyboardEvent("keydown", { key, ctrlKey: true, bubbles: true, cancelable: true }),
      );
    press("d");
    press("d");
    const heads = page.editor.state.selection.ranges.map(({ head }) => head);
    expect(heads).toHaveLength(3);
    page.editor.dispatch(page.editor.state.replaceSelection("go"), { userEvent: "input.type" });
    expect(page.editor.state.doc.toString().match(/\bgo\b/g)).toHaveLength(3);
    const { selection, cursors } = page.of("text").at(-1)!;
    const now = page.editor.state.selection;
    expect(selection).toEqual([now.main.anchor, now.main.head]);
    expect([...cursors!, now.main.head].sort((a, b) => a - b)).toEqual(now.ranges.map(({ head }) => head));
  });

  it("closes the card over the text when the text changes", async () => {
    activateHover(page.editor, page.editor.state.doc.toString().indexOf("(machine") + 1, 1);
    await vi.waitFor(() => expect(page.host.querySelector(".cm-tooltip .lrp-card")).not.toBe(null));
    page.type("; mine\n");
    expect(page.host.querySelector(".lrp-card")).toBe(null);
  });

  it("sends what is typed meanwhile in one text when the first one is answered", () => {
    for (const letter of "abc") page.type(letter);
    expect(page.of("text")).toHaveLength(1);
    page.confirm();
    expect(page.of("text").map(({ updates }) => updates.length)).toEqual([1, 2]);
    page.confirm();
    expect(page.of("text")).toHaveLength(2);
    expect(page.kernel.text.toString()).toBe(page.editor.state.doc.toString());
  });

  it("takes answers in their order, and each once", () => {
    page.hears("1");
    const [first, second] = ["12", "123"].map((text) => page.answer(page.elsewhere(text), { seq: 0 }));
    page.deliver(second!);
    expect(page.editor.state.doc.toString()).toBe("1");
    page.deliver(first!);
    expect(page.editor.state.doc.toString()).toBe("123");
    for (const answer of [first, second]) page.deliver(answer!);
    expect(page.editor.state.doc.toString()).toBe("123");
  });

  it("merges what it typed while it had no connection", () => {
    page.hears("(machine m)");
    page.type(";a\n");
    page.type("b", 2);
    const known = page.kernel.revision;
    const updates = [...page.elsewhere("(machine m (state a))", "other")];
    page.deliver({ ...structuredClone(recording.snapshot), ...page.snapshot(updates, 1) });
    expect(page.editor.state.doc.toString()).toBe(";ab\n(machine m (state a))");
    expect(page.of("text").at(-1)).toMatchObject({ seq: 2, base: known + 1 });
    expect(page.of("text").at(-1)?.updates).toHaveLength(2);
    page.kernel.seq = 1; // the first one never arrived
    page.confirm();
    expect(page.kernel.text.toString()).toBe(page.editor.state.doc.toString());
  });

  it("waits for a text that is on its way still", () => {
    page.type("a");
    page.deliver({ ...structuredClone(recording.snapshot), ...page.snapshot([], 0) });
    page.type("b");
    expect(page.of("text")).toHaveLength(1);
    page.confirm();
    expect(page.of("text")).toHaveLength(2);
  });

  it("gives what cannot be merged to the kernel, which asks", async () => {
    page.type("; mine\n");
    const text = `; mine\n${recording.snapshot.text}`;
    page.open({
      text: "(machine other)",
      revision: 900,
      seq: 1,
      document: "another",
      home: "/home",
      tab_only: false,
    });
    expect(page.editor.state.doc.toString()).toBe("(machine other)");
    expect(page.commands("recover")).toMatchObject([{ text }]);
    page.deliver({ type: "reply", id: page.commands("recover")[0]!.id, error: null });
    await page.drawn();
    expect(lostTexts({ home: "/home", tab_only: false }).size).toBe(0);
  });

  it("shows where other hands are, in the text that both know, and moves them with it", async () => {
    page.hears("(machine m)");
    const other = async (at: number | null, revision = page.kernel.revision) => {
      const hand = (place: number | null) => ({
        revision,
        selection: place === null ? null : [place, place],
      });
      page.deliver({ type: "frame", frame: 9, hands: { [page.view]: hand(null), other: hand(at) } });
      await page.drawn();
      return handsIn(page.editor.state).map(({ head }) => head);
    };
    expect(await other(4)).toEqual([4]);
    page.type("; x\n");
    expect(await other(10)).toEqual([14]);
    expect(await other(5, page.kernel.revision + 1)).toEqual([14]); // of a text that did not come yet
    page.deliver(page.answer([...page.merge(), ...page.elsewhere("; x\n(machine mm)", "other")]));
    expect(handsIn(page.editor.state).map(({ head }) => head)).toEqual([15]);
    expect(await other(5)).toEqual([5]);
    expect(await other(null)).toEqual([]);
  });

  it("sends where its cursor is only if another view has an editor, too", async () => {
    const last = () => page.of("cursor").at(-1);
    const move = async (anchor: number) => {
      page.editor.dispatch({ selection: { anchor } });
      await vi.waitUntil(() => last()?.selection?.[0] === anchor, { timeout: 500 }).catch(() => {});
    };
    await move(3);
    expect(last()).toBe(undefined);
    const hand = { revision: 1, selection: null };
    page.deliver({ type: "frame", frame: 9, hands: { [page.view]: hand, other: hand } });
    await move(4);
    expect(last()).toMatchObject({ selection: [4, 4], revision: 1, seq: 0 });
    page.type("x", 0);
    await move(20);
    expect(last()).toMatchObject({ selection: [4, 4] }); // the text that is on its way comes first
    page.confirm();
    expect(last()).toMatchObject({ selection: [20, 20], revision: 2, seq: 1 });
  });

  it("underlines a finding at its present place, not where it was found", async () => {
    page.type("a");
    page.type("\n\n", 0);
    const range = { line: 1, column: 1, end_line: 1, end_column: 2 };
    page.kernel.number += 1;
    const [first] = page.of("text");
    page.deliver({
      ...ANSWER,
      ...{ number: 1, seq: 1, revision: 2, updates: [{ view: page.view, changes: first!.updates[0]! }] },
      findings: [
        { id: "1", code: "LRP101", severity: "error", message: "`a`", range, fix: null, creates: null },
      ],
    });
    await page.drawn();
    expect(page.find(".cm-lintRange-error").textContent).toBe("a");
    expect(page.editor.state.doc.lineAt(2).number).toBe(3);
  });

  it("keeps the card of a finding open while answers find the same, and its fix is for the text as it is", async () => {
    const found = (line: number) => {
      const range = { line, column: 2, end_line: line, end_column: 3 };
      const fix = { title: "Say it", edits: [{ range, text: "said" }] };
      const severity = "error" as const;
      return { id: "1", code: "LRP303", severity, message: "The first.", range, fix, creates: null };
    };
    page.deliver({ ...structuredClone(recording.snapshot), updates: [], findings: [found(1)] });
    await page.drawn();
    page.type("; above\n");
    page.confirm({ findings: [found(2)] });
    await page.drawn();
    expect(nextDiagnostic(page.editor)).toBe(true);
    page.hears(page.editor.state.doc.toString(), { findings: [found(2)] });
    await page.drawn();
    page.find(".cm-diagnosticAction").dispatchEvent(new MouseEvent("mousedown", { bubbles: true }));
    expect(page.editor.state.doc.line(2).text).toMatch(/^;saidFollows/);
    page.confirm({ findings: [] });
    await page.drawn();
    expect(page.host.querySelector(".cm-diagnosticAction, .cm-lintRange")).toBeNull();
  });

  it("has one mark for a finding and for the issue that is the same, with their count", async () => {
    const range = { line: 1, column: 2, end_line: 1, end_column: 3 };
    const severity = "error" as const;
    const finding = {
      id: "1",
      code: "LRP301",
      severity,
      message: "None here.",
      range,
      fix: null,
      creates: null,
    };
    const told = {
      id: 1,
      code: "LRP603",
      severity,
      kind: "unknown event",
      element: "",
      message: "None.",
      range,
    };
    const times = { traceback: "", first_tick: 1, last_tick: 7, count: 7, resolved: false };
    const issues = {
      1: { ...told, ...times, finding: "1", instances: [] },
      2: { ...told, ...times, id: 2, finding: "", instances: ["m/left/follow"] },
    };
    const snapshot = structuredClone(recording.snapshot);
    page.deliver({ ...snapshot, updates: [], findings: [finding], frame: { ...snapshot.frame, issues } });
    await page.drawn();
    const shown: (string | null | undefined)[] = [];
    forEachDiagnostic(page.editor.state, ({ renderMessage }) =>
      shown.push(renderMessage?.(page.editor).textContent),
    );
    expect(shown).toEqual(["None here. LRP301 7×", "None. LRP603 7× in m/left/follow"]);
  });

  it("sends what is typed in another text that was opened since, where nothing was or is marked", async () => {
    page.type("; above\n");
    page.confirm();
    await page.drawn();
    page.open({ document: "another", text: "(machine m)" });
    const before = page.of("text").length;
    page.type("; short\n");
    expect(page.of("text").length).toBe(before + 1);
  });

  it("sends what is meant with the cursor where it is now, also in a shorter text from elsewhere", () => {
    const end = page.editor.state.doc.length;
    page.editor.dispatch({ selection: { anchor: end } });
    page.editor.dispatch({ ...page.editor.state.replaceSelection("(sta"), userEvent: "input.type" });
    page.confirm({ half_typed: true });
    page.hears("(machine m)", { half_typed: true });
    vi.advanceTimersByTime(WORD_AFTER);
    expect(page.of("cursor").at(-1)).toMatchObject({ selection: [11, 11], meant: true });
  });

  it("underlines a finding of a snapshot that comes while a text is on its way", async () => {
    page.type("\n\n");
    const range = { line: 1, column: 1, end_line: 1, end_column: 3 };
    const finding = {
      id: "1",
      code: "LRP101",
      severity: "error",
      message: "",
      range,
      fix: null,
      creates: null,
    };
    page.deliver({ ...structuredClone(recording.snapshot), updates: [], findings: [finding] });
    await page.drawn();
    expect(page.find(".cm-lintRange-error").textContent).toBe(recording.snapshot.text.slice(0, 2));
  });
});

describe("a page of any notebook", () => {
  it("has an editor that knows the tree it is in, also where it is rendered before it is attached", () => {
    const sizes: (() => void)[] = [];
    vi.stubGlobal(
      "ResizeObserver",
      class {
        constructor(callback: () => void) {
          sizes.push(callback);
        }
        observe() {}
        disconnect() {}
      },
    );
    const late = new Page("editor", false);
    late.attach();
    for (const changed of sizes) changed();
    vi.unstubAllGlobals();
    for (const { editor, host } of [page, late]) expect(editor.root).toBe(host.getRootNode());
    late.close();
  });

  it("is dark where what is around it is dark", () => {
    document.body.style.backgroundColor = "rgb(20, 20, 20)";
    const dark = new Page();
    document.body.style.backgroundColor = "";
    expect([page, dark].map((each) => each.find(".lrp-lab").dataset.theme)).toEqual(["light", "dark"]);
    dark.close();
  });

  it("shows the poses of a frame, whatever brings the bytes", async () => {
    const { frame, poses } = recording.frames[0]!;
    const bytes = Uint8Array.from(`?${atob(poses)}`, (letter) => letter.charCodeAt(0));
    page.deliver(frame, [bytes.subarray(1)]);
    const { getFloat64 } = DataView.prototype;
    const time = getFloat64.call(new DataView(bytes.buffer, 1), 0, true);
    await page.drawn();
    expect(page.find(".lrp-world-time").textContent).toContain(`${time.toFixed(1)} s`);
    page.deliver({ ...frame, time: time + 7 }); // nothing moves
    await page.drawn();
    expect(page.find(".lrp-world-time").textContent).toContain(`${(time + 7).toFixed(1)} s`);
  });

  it("keeps a menu open while it is pressed, and closes it when something else is", () => {
    const press = (element: Element) =>
      element.dispatchEvent(new Event("pointerdown", { bubbles: true, composed: true }));
    page.find('[data-lrp-action="menu"]').click();
    press(page.find('[role="menu"] button'));
    const menu = page.find('[role="menu"]');
    press(page.find(".lrp-graph"));
    expect(menu.isConnected).toBe(false);
  });

  it("reports changes of what runs, the last one too, now and then, and only where that is waited for", async () => {
    const frames = async (tick: number) => {
      for (const lit of [["follower/end"], ["follower/moving"]]) {
        page.deliver({ type: "frame", frame: ++tick, tick, active: lit, lit });
        await page.drawn();
      }
      page.deliver({ type: "frame", frame: ++tick, tick, time: tick });
      await page.drawn();
    };
    await frames(100);
    expect(page.saved).toBe(0);
    page.traits.reports = true;
    await frames(200);
    expect(page.saved).toBe(1);
    await vi.advanceTimersByTimeAsync(250);
    expect(page.saved).toBe(2);
    await vi.advanceTimersByTimeAsync(1000);
    page.deliver({ type: "frame", frame: 299, tick: 299, time: 299 });
    await page.drawn();
    expect(page.saved).toBe(2);
    expect(page.traits.reported).toBeGreaterThan(0);
    await frames(300);
    page.close();
    await vi.advanceTimersByTimeAsync(1000);
    expect(page.saved).toBe(3);
  });

  it("says that no program runs once the kernel has ended", async () => {
    page.end();
    await page.drawn();
    expect(page.find(".lrp-lab").dataset.lrpStatus).toBe("dead");
  });
});

describe("the page", () => {
  it("has the names that tests and themes use", () => {
    for (const part of ["controls", "editor", "tree", "graph", "variables", "issues", "world"])
      page.find(`[data-lrp="${part}"]`);
    for (const act of ["pause", "step", "reset", "stop"]) page.find(`[data-lrp-action="${act}"]`);
    page.find('[data-lrp-state="follower/looking"]');
    page.find('[data-lrp-transition="follower:tlooking"]');
    page.find('[data-lrp-machine="follower/looking/lookalgo"]');
    page.find('[data-lrp-variable="lightlim"]');
    expect(page.find('[data-lrp="lab"]').dataset.lrpStatus).toBe("running");
    expect(page.find('[data-lrp="lab"]').dataset.lrpRevision).toBe("1");
  });

  it("counts ticks and marks the active state", async () => {
    page.deliver({ type: "frame", frame: 9, tick: 1234, lit: ["follower/end"], active: ["follower/end"] });
    await page.drawn();
    expect(page.find('[data-lrp="lab"]').dataset.lrpTick).toBe("1234");
    expect(page.find('[data-lrp-state="follower/end"]').hasAttribute("data-active")).toBe(true);
  });

  it("shows nothing of the run by itself in a quiet lab with a static graph", async () => {
    page.hears(
      "(var lightlim := [1]) (machine follower (state moving) (on intheline moving -> moving tlooking))",
    );
    const run = { tick: 9, lit: ["follower/moving"], active: ["follower/moving"] };
    const fired = { "follower:tlooking": [3, 9] };
    const variables = { lightlim: ["5", 5] };
    page.deliver({ type: "frame", frame: 9, ...run, fired, variables });
    await page.drawn();
    const alive = () =>
      [
        ".cm-line.lrp-line-active",
        ".lrp-text-fired",
        ".lrp-inline-value",
        ".lrp-tree-item[data-active]",
        ".lrp-graph [data-active]",
        ".lrp-graph [data-fired]",
      ].filter((selector) => page.host.querySelector(selector));
    const shown = () =>
      ["timeline", "variables", "graph", "tree"].filter(
        (part) => !page.find(`[data-lrp="${part}"]`).matches("[hidden], [data-withheld]"),
      );
    expect(alive()).toHaveLength(6);
    expect(shown()).toHaveLength(4);
    page.deliver({ type: "frame", frame: 10, settings: { quiet: true } });
    await page.drawn();
    expect(alive()).toEqual([".lrp-graph [data-active]", ".lrp-graph [data-fired]"]);
    expect(shown()).toEqual(["graph", "tree"]);
    page.deliver({ type: "frame", frame: 11, settings: { graph: "static" } });
    await page.drawn();
    expect(alive()).toEqual([]);
    page.deliver({ type: "frame", frame: 12, settings: { graph: "hidden" } });
    await page.drawn();
    expect(shown()).toEqual([]);
    const looking = { tick: 3, time: 0.2, ago: 0.6, edited: false }; // as Show does at a run of a check
    page.deliver({ type: "frame", frame: 12, looking });
    await page.drawn();
    expect(shown()).toEqual(["timeline"]);
    expect(page.find('[data-lrp-action="back-to-now"]').closest("[hidden]")).toBe(null);
    expect(page.find('[data-lrp-action="timeline"]').hidden).toBe(true);
    page.deliver({ type: "frame", frame: 12, looking: null });
    await page.drawn();
    expect(shown()).toEqual([]);
    page.deliver({ type: "frame", frame: 13, settings: { graph: "live", quiet: false } });
    await page.drawn();
    expect(alive()).toHaveLength(6);
    expect(shown()).toHaveLength(4);
  });

  it("draws a static graph again only on request", async () => {
    const { layouts } = recording.snapshot.frame;
    const graph = layouts.follower;
    const state = () => page.host.querySelector('[data-lrp-state="follower/new"]');
    page.deliver({ type: "frame", frame: 9, settings: { graph: "static" } });
    await page.drawn();
    const states = [...graph.states, { ...graph.states[1]!, id: "follower/new", name: "new" }];
    page.deliver({ type: "frame", frame: 10, layouts: { follower: { ...graph, states } } });
    await page.drawn();
    expect(state()).toBe(null);
    page.find('[data-lrp-action="redraw"]').click();
    expect(state()).not.toBe(null);
  });

  it("locks the switches of a study, and offers nothing that shows what it withholds", async () => {
    const items = () => {
      page.find('[data-lrp-action="menu"]').click();
      const found = [...page.host.querySelectorAll<HTMLElement>('[data-lrp-action^="panel-"]')];
      return found.map(({ dataset }) => dataset.lrpAction!.slice("panel-".length));
    };
    const switches = () =>
      ["hold", "graph-mode"].map((act) => page.find(`[data-lrp-action="${act}"]`) as HTMLButtonElement);
    page.deliver({ type: "frame", frame: 9, settings: { edits: "hold", graph: "hidden", quiet: true } });
    await page.drawn();
    expect(items()).toEqual(["editor", "graph", "world", "issues", "breakpoints"]);
    expect(page.host.querySelector('[data-lrp-action="values"]')).toBe(null);
    page.find('[data-lrp-action="panel-graph"]').click();
    expect(page.commands("graph")).toMatchObject([{ mode: "live" }]);
    expect(switches().map(({ disabled }) => disabled)).toEqual([false, false]);
    page.deliver({ type: "frame", frame: 10, settings: { lock: true } });
    await page.drawn();
    expect(items()).toEqual(["editor", "world", "issues", "breakpoints"]);
    expect(switches().map(({ disabled }) => disabled)).toEqual([true, true]);
    expect(switches()[0]!.title).toBe("This is set for a study, and cannot be changed here.");
    expect(switches()[0]!.getAttribute("aria-checked")).toBe("true");
  });

  it("reports what its user looks at only while that is recorded, and says so", async () => {
    const mark = page.find(".lrp-recorded");
    page.find('[data-lrp-action="follow"]').click(); // or what is watched may go meanwhile
    const look = () => {
      page.find('[data-lrp-action="timeline"]').click();
      const state = page.find('[data-lrp-state="follower/looking"]');
      state.dispatchEvent(new Event("pointerover", { bubbles: true }));
      vi.advanceTimersByTime(1000);
      page.find('[data-lrp-action="menu"]').click();
      page.find('[data-lrp-action="panel-world"]').click();
      page.find(".lrp-controls").dispatchEvent(new Event("pointerover", { bubbles: true }));
      state.dispatchEvent(new KeyboardEvent("keydown", { key: "?", bubbles: true }));
      page.find('[data-lrp-action="close-why"]').click();
      return page.of("looked").map(({ what, about, on }) => [what, about, on]);
    };
    expect(mark.hidden).toBe(true);
    expect(look()).toEqual([]);
    page.deliver({ type: "frame", frame: 9, settings: { log: "p.lrplog" } });
    await page.drawn();
    expect(mark.hidden).toBe(false);
    expect(mark.title).toContain("is recorded in the file p.lrplog on");
    expect(look()).toEqual([
      ["panel", "timeline", false],
      ["hover", "state follower/looking", true],
      ["panel", "world", true],
      ["hover", "state follower/looking", false],
      ["why", "state follower/looking", true],
      ["why", "state follower/looking", false],
    ]);
  });

  it("offers to run while paused, and to pause while running", async () => {
    page.find('[data-lrp-action="pause"]').click();
    page.deliver({ type: "frame", frame: 9, status: "paused" });
    await page.drawn();
    page.find('[data-lrp-action="run"]').click();
    expect(page.commands("pause").concat(page.commands("run"))).toHaveLength(2);
  });

  it("offers to start a session again that failed itself", async () => {
    expect(page.find('[data-lrp-action="start-again"]').hidden).toBe(true);
    page.deliver({ type: "frame", frame: 9, status: "broken", reason: "The session itself failed." });
    await page.drawn();
    const again = page.find('[data-lrp-action="start-again"]');
    expect(again.hidden).toBe(false);
    expect(again.closest<HTMLElement>(".lrp-note")?.hidden).toBe(false);
    again.click();
    expect(page.commands("run")).toHaveLength(1);
    page.deliver({ type: "frame", frame: 10, status: "running", reason: "" });
    await page.drawn();
    expect(again.closest<HTMLElement>(".lrp-note")?.hidden).toBe(true);
  });

  it("has no landmark that only a page may have", () => {
    expect(page.host.querySelector(".lrp-lab > :is(footer, header, main, aside)")).toBe(null);
  });

  it("shows why a command was refused", async () => {
    page.find('[data-lrp-action="reset"]').click();
    const { id } = page.commands("reset")[0]!;
    page.deliver({ type: "reply", id, error: "The session `follower` is closed." });
    await page.drawn();
    expect(page.find(".lrp-toast").innerHTML).toBe("The session <code>follower</code> is closed.");
  });

  it("lists an issue once, with its count, and finds its place", async () => {
    const issue = {
      id: 1,
      code: "LRP601",
      severity: "error",
      kind: "exception",
      element: "state `follower/moving`",
      message: "`moving.running` failed",
      finding: "",
      range: { line: 2, column: 1, end_line: 2, end_column: 5 },
      traceback: "",
      first_tick: 1,
      last_tick: 1,
      count: 1,
      resolved: false,
      instances: [] as string[],
    };
    page.deliver({ type: "frame", frame: 9, issues: { 1: issue } });
    page.deliver({ type: "frame", frame: 10, issues: { 1: { ...issue, count: 7, last_tick: 9 } } });
    await page.drawn();
    expect(page.host.querySelectorAll('[data-lrp-issue="LRP601"]')).toHaveLength(1);
    expect(page.find('[data-lrp-issue="LRP601"]').textContent).toContain("7×, ticks 1–9");
    page.find('[data-lrp-issue="LRP601"] button').click();
    expect(page.editor.state.doc.lineAt(page.editor.state.selection.main.from).number).toBe(2);
  });

  it("shows a restart with its reason and the switch to keep running, then counts it in a list", async () => {
    const notice = page.find(".lrp-notice");
    const counter = page.find(".lrp-restarts");
    expect(counter.hidden).toBe(true);
    const snapshot = structuredClone(recording.snapshot);
    Object.assign(snapshot.frame, { restarts: { 3: { tick: 2, reason: "long ago" } } });
    page.deliver(snapshot);
    await page.drawn();
    expect(notice.hidden).toBe(true);
    expect(counter.querySelector("summary")?.textContent).toBe("3 restarts");
    page.deliver({ type: "frame", frame: 10, restarts: { 4: { tick: 5, reason: "`moving` changed" } } });
    await page.drawn();
    expect(notice.hidden).toBe(false);
    expect(notice.textContent).toContain("Restarted at tick 5: moving changed");
    vi.advanceTimersByTime(10_000);
    expect(notice.hidden).toBe(true);
    expect(counter.querySelector("summary")?.textContent).toBe("4 restarts");
    expect([...counter.querySelectorAll("li")].map((item) => item.textContent)).toEqual([
      "Tick 5: moving changed",
      "Tick 2: long ago",
    ]);
  });

  it("shows the bridge in use after another one was refused", async () => {
    const select = page.find('[data-lrp-action="bridge"]') as HTMLSelectElement;
    const other = document.createElement("option");
    select.append(Object.assign(other, { value: "ros" }));
    select.value = "ros";
    select.dispatchEvent(new Event("change"));
    page.deliver({ type: "reply", id: page.commands("bridge")[0]!.id, error: "No robot answers." });
    await page.drawn();
    expect(select.value).toBe(recording.snapshot.frame.bridge.name);
  });

  it("says of a variable that what it was computed from was assigned, and recomputes it", async () => {
    const said = page.find('[data-lrp-variable="lightlim"] .lrp-variable-computed');
    const recompute = () => said.querySelector<HTMLElement>('[data-lrp-action="compute"]');
    const show = async (frame: number, outdated: { computed: string; initial: string } | null) => {
      page.deliver({ type: "frame", frame, outdated: { lightlim: outdated } });
      await page.drawn();
    };
    expect(said.hidden).toBe(true);
    await show(9, { computed: "Computed from `most` at 6.4 s.", initial: "most / 2" });
    expect([said.hidden, said.textContent]).toEqual([false, "Computed from most at 6.4 s. Recompute"]);
    recompute()!.click();
    expect(page.commands("set_variable")).toMatchObject([{ path: "lightlim", expression: "most / 2" }]);
    await show(10, { computed: "Computed from `most` at 6.4 s.", initial: "" });
    expect([said.textContent!.trim(), recompute()]).toEqual(["Computed from most at 6.4 s.", null]);
    await show(11, null);
    expect(said.hidden).toBe(true);
  });

  it("assigns a value that was typed, and nothing where none was: the text of a function would call it", async () => {
    const confirm = async (typed?: string) => {
      page.find('[data-lrp-variable="lightlim"] .lrp-value').click();
      const input = page.find('[data-lrp-variable="lightlim"] .lrp-input') as HTMLInputElement;
      if (typed !== undefined) input.value = typed;
      input.dispatchEvent(new KeyboardEvent("keydown", { key: "Enter", cancelable: true }));
      await page.drawn();
      return page.host.querySelector('[data-lrp-variable="lightlim"] .lrp-input');
    };
    page.deliver({ type: "frame", frame: 9, variables: { lightlim: ["limit()", null] } });
    await page.drawn();
    expect(await confirm()).toBe(null);
    expect(page.commands("set_variable")).toEqual([]);
    await confirm("limit");
    expect(page.commands("set_variable")).toMatchObject([{ path: "lightlim", expression: "limit" }]);
  });

  it("keeps what is selected and shown when a state is renamed", async () => {
    const inner = "follower/looking/lookalgo";
    const rename = (text: string) => text.replaceAll("looking", "searching");
    const { program, layouts } = recording.snapshot.frame;
    page
      .find('[data-lrp-transition="follower:tlooking"]')
      .dispatchEvent(new MouseEvent("click", { bubbles: true }));
    page.find(`[data-lrp-machine="${inner}"]`).click();
    await page.drawn();
    page.deliver({
      type: "frame",
      frame: 9,
      program: JSON.parse(rename(JSON.stringify(program))),
      layouts: {
        ...Object.fromEntries(Object.keys(layouts).map((path) => [path, null])),
        ...JSON.parse(rename(JSON.stringify(layouts))),
      },
      moved: {
        3: [
          { kind: "machine", old: inner, new: rename(inner) },
          { kind: "transition", old: "follower:tlooking", new: "follower:tsearching" },
        ],
      },
    });
    await page.drawn();
    expect(page.find('[data-lrp-machine][aria-selected="true"]').dataset.lrpMachine).toBe(rename(inner));
    expect(page.find(".lrp-graph").getAttribute("aria-label")).toBe("State graph of lookalgo");
    page.find('[data-lrp-machine="follower"]').click();
    await page.drawn();
    expect(page.find("g[data-chosen]").dataset.lrpTransition).toBe("follower:tsearching");
  });

  it("inspects the robot with one click", async () => {
    page.find('[data-lrp="robot"] [data-lrp-action="inspect-robot"]').click();
    await page.drawn();
    expect(page.of("inspect").at(-1)).toMatchObject({ kind: "robot", path: "" });
  });

  it("inspects the same element after a rename", async () => {
    page.find('[data-lrp-variable="lightlim"] [data-lrp-action="inspect"]').click();
    await page.drawn();
    const asked = page.of("inspect");
    expect(asked.at(-1)).toMatchObject({ kind: "variable", path: "lightlim" });
    page.deliver({ type: "reply", id: asked.at(-1)!.id, error: null });
    await page.drawn();
    page.deliver({
      type: "frame",
      frame: 9,
      moved: { 1: [{ kind: "variable", old: "lightlim", new: "limit" }] },
    });
    await page.drawn();
    expect(page.of("inspect")).toHaveLength(2);
    expect(page.of("inspect").at(-1)).toMatchObject({ kind: "variable", path: "limit" });
  });

  it("asks before a file that the lab did not write is replaced", async () => {
    page.find('[data-lrp-action="menu"]').click();
    page.find('[role="menu"] [data-lrp-action="save"]').click();
    page.find('[data-lrp-action="save-file"]').click();
    expect(page.of("save").at(-1)).toMatchObject({ name: "follower.lrp", replace: false });
    const replace = page.find('[data-lrp-action="replace-file"]');
    expect(replace.hidden).toBe(true);
    page.deliver({ type: "reply", id: page.of("save").at(-1)!.id, error: null, exists: true });
    await page.drawn();
    expect(replace.hidden).toBe(false);
    expect(page.focused).toBe(replace);
    replace.click();
    expect(page.of("save").at(-1)).toMatchObject({ name: "follower.lrp", replace: true });
    page.deliver({ type: "reply", id: page.of("save").at(-1)!.id, error: null, exists: false });
    await page.drawn();
    expect(page.find(".lrp-toast").innerHTML).toBe("Saved as <code>follower.lrp</code>.");
  });

  it("keeps the rate that was just chosen while the kernel still reports the one before", async () => {
    const slider = page.find('[data-lrp-action="rate"]') as HTMLInputElement;
    slider.focus();
    slider.value = "70";
    slider.dispatchEvent(new Event("input"));
    page.deliver({ type: "frame", frame: 9, achieved_rate: 9.5 });
    await page.drawn();
    expect(slider.value).toBe("70");
  });

  it("keeps the speed that was just chosen while the kernel still reports the one before", async () => {
    const select = page.find('[data-lrp-action="speed"]') as HTMLSelectElement;
    select.value = "5";
    select.dispatchEvent(new Event("change"));
    page.deliver({ type: "frame", frame: 9, speed: 1, achieved_speed: 0.95 });
    await page.drawn();
    expect(select.value).toBe("5");
  });

  it("shows the machine that another view of the session shows, and does not send it back", async () => {
    const other = await new Page().begin();
    const sent = vi.fn();
    document.addEventListener("lrp-together", sent);
    page.find('[data-lrp-machine="follower/looking/lookalgo"]').click();
    await page.drawn();
    await page.drawn();
    document.removeEventListener("lrp-together", sent);
    expect(other.find(".lrp-graph").getAttribute("aria-label")).toBe("State graph of lookalgo");
    const told = sent.mock.calls.filter(([event]) => event.detail.message.machine);
    expect(told).toHaveLength(1);
    other.close();
    other.host.remove();
  });

  it("goes on showing what one watches while one types elsewhere, or follows the cursor if that is wanted", async () => {
    const inner = "follower/looking/lookalgo";
    const text = page.editor.state.doc.toString();
    const click = (selector: string) => {
      page.find(selector).click();
      return page.drawn();
    };
    const shown = () => page.find('[data-lrp-machine][aria-selected="true"]').dataset.lrpMachine;
    const place = (anchor: number) => {
      page.editor.dispatch({ selection: { anchor } });
      return page.drawn();
    };
    const within = text.indexOf("(state lookleft");
    const typed = async () => {
      page.editor.dispatch({ changes: { from: within, insert: " " }, selection: { anchor: within + 1 } });
      await page.drawn();
    };
    await click('[data-lrp-machine="follower"]');
    await typed();
    expect(shown()).toBe("follower");
    const other = await new Page().begin();
    await click('[data-lrp-action="follow-cursor"]');
    await other.drawn();
    expect(shown()).toBe(inner);
    expect(other.find('[data-lrp-action="follow-cursor"]').getAttribute("aria-pressed")).toBe("true");
    other.close();
    other.host.remove();
    await place(text.indexOf("(state moving"));
    expect(shown()).toBe("follower");
    await typed();
    expect(shown()).toBe(inner);
    await click('[data-lrp-machine="follower"]');
    expect(shown()).toBe("follower"); // until the cursor moves again
    const next = await new Page().begin();
    expect(next.find('[data-lrp-action="follow-cursor"]').getAttribute("aria-pressed")).toBe("true");
    next.close();
    next.host.remove();
    await click('[data-lrp-action="follow"]');
    expect(page.find('[data-lrp-action="follow-cursor"]').getAttribute("aria-pressed")).toBe("false");
  });

  it("has the machines as a path above the graph, and a panel for them only when there are more than three", async () => {
    const { program } = recording.snapshot.frame;
    const inner = "follower/looking/lookalgo";
    const listed = (part: string) =>
      [...page.find(`[data-lrp="${part}"] [role="tree"]`).children].map(
        (each) => (each as HTMLElement).dataset.lrpMachine,
      );
    const isFolded = () => page.find('[data-lrp="tree"]').hasAttribute("data-folded");
    expect([listed("graph"), listed("tree"), isFolded()]).toEqual([["follower", inner], [], true]);
    const press = (key: string) =>
      page.focused!.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
    page.find('[data-lrp-machine="follower"]').focus();
    press("ArrowRight");
    await page.drawn();
    expect((page.focused as HTMLElement).dataset.lrpMachine).toBe(inner);
    expect(page.find(".lrp-graph").getAttribute("aria-label")).toBe("State graph of lookalgo");
    press("ArrowLeft");
    await page.drawn();
    expect(page.find('[aria-selected="true"]').dataset.lrpMachine).toBe("follower");
    const more = ["a", "b"].map((path) => ({ ...program.machines[0]!, path }));
    page.deliver({
      type: "frame",
      frame: 9,
      program: { ...program, machines: [...program.machines, ...more] },
    });
    await page.drawn();
    const all = ["follower", inner, "a", "b"];
    expect([listed("graph"), listed("tree"), isFolded()]).toEqual([[], all, false]);
  });

  it("shows the whole nest in a large panel; what is chosen of it, and what runs in it, changes nothing", async () => {
    const inner = "follower/looking/lookalgo";
    const svg = page.find(".lrp-graph");
    const resize = (width: number, height: number) => {
      Object.defineProperty(svg, "clientWidth", { value: width, configurable: true });
      Object.defineProperty(svg, "clientHeight", { value: height, configurable: true });
    };
    resize(420, 200);
    page.find('[data-lrp-action="follow"]').click();
    page.find('[data-lrp-action="zoom-fit"]').click();
    page.deliver({ type: "frame", frame: 9, lit: ["follower/looking", `${inner}/lookleft`] });
    await page.drawn();
    resize(420, 700);
    svg.dispatchEvent(new KeyboardEvent("keydown", { key: "Tab", bubbles: true }));
    expect(svg.querySelectorAll("[data-drawing]")).toHaveLength(1);
    await vi.advanceTimersByTimeAsync(1100); // and a pause
    const places = () =>
      [...svg.querySelectorAll("[data-drawing]")].map((each) => [
        each.getAttribute("data-drawing"),
        each.getAttribute("transform"),
      ]);
    const before = places();
    expect(before.map(([machine]) => machine)).toEqual(["follower", inner]);
    expect(svg.getAttribute("aria-label")).toBe("State graph of follower, lookalgo");
    expect(svg.querySelectorAll(".lrp-cone")).toHaveLength(1);
    expect(
      [...svg.querySelectorAll("[data-active]")].map((each) => each.getAttribute("data-lrp-state")),
    ).toEqual(["follower/looking", `${inner}/lookleft`]);
    page.find('[data-lrp-machine="follower"]').click();
    await page.drawn();
    expect(places()).toEqual(before);
    expect(page.find('[aria-selected="true"]').dataset.lrpMachine).toBe("follower");
    page.find('[data-lrp-action="arrange"]').click();
    expect(page.commands("arrange")).toMatchObject([{ path: "follower" }, { path: inner }]);
  });

  it("cuts long names in the middle, short ones at their end, and keeps characters whole", async () => {
    const program = structuredClone(recording.snapshot.frame.program);
    Object.assign(program.machines[0]!, { path: "look_for_the_wall_🤖_now!", parent: "" });
    Object.assign(program.machines[1]!, { path: "follower" });
    page.deliver({ type: "frame", frame: 9, program });
    await page.drawn();
    const name = page.find(".lrp-tree-name");
    expect([...name.children].map((part) => part.textContent)).toEqual(["look_for_the_wall", "_🤖_now!"]);
    const short = page.find('[data-lrp-machine="follower"] .lrp-tree-name');
    expect([...short.children].map(({ textContent }) => textContent)).toEqual(["follower"]);
    page.deliver({ type: "frame", frame: 10, lit: [] });
    await page.drawn();
    expect(page.find(".lrp-tree-state").childNodes).toHaveLength(0); // an empty one is not drawn
    expect(page.find("[role=treeitem]").title).toBe("look_for_the_wall_🤖_now!");
  });

  it("cuts long values in the text, and keeps characters whole", async () => {
    const text = "x".repeat(59);
    page.deliver({ type: "frame", frame: 9, variables: { lightlim: [`${text}🤖🤖`, null] } });
    await vi.waitFor(() =>
      expect([...page.host.querySelectorAll(".lrp-values")].map((value) => value.textContent)).toContain(
        `${text}…`,
      ),
    );
  });

  it("goes to a machine that a state spawns from elsewhere: by its line, by key, by the menu", async () => {
    const { follower } = recording.snapshot.frame.layouts;
    const inner = "follower/looking/lookalgo";
    const [, moving, looking, ...states] = follower.states;
    const spawned = { name: "lookalgo", settings: "", title: "lookalgo", x: 0, y: 9, width: 50 };
    const user = { ...moving!, spawns: [{ machine: inner, ...spawned }] };
    const layouts = { follower: { ...follower, states: [user, { ...looking!, machines: [] }, ...states] } };
    page.deliver({ type: "frame", frame: 9, layouts } as never);
    const shows = () => page.find('[aria-selected="true"]').dataset.lrpMachine;
    const state = () => page.find('.lrp-graph [data-lrp-state="follower/moving"]');
    const ways = [
      () => page.find(`.lrp-graph [data-lrp-spawns="${inner}"] text`).dispatchEvent(event("click")),
      () => state().dispatchEvent(event("keydown", { key: "Enter", shiftKey: true })),
      () => {
        state().dispatchEvent(event("keydown", { key: "m" }));
        const open = page.find('[role="menu"] [data-lrp-action="open"]');
        expect(open.textContent).toContain("Open lookalgo");
        open.click();
      },
    ];
    const event = (type: string, how: object = {}) =>
      new (type === "click" ? MouseEvent : KeyboardEvent)(type, { bubbles: true, composed: true, ...how });
    for (const go of ways) {
      page.find('[data-lrp-machine="follower"]').click();
      await page.drawn();
      expect(shows()).toBe("follower");
      go();
      await page.drawn();
      expect(shows()).toBe(inner);
    }
  });

  it("puts a state that is dragged back at Escape", () => {
    const svg = page.find(".lrp-graph");
    Object.assign(svg, { setPointerCapture() {}, hasPointerCapture: () => false });
    const state = page.find('.lrp-graph [data-lrp-state="follower/moving"]');
    const home = state
      .getAttribute("transform")!
      .match(/-?[\d.]+/g)!
      .map(Number);
    const at = (type: string, clientX: number) =>
      new PointerEvent(type, { clientX, clientY: 500, buttons: 1, bubbles: true, composed: true });
    state.dispatchEvent(at("pointerdown", 500));
    state.dispatchEvent(at("pointermove", 560));
    state.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape", bubbles: true, composed: true }));
    const [x, y] = home.map((length) => Math.round(length * 10) / 10);
    expect(page.commands("pin").at(-1)).toMatchObject({ name: "moving", x, y });
  });

  it("moves no graph under a hand that draws in it, and after a pause shows what is new", async () => {
    const svg = page.find(".lrp-graph");
    const press = (type: string, buttons: number) =>
      svg.dispatchEvent(new PointerEvent(type, { buttons, bubbles: true, composed: true }));
    const place = () => svg.firstElementChild!.getAttribute("transform");
    for (const side of ["clientWidth", "clientHeight"]) Object.defineProperty(svg, side, { value: 500 });
    page.find('[data-lrp-action="zoom-fit"]').click();
    vi.stubGlobal("matchMedia", () => ({ matches: true })); // no gliding
    const before = place();
    press("pointerdown", 1); // where all states are, here: on a border
    const graph = recording.snapshot.frame.layouts.follower;
    const states = [...graph.states, { ...graph.states[1]!, id: "follower/new", name: "new", x: 5000 }];
    page.deliver({ type: "frame", frame: 9, layouts: { follower: { ...graph, states } } });
    await vi.advanceTimersByTimeAsync(3000);
    expect(page.find('[data-lrp-state="follower/new"]').isConnected).toBe(true);
    expect(place()).toBe(before);
    press("pointerup", 0);
    await vi.advanceTimersByTimeAsync(900);
    expect(place()).toBe(before);
    await vi.advanceTimersByTimeAsync(200);
    expect(place()).not.toBe(before);
    vi.unstubAllGlobals();
  });

  it("says whether the robot is followed, whichever way that ended", () => {
    const follow = page.find('[data-lrp-action="world-follow"]');
    expect(follow.getAttribute("aria-pressed")).toBe("true"); // there is no room here to show all
    const zero = new KeyboardEvent("keydown", { key: "0", bubbles: true });
    page.find(".lrp-canvas").dispatchEvent(zero);
    expect(follow.getAttribute("aria-pressed")).toBe("false");
  });

  it("keeps for the next lab whether there is a grid", async () => {
    const checked = () => {
      page.find('[data-lrp-action="world-menu"]').click();
      return page.find('[role="menu"] [data-lrp-action="grid"]').getAttribute("aria-checked");
    };
    expect(checked()).toBe("false");
    page.find('[role="menu"] [data-lrp-action="grid"]').click();
    page.close();
    page = await new Page().begin();
    expect(checked()).toBe("true");
  });

  it("shows a world once, so that what is drawn meanwhile stays", async () => {
    const shown = vi.spyOn(Stage.prototype, "show");
    page.deliver({ type: "world", world: recording.snapshot.world });
    await page.drawn();
    expect(shown).toHaveBeenCalledTimes(1);
    shown.mockRestore();
  });

  it("asks before another program is opened", async () => {
    const { programs } = recording.snapshot.choices;
    page.find('[data-lrp-action="menu"]').click();
    page.find(`[role="menu"] [data-lrp-action="load-${programs[0]}"]`).click();
    const form = page.find('form[aria-label="Open a program"]');
    expect(form.hidden).toBe(false);
    expect(form.textContent).toContain(`Replace follower with ${programs[0]}?`);
    expect(page.commands("load")).toEqual([]);
    page.find('[data-lrp-action="open"]').click();
    page.deliver({ type: "reply", id: page.commands("load")[0]!.id, error: null });
    await page.drawn();
    expect(page.commands("load")).toMatchObject([{ name: programs[0] }]);
    expect(form.hidden).toBe(true);
  });

  it("shows the versions and returns to one", async () => {
    page.find('[data-lrp-action="menu"]').click();
    page.find('[role="menu"] [data-lrp-action="versions"]').click();
    const versions = [
      { key: "a", when: 1e9, text: "(machine a)" },
      { key: "b", when: 2e9, text: "(machine b) \u202e" },
    ];
    page.deliver({ type: "reply", id: page.of("versions").at(-1)!.id, error: null, versions });
    await page.drawn();
    const list = page.find('[aria-label="Version"]') as HTMLSelectElement;
    expect(page.focused).toBe(list);
    const shown = () => [...page.find('form[aria-label="Versions"] pre').querySelectorAll("ins, span")];
    expect(shown().map(({ textContent }) => textContent)).toEqual(["+ (machine a)\n"]);
    list.selectedIndex = 1;
    list.dispatchEvent(new Event("change"));
    expect(shown().map(({ textContent }) => textContent)).toEqual(["+ (machine b) <U+202E>\n"]);
    page.find('[data-lrp-action="use-version"]').click();
    expect(page.commands("version")).toMatchObject([{ key: "b" }]);
  });

  it("marks a text that is not kept, beside the name, with the reason", async () => {
    const mark = page.find('[data-lrp-action="unkept"]');
    expect(mark.hidden).toBe(true);
    page.deliver({ type: "frame", frame: 9, unkept: "No space left on device." });
    await page.drawn();
    expect(mark.hidden).toBe(false);
    mark.click();
    expect(page.find(".lrp-toast").textContent).toBe("No space left on device.");
  });

  it("asks about another text in the kernel's words, and answers with the number of the question", async () => {
    const conflict = { number: 4, text: "(machine x)", sentence: "Which?", use: "Use x", keep: "Keep y" };
    page.deliver({ type: "frame", frame: 9, conflict });
    await page.drawn();
    expect(page.find('[role="alertdialog"] p').textContent).toBe("Which?");
    page.find('[data-lrp-action="take"]').click();
    page.find('[data-lrp-action="keep-text"]').click();
    expect(page.find('[data-lrp-action="keep-text"]').textContent).toBe("Keep y");
    expect(page.commands("take")).toMatchObject([{ number: 4 }]);
    expect(page.commands("keep")).toMatchObject([{ number: 4 }]);
  });

  it("shows code in a sentence, and no signs around it in its tooltip", async () => {
    page.deliver({ type: "frame", frame: 9, reason: "`onentry` of `m/a` hangs." });
    await page.drawn();
    expect(page.find(".lrp-status").title).toBe("onentry of m/a hangs.");
  });

  it("says 'runs' of a text only while it runs", async () => {
    const verdict = page.find(".lrp-verdict");
    const shown = async (status: string) => {
      page.deliver({ type: "frame", frame: 9, status });
      await page.drawn();
      return verdict.textContent;
    };
    expect(await shown("running")).toBe("runs");
    expect(await shown("paused")).toBe("applied");
    expect(await shown("hung")).toBe("applied");
    expect(await shown("broken")).toBe("not running");
    page.end();
    await page.drawn();
    expect(verdict.textContent).toBe("no kernel");
  });

  it("says nowhere what a kernel does that is not reachable", async () => {
    const other = new Page();
    other.open();
    vi.advanceTimersByTime(100);
    other.deliver({ type: "frame", frame: 9 });
    vi.advanceTimersByTime(LOST_AFTER + 1000);
    await other.drawn();
    for (const place of [".lrp-verdict", ".lrp-status"])
      expect(other.find(place).textContent).toMatch(/^not reachable/);
    other.close();
  });

  it("says in a new view, too, that a text is not a program, or does not run yet", async () => {
    const verdict = page.find(".lrp-verdict");
    const { text } = recording.snapshot;
    const range = { line: 1, column: 1, end_line: 1, end_column: 2 };
    const open = {
      id: "1",
      code: "LRP101",
      severity: "error" as const,
      message: "",
      range,
      fix: null,
      creates: null,
    };
    const broken = { text: `(${text}`, accepted: false, findings: [open] };
    page.deliver({ ...structuredClone(recording.snapshot), ...broken });
    await page.drawn();
    expect(verdict.dataset.state).toBe("broken");
    page.deliver({ ...structuredClone(recording.snapshot), ...broken, findings: [] });
    await page.drawn();
    expect(verdict.textContent).toMatch(/^unfinished/); // what is being typed at the cursor has no mark
    page.deliver({ ...structuredClone(recording.snapshot), text: `; x\n${text}`, accepted: true });
    await page.drawn();
    expect(verdict.dataset.state).toBe("waits");
  });

  it("says 'runs' of an edit that restarted the program", async () => {
    page.type("; x\n");
    page.confirm({ reason: "`m` is active and was removed." });
    await page.drawn();
    expect(page.find(".lrp-verdict").textContent).toBe("runs");
    page.confirm({ applied: false, reason: "The machine is missing." });
    await page.drawn();
    expect(page.find(".lrp-verdict").textContent).toBe("The machine is missing.");
  });

  it("says whether the text of a view without a kernel was copied", async () => {
    page.end();
    const copied: string[] = [];
    const clipboards = [{ writeText: async (text: string) => void copied.push(text) }, undefined];
    const said = [];
    for (const clipboard of clipboards) {
      Object.defineProperty(navigator, "clipboard", { value: clipboard, configurable: true });
      page.find('[data-lrp-action="copy"]').click();
      await page.drawn();
      said.push(page.find(".lrp-toast").textContent);
    }
    expect(copied).toEqual([page.editor.state.sliceDoc()]);
    expect(said).toEqual(["The text is copied.", expect.stringContaining("press Ctrl+C")]);
  });

  it("inserts a member of the robot into a block, and copies it where there is none", async () => {
    const copied: string[] = [];
    const clipboard = { writeText: async (text: string) => void copied.push(text) };
    Object.defineProperty(navigator, "clipboard", { value: clipboard, configurable: true });
    const text = page.editor.state.doc.toString();
    page.editor.dispatch({ selection: { anchor: 0 } });
    page.find(".lrp-member").click();
    await page.drawn();
    expect(page.editor.state.doc.toString()).toBe(text);
    expect(copied).toHaveLength(1);
    expect(page.find(".lrp-toast").textContent).toContain(`${copied[0]} is copied.`);
    const block = text.indexOf("[") + 1;
    page.editor.dispatch({ selection: { anchor: block } });
    page.find(".lrp-member").click();
    expect(page.editor.state.doc.toString()).toBe(text.slice(0, block) + copied[0] + text.slice(block));
  });

  it.each(["s", "S"])("leaves Ctrl+%s to the notebook, also with Caps Lock", (letter) => {
    const targets: (EventTarget | null)[] = [];
    page.host.addEventListener("keydown", ({ key, ctrlKey, target }) => {
      if (key === letter && ctrlKey) targets.push(target);
    });
    const init = { key: letter, ctrlKey: true, bubbles: true, cancelable: true };
    const pressed = new KeyboardEvent("keydown", init);
    page.editor.contentDOM.dispatchEvent(pressed);
    expect(pressed.defaultPrevented).toBe(true);
    expect(targets).toContain(page.host);
  });

  it.each([
    ["of a value", "m"],
    ["in the graph", "n"],
  ])("leaves Ctrl+s to the notebook from a field %s, where the browser would save the page", (_, key) => {
    if (key === "m") page.find('[data-lrp-variable="lightlim"] .lrp-value').click();
    else page.find(".lrp-graph").dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
    const saved = vi.fn();
    page.host.addEventListener("keydown", ({ target }) => target === page.host && saved());
    const pressed = new KeyboardEvent("keydown", {
      key: "s",
      ctrlKey: true,
      bubbles: true,
      cancelable: true,
    });
    page.find(".lrp-field input, .lrp-variable input").dispatchEvent(pressed);
    expect([pressed.defaultPrevented, saved.mock.calls.length]).toEqual([true, 1]);
  });

  it("leaves the keyboard focus in the lab when what had it disappears", async () => {
    page.deliver({ type: "frame", frame: 9, status: "broken", reason: "The session itself failed." });
    await page.drawn();
    page.find('[data-lrp-action="start-again"]').focus();
    page.deliver({ type: "frame", frame: 10, status: "running", reason: "" });
    await page.drawn();
    expect(page.focused).toBe(page.find(".lrp-lab"));
    page.find('[data-lrp-action="stop"]').focus();
    expect(page.find(".lrp-lab").hasAttribute("tabindex")).toBe(false);
  });

  it("leaves the keyboard focus in the lab when the row in which a value is typed disappears", async () => {
    page.find('[data-lrp-variable="lightlim"] .lrp-value').click();
    expect(page.focused?.tagName).toBe("INPUT");
    const program = { ...recording.snapshot.frame.program, variables: [] };
    page.deliver({ type: "frame", frame: 9, program });
    await page.drawn();
    expect(page.host.querySelector('[data-lrp-variable="lightlim"]')).toBe(null);
    expect(page.focused).toBe(page.find(".lrp-lab"));
  });

  it("leaves the keyboard focus in the lab when a robot's panel gets other fields", async () => {
    const panel = (...keys: string[]) => ({
      ...{ title: "", tables: [], buttons: [], questions: [] },
      fields: keys.map((key) => ({
        key,
        label: key,
        kind: "text",
        value: "",
        choices: [],
        unit: "",
        press: "",
      })),
    });
    page.deliver({ type: "frame", frame: 9, panel: panel("address") });
    await page.drawn();
    page.find('[data-field="address"]').focus();
    page.deliver({ type: "frame", frame: 10, panel: panel("address", "speed") });
    await page.drawn();
    page.find('[data-field="speed"]');
    expect(page.focused).toBe(page.find(".lrp-lab"));
  });

  it("leaves the keyboard focus in the inspector, where it was, when a value changes", async () => {
    page.find('[data-lrp-variable="lightlim"] [data-lrp-action="inspect"]').click();
    await page.drawn();
    const facet = (label: string) => ({ step: label, label, type: "int", text: "1", deep: true });
    const shows = async (...labels: string[]) => {
      const view = { title: "", text: "", type: "", facets: labels.map(facet), more: 0, source: "" };
      page.deliver({ type: "reply", id: page.of("inspect").at(-1)!.id, error: null, inspect: view });
      await page.drawn();
    };
    const links = () => [...page.host.querySelectorAll<HTMLElement>(".lrp-inspect-body .lrp-link")];
    await shows("a", "b");
    links()[1]!.focus();
    const moved = { 1: [{ kind: "variable", old: "lightlim", new: "limit" }] };
    page.deliver({ type: "frame", frame: 9, moved }); // it asks again
    await page.drawn();
    await shows("a", "b", "c");
    expect(page.focused).toBe(links()[1]);
  });

  it("shows after the end of the kernel only what is still so, and says that commands go nowhere", async () => {
    const hung = { where: "a.running", seconds: 3, held: false };
    page.deliver({ type: "frame", frame: 9, hung, reason: "`a.running` has run.", unkept: "No space." });
    await page.drawn();
    const shown = (action: string) => !page.find(`[data-lrp-action="${action}"]`).closest("[hidden]");
    expect([shown("interrupt"), shown("unkept")]).toEqual([true, true]);
    page.end();
    await page.drawn();
    expect([shown("interrupt"), shown("unkept"), shown("copy")]).toEqual([false, false, true]);
    page.find(".lrp-toast").textContent = "";
    page.find('[data-lrp-action="menu"]').click();
    page.find('[role="menu"] [data-lrp-action="versions"]').click();
    await page.drawn();
    expect(page.find(".lrp-toast").textContent).toContain("Run the cell again.");
    expect(page.find('form[aria-label="Versions"]').hidden).toBe(true);
  });

  it("leaves nothing that listens to the document when it is closed", () => {
    const heard = vi.fn(() => 0);
    const wheel = () =>
      document.body.dispatchEvent(
        Object.defineProperty(new Event("wheel", { bubbles: true }), "timeStamp", { get: heard }),
      );
    wheel();
    expect(heard).toHaveBeenCalled();
    page.close();
    heard.mockClear();
    wheel();
    expect(heard).not.toHaveBeenCalled();
  });

  it("sends a last message when it is closed", () => {
    page.close();
    expect(page.sent.at(-1)).toMatchObject({ type: "bye" });
    expect(page.host.children).toHaveLength(0);
  });
});

describe("a text that no kernel has answered", () => {
  const snapshot = { ...structuredClone(recording.snapshot), home: "/home/follower", tab_only: false };
  const leave = () => {
    page.close();
    page.host.remove();
  };
  const open = (fields = {}) => {
    page = new Page();
    page.open({ home: snapshot.home, tab_only: false, ...fields });
    return page.drawn();
  };
  const next = (text = snapshot.text) => {
    leave();
    return open({ text });
  };
  const isRecovered = (text: string) => {
    expect(page.commands("recover")).toMatchObject([{ text }]);
    page.deliver({ type: "reply", id: page.commands("recover")[0]!.id, error: null });
    return page.drawn();
  };

  beforeEach(() => next());

  it("is given to the next view of the program, once", async () => {
    page.type("(machine");
    await next();
    await isRecovered(`(machine${snapshot.text}`);
    await next();
    expect(page.commands("recover")).toEqual([]);
  });

  it("is also kept when the page is left", async () => {
    page.type("; x\n");
    window.dispatchEvent(new Event("pagehide"));
    expect([...lostTexts(snapshot).values()]).toEqual([`; x\n${snapshot.text}`]);
  });

  it("is forgotten as soon as it is answered, or if the kernel has it", async () => {
    page.type("; x\n");
    window.dispatchEvent(new Event("pagehide"));
    page.confirm();
    await next();
    expect(page.commands("recover")).toEqual([]);
    page.type("; y\n");
    await next(`; y\n${snapshot.text}`);
    expect(page.commands("recover")).toEqual([]);
    expect(lostTexts(snapshot).size).toBe(0);
  });

  it("is forgotten when a snapshot shows that it has arrived", () => {
    page.type("; x\n");
    window.dispatchEvent(new Event("pagehide"));
    expect(lostTexts(snapshot).size).toBe(1);
    const updates = page.merge();
    page.deliver({ ...structuredClone(snapshot), ...page.snapshot(updates, 1) });
    expect(lostTexts(snapshot).size).toBe(0);
  });

  it("includes one that the kernel could not keep before it ended", async () => {
    page.type("; x\n");
    page.confirm();
    page.deliver({ type: "frame", frame: 9, unkept: "No space left on device." });
    page.end();
    await next();
    await isRecovered(`; x\n${snapshot.text}`);
  });

  it("includes one that the kernel has answered, if it is silent since: it may not have kept it", async () => {
    leave();
    page = new Page();
    await vi.advanceTimersByTimeAsync(1);
    page.open({ home: snapshot.home, tab_only: false });
    page.type("; x\n");
    page.confirm();
    await vi.advanceTimersByTimeAsync(LOST_AFTER + 200);
    await next();
    await isRecovered(`; x\n${snapshot.text}`);
  });

  it("includes what is typed after the kernel has ended, and nothing that it knew", async () => {
    page.type("; x\n");
    page.confirm();
    page.end();
    await next();
    expect(page.commands("recover")).toEqual([]);
    page.end();
    page.type("; y\n");
    await next();
    await isRecovered(`; y\n${snapshot.text}`);
  });

  it("is kept for each view, where several are left at once", async () => {
    const other = new Page();
    other.deliver(structuredClone(snapshot));
    page.type("; a\n");
    other.type("; b\n");
    window.dispatchEvent(new Event("pagehide"));
    other.close();
    other.host.remove();
    await next();
    const texts = [`; a\n${snapshot.text}`, `; b\n${snapshot.text}`];
    expect(new Set(lostTexts(snapshot).values())).toEqual(new Set(texts));
    for (let each = 0; each < 2; each++) {
      page.deliver({ type: "reply", id: page.commands("recover")[each]!.id, error: null });
      await page.drawn();
    }
    expect(new Set(page.commands("recover").map((command) => "text" in command && command.text))).toEqual(
      new Set(texts),
    );
    expect(lostTexts(snapshot).size).toBe(0);
  });

  it("ends with its tab where the kernel keeps no text, because the browser may be someone else's next", async () => {
    leave();
    await open({ tab_only: true });
    page.type("; x\n");
    page.confirm();
    page.end();
    leave();
    expect(localStorage).toHaveLength(0);
    const tab = { ...sessionStorage };
    sessionStorage.clear();
    await open({ tab_only: true });
    expect(page.commands("recover")).toEqual([]);
    leave();
    Object.assign(sessionStorage, tab);
    await open({ tab_only: true });
    await isRecovered(`; x\n${snapshot.text}`);
  });

  it("of one program is not given to another", async () => {
    page.type("; x\n");
    leave();
    await open({ home: "/elsewhere/follower" });
    expect(page.commands("recover")).toEqual([]);
  });
});

it.each(["editor", "graph", "world", "variables", "issues", "tree", "controls"] as const)(
  "%s stands alone",
  async (part) => {
    const alone = await new Page(part).begin();
    alone.find(`[data-lrp="${part}"]`);
    expect(alone.host.querySelectorAll(".lrp-lab > [data-lrp]")).toHaveLength(1);
    expect(alone.sent[0]).toMatchObject({ type: "hello", part });
    alone.close();
  },
);
