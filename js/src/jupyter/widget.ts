/** A widget of a kernel, as its page has it: what the lab uses of it, by the messages of Jupyter's widgets. */

import type { Kernel, KernelMessage } from "@jupyterlab/services";
import type lab from "../index";
import type { Model } from "../session/connection";

export const TARGET = "jupyter.widget";

type Buffers = (ArrayBuffer | ArrayBufferView)[] | undefined;
type Receive = (content: unknown, buffers: Buffers) => void;
type State = Record<string, unknown>;

export class LabModel implements Model {
  private readonly receivers = new Map<string, Set<Receive>>();
  private changed: State = {};

  constructor(
    private readonly comm: Kernel.IComm,
    private readonly state: State,
    /** Messages that are not for the lab. */
    private readonly other: (content: State) => void,
  ) {
    comm.onMsg = ({ content, buffers }) => this.receive(content.data as State, buffers);
    comm.onClose = () => this.report("comm_live_update");
  }

  send(content: unknown, _callbacks?: unknown, buffers?: ArrayBuffer[]): void {
    if (!this.comm.isDisposed) this.comm.send({ method: "custom", content } as never, undefined, buffers);
  }

  on(event: string, callback: (...args: never[]) => void): void {
    const all = this.receivers.get(event) ?? new Set();
    this.receivers.set(event, all.add(callback as Receive));
  }

  off(event: string, callback: (...args: never[]) => void): void {
    this.receivers.get(event)?.delete(callback as Receive);
  }

  get(name: string): unknown {
    return this.state[name];
  }

  set(name: string, value: unknown): void {
    this.state[name] = this.changed[name] = value;
  }

  save_changes(): void {
    this.comm.send({ method: "update", state: this.changed, buffer_paths: [] } as never);
    this.changed = {};
  }

  private receive({ method, state, content }: State, buffers: Buffers): void {
    if (method === "update") Object.assign(this.state, state);
    if (method !== "custom") return;
    if ("json" in (content as State)) this.report("msg:custom", content, buffers);
    else this.other(content as State);
  }

  private report(event: string, content?: unknown, buffers?: Buffers): void {
    for (const receive of [...(this.receivers.get(event) ?? [])]) receive(content, buffers);
  }
}

/** Call back with every lab that a kernel opens from now on: its model, and its module. */
export function onOpened(
  kernel: Kernel.IKernelConnection,
  opened: (comm: Kernel.IComm, state: State) => void,
): void {
  kernel.registerCommTarget(TARGET, (comm, { content }: KernelMessage.ICommOpenMsg) => {
    const { state } = content.data as { state: State };
    if (state._esm) opened(comm, state);
  });
}

/** Draw a lab with its own module, which is that of the kernel's package. */
export async function drawn(model: LabModel, el: HTMLElement): Promise<() => void> {
  const address = URL.createObjectURL(new Blob([String(model.get("_esm"))], { type: "text/javascript" }));
  try {
    const module = (await import(/* webpackIgnore: true */ address)) as { default: typeof lab };
    const style = Object.assign(document.createElement("style"), { textContent: model.get("_css") });
    const host = document.createElement("div");
    el.replaceChildren(style, host);
    return module.default.render({ model, el: host });
  } finally {
    URL.revokeObjectURL(address);
  }
}
