// @vitest-environment happy-dom

import { beforeEach, describe, expect, it, vi } from "vitest";
import type { WidgetManager } from "../src/host/notebook";
import type { CellView } from "../src/protocol";
import { Page } from "./opened";
import recording from "./page/recording.json";

const {
  text,
  frame: { revision },
} = recording.snapshot;
const GIVEN = text.trimEnd();
const STILL = { "image/svg+xml": "<svg/>", "text/plain": text };
const LINE = "%%lrp follower --world line";
const MARK = '[data-lrp-action="unkept"]';

function signal() {
  const slots = new Set<(sender: unknown, value: unknown) => void>();
  return {
    connect: (slot: () => void) => slots.add(slot),
    disconnect: (slot: () => void) => slots.delete(slot),
    emit: (value?: unknown) => {
      for (const slot of slots) slot(null, value);
    },
  };
}

/** A cell as Jupyter has it: its source, and the first output as it is saved. */
function cellOf(source: string) {
  const contentChanged = signal();
  const output = { data: STILL, metadata: {}, trusted: true };
  const saved = new Map<string, object>([["data", STILL]]);
  const cell = {
    source,
    steps: 0, // that Jupyter could undo
    saved,
    contentChanged,
    outputs: { length: 1, get: () => output },
    sharedModel: {
      getSource: () => cell.source,
      updateSource(start: number, end: number, value: string) {
        cell.source = cell.source.slice(0, start) + value + cell.source.slice(end);
        contentChanged.emit();
      },
      transact(change: () => void, undoable: boolean) {
        cell.steps += Number(undoable);
        change();
      },
      ymodel: { get: () => ({ get: () => saved }) },
    },
    /** The user edits it. */
    edit(program: string) {
      cell.source = `${LINE}\n${program}`;
      contentChanged.emit();
    },
  };
  return cell;
}

class Notebook {
  readonly cells = [cellOf(`${LINE}\n${GIVEN}`)];
  readonly model = {
    dirty: false,
    collaborative: false,
    cells: { length: 1, get: (index: number) => this.cells[index] },
    contentChanged: signal(),
  };
  readonly saveState = signal();
  saves = 0;

  /** Jupyter saves it. */
  readonly save = async () => {
    this.saves++;
    this.saveState.emit("started");
    this.model.dirty = false;
    this.saveState.emit("completed");
  };
}

describe("what is typed", () => {
  let notebook: Notebook;
  let page: Page;
  let given: CellView;
  const cell = () => notebook.cells[0]!;
  const draws = (svg: string) => {
    for (const { id } of page.of("picture").splice(-1)) page.deliver({ type: "reply", id, error: null, svg });
    return page.drawn();
  };
  const frame = (fields: object) => {
    page.deliver({ type: "frame", frame: 9, ...fields });
    return page.drawn();
  };
  /** The cell was run with a text. */
  const runs = (program: string) => frame({ cell: { ...given, given: ++given.given, text: program } });
  const open = (collaborative = false) => {
    notebook = new Notebook();
    notebook.model.collaborative = collaborative;
    page = new Page("lab", true, { context: notebook } as unknown as WidgetManager);
    given = { given: 1, line: LINE, text, is_saved: true };
    page.open();
    return frame({ cell: { ...given }, revision });
  };
  beforeEach(() => open());

  it("is saved in the cell, with its picture, and in no step that Jupyter undoes", async () => {
    expect(notebook.model.dirty).toBe(false);
    page.type("; new\n");
    expect(notebook.model.dirty).toBe(true);
    expect(cell().source).toBe(`${LINE}\n${GIVEN}`);
    await notebook.save();
    expect(cell().source).toBe(`${LINE}\n; new\n${GIVEN}`);
    expect(cell().steps).toBe(0);
    expect(cell().saved.get("data")).toEqual({ ...STILL, "text/plain": `; new\n${text}` });
    expect(page.commands("put_into_cell")).toMatchObject([{ text: `; new\n${text}` }]);
    expect(page.of("picture")).toEqual([]); // nothing else runs yet
  });

  it("has its picture when it is saved at once: Jupyter saves again, with what has come meanwhile", async () => {
    page.type("; new\n");
    page.confirm();
    await frame({ revision: revision + 1 });
    await notebook.save();
    await draws("<svg>new</svg>");
    await vi.waitFor(() => expect(notebook.saves).toBe(2));
    expect(cell().saved.get("data")).toMatchObject({ "image/svg+xml": "<svg>new</svg>" });
    expect(notebook.model.dirty).toBe(false);
    await notebook.save();
    expect(page.of("picture")).toHaveLength(1);
  });

  it("has its picture when it is saved before it runs: Jupyter saves again", async () => {
    page.type("; new\n");
    await notebook.save();
    page.confirm();
    await frame({ revision: revision + 1 });
    await vi.waitFor(() => expect(page.of("picture")).toHaveLength(1), 5000);
    await draws("<svg>new</svg>");
    await vi.waitFor(() => expect(notebook.saves).toBe(2));
    expect(cell().saved.get("data")).toMatchObject({ "image/svg+xml": "<svg>new</svg>" });
  });

  it("has its picture also when it began to run after the last rest", async () => {
    vi.useFakeTimers({ toFake: ["setTimeout", "performance"] });
    page.type("; new\n");
    await vi.advanceTimersByTimeAsync(2000);
    expect(page.of("picture")).toEqual([]);
    page.confirm();
    await frame({ revision: revision + 1 });
    await vi.advanceTimersByTimeAsync(2000);
    expect(page.of("picture")).toHaveLength(1);
    vi.useRealTimers();
  });

  it("is not written over a cell that was edited, too, before its user chooses", async () => {
    cell().edit("(machine mine)");
    page.type("; new\n");
    page.confirm();
    await page.drawn();
    page.find(MARK).click();
    expect(page.find(".lrp-toast").textContent).toContain("the cell above has a different text");
    expect(page.around.classList.contains("lrp-lab-differs")).toBe(true);
    await notebook.save();
    expect(cell().source).toBe(`${LINE}\n(machine mine)`);
    await runs("(machine mine)"); // and keeps the lab's text
    expect(page.find(MARK).hidden).toBe(true);
    await notebook.save();
    expect(cell().source).toBe(`${LINE}\n; new\n${GIVEN}`);
  });

  it("is not saved where no cell has the program, such as after a cell was split, which is said once it is changed", async () => {
    cell().source = GIVEN;
    cell().contentChanged.emit();
    expect(page.find(MARK).hidden).toBe(true);
    page.type("; new\n");
    page.confirm();
    page.deliver({ type: "frame", frame: 8, cell: { is_saved: false } });
    await page.drawn();
    page.find(MARK).click();
    expect(page.find(".lrp-toast").textContent).toContain("no cell has this program");
    cell().edit(GIVEN);
    await page.drawn();
    expect(page.find(MARK).hidden).toBe(true);
  });

  it("goes into the cell that was run last, wherever the lab is shown", async () => {
    notebook.cells.push(cellOf(`${LINE}\n(machine later)`), cellOf("%%lrp other\n(machine later)"));
    notebook.model.cells.length = 3;
    page.hears("(machine later)\n");
    await runs("(machine later)");
    page.type("; new\n");
    await notebook.save();
    expect(notebook.cells.map(({ source }) => source)).toEqual([
      `${LINE}\n${GIVEN}`,
      `${LINE}\n; new\n(machine later)`,
      "%%lrp other\n(machine later)",
    ]);
    expect(page.find(MARK).hidden).toBe(true);
  });

  it("fills a cell that has only its first line", async () => {
    cell().edit("");
    await runs("");
    page.type("; new\n");
    await notebook.save();
    expect(cell().source).toBe(`${LINE}\n; new\n${GIVEN}`);
  });

  it("is saved by the page in which it was typed, where the server saves every change", async () => {
    await open(true);
    vi.useFakeTimers({ toFake: ["setTimeout"] });
    page.deliver({ type: "frame", frame: 9, hands: { [page.view]: {}, other: {} } });
    page.deliver(page.answer(page.elsewhere(`; theirs\n${text}`, "other")));
    await vi.runAllTimersAsync();
    await notebook.save();
    expect(cell().source).toBe(`${LINE}\n${GIVEN}`);
    page.type("; mine\n");
    await vi.runAllTimersAsync();
    expect(cell().source).toBe(`${LINE}\n; mine\n; theirs\n${GIVEN}`);
    vi.useRealTimers();
  });

  it("is not saved where a page cannot write into the notebook, which says what to do instead", async () => {
    page = new Page();
    page.open({ by_hand: "Run `%lrp save m` in a cell." });
    await page.drawn();
    expect(page.find(MARK).textContent).toBe("Not saved");
    page.find(MARK).click();
    expect(page.find(".lrp-toast").textContent).toContain("Run %lrp save m in a cell.");
    page.deliver({ type: "frame", frame: 8, cell: { is_saved: true } });
    await page.drawn();
    expect(page.find(MARK).hidden).toBe(true);
    page.deliver({ type: "frame", frame: 9, unkept: "No space." });
    await page.drawn();
    expect(page.find(MARK).textContent).toBe("Not kept");
  });
});
