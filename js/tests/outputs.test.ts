import { expect, it, vi } from "vitest";
import type { WidgetManager } from "../src/host/notebook";
import { showLabs } from "../src/host/outputs";

const VIEW = "application/vnd.jupyter.widget-view+json";

/** A notebook of one cell with one output, which another user has run, and the page's models. */
function notebook(id = "lrp_jupyter.widgets.lab.Lab", live = true) {
  const output = { data: { [VIEW]: { model_id: "w" } }, trusted: false };
  const outputs = { length: 0, get: () => output, stateChanged: { emit: vi.fn() } };
  const changed: (() => void)[] = [];
  const models: Record<string, object> = {};
  const manager = {
    context: {
      model: {
        cells: { length: 1, get: () => ({ outputs }) },
        contentChanged: { connect: (slot: () => void) => changed.push(slot) },
      },
    },
    has_model: (widget: string) => widget in models,
    get_model: async (widget: string) => models[widget],
  } as unknown as WidgetManager;
  return {
    output,
    drawn: outputs.stateChanged.emit,
    changed,
    manager,
    arrives() {
      outputs.length = 1;
      for (const slot of changed) slot();
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

it("what the kernel has not opened, or is no lab, stays as the host shows it", async () => {
  for (const other of [notebook("lrp_jupyter.widgets.lab.Lab", false), notebook("somewhere.Widget")]) {
    await other.opens();
    await other.arrives();
    expect(other.output.trusted).toBe(false);
    expect(other.drawn).not.toHaveBeenCalled();
  }
});

it("a notebook is watched once, and a host that shows none is left alone", async () => {
  const { manager, changed } = notebook();
  showLabs(manager);
  showLabs(manager);
  expect(changed).toHaveLength(1);
  showLabs(undefined);
  showLabs({});
});
