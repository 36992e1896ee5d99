import { expect, it, vi } from "vitest";
import type { WidgetManager } from "../src/host/notebook";
import { showLabs } from "../src/host/outputs";

const VIEW = "application/vnd.jupyter.widget-view+json";
const SHOWN = { [VIEW]: { version_major: 2, version_minor: 0, model_id: "w" } };
const STILL = { "image/svg+xml": "<svg/>", "text/plain": "(machine m)" };

/** A notebook of one cell with one output, as it is saved and as the page has it, and the page's models. */
function notebook({ id = "lrp_jupyter.widgets.lab.Lab", live = true, data = { ...STILL, ...SHOWN } } = {}) {
  const output = { data, metadata: { lrp_jupyter: { widget: "w" } }, trusted: false, toJSON: () => output };
  const saved = new Map([["data", { ...data }]]);
  const outputs = { length: 0, get: () => output, stateChanged: { emit: vi.fn() } };
  const ymodel = { get: () => ({ get: () => (outputs.length ? saved : undefined) }) };
  const cell = { outputs, sharedModel: { ymodel, transact: (change: () => void) => change() } };
  const signal = () => {
    const slots: (() => void)[] = [];
    return { slots, connect: (slot: () => void) => slots.push(slot) };
  };
  const [changed, saving] = [signal(), signal()];
  const models: Record<string, object> = {};
  const manager = {
    context: {
      model: { cells: { length: 1, get: () => cell }, contentChanged: changed },
      saveState: saving,
    },
    has_model: (widget: string) => widget in models,
    get_model: async (widget: string) => models[widget],
  } as unknown as WidgetManager;
  return {
    output,
    saved,
    drawn: outputs.stateChanged.emit,
    signals: [changed, saving],
    manager,
    arrives() {
      outputs.length = 1;
      for (const slot of changed.slots) slot();
      return vi.waitFor(() => undefined);
    },
    opens() {
      models.w = { comm_live: live, get: () => id };
      showLabs(manager);
      return vi.waitFor(() => undefined);
    },
  };
}

it("a lab that another user has run is shown, whether its output or its model comes first", async () => {
  const first = notebook();
  await first.opens();
  await first.arrives();
  expect(first.output.trusted).toBe(true);
  expect(first.drawn).toHaveBeenCalledExactlyOnceWith(0);
  const second = notebook();
  await second.arrives();
  await second.opens();
  expect(second.output.trusted).toBe(true);
  expect(second.drawn).toHaveBeenCalledExactlyOnceWith(0);
});

it("the picture and the text of a lab are saved without its widget, which a page with its kernel shows", async () => {
  const run = notebook();
  await run.opens();
  await run.arrives();
  expect(run.saved.get("data")).toEqual(STILL);
  expect(run.output.data).toEqual({ ...STILL, ...SHOWN });
  const reopened = notebook({ data: { ...STILL } as typeof STILL & typeof SHOWN });
  await reopened.opens();
  await reopened.arrives();
  expect(reopened.output.data).toEqual({ ...STILL, ...SHOWN });
  expect(reopened.saved.get("data")).toEqual(STILL);
  expect(reopened.drawn).toHaveBeenCalledExactlyOnceWith(0);
});

it("what the kernel has not opened, and what is not a lab, stays as the host shows it", async () => {
  for (const other of [notebook({ live: false }), notebook({ id: "somewhere.Widget" })]) {
    await other.opens();
    await other.arrives();
    expect(other.output.trusted).toBe(false);
    expect(other.drawn).not.toHaveBeenCalled();
  }
});

it("a notebook is watched once, and a host that shows none is left alone", async () => {
  const { manager, signals } = notebook();
  showLabs(manager);
  showLabs(manager);
  expect(signals.map(({ slots }) => slots.length)).toEqual([1, 1]);
  showLabs(undefined);
  showLabs({});
});
