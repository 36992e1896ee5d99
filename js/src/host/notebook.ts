/**
 * The notebook around a lab, in hosts that show it to their widgets (JupyterLab and Jupyter Notebook): only
 * what is used here of their interfaces. Elsewhere there is none, and the lab does without.
 */

interface Signal<T> {
  connect(slot: (sender: unknown, value: T) => void): boolean;
  disconnect(slot: (sender: unknown, value: T) => void): boolean;
  emit(value: T): void;
}

export const VIEW = "application/vnd.jupyter.widget-view+json";
const FRAMES = 100; // that a new cell may take to be drawn
const ENTER = { key: "Enter", code: "Enter", keyCode: 13 };
const CTRL_ENTER = { ...ENTER, ctrlKey: true, bubbles: true, cancelable: true };
export const PICTURE = "image/svg+xml";
/** The metadata of an output that shows a lab, or a part of one: `_OURS` of `widgets/lab.py`. */
const OURS = "lrp_jupyter";

type Bundle = Record<string, unknown>;

interface NotebookOutput {
  readonly data: Readonly<Bundle>;
  readonly metadata: { readonly [OURS]?: { readonly widget?: string } };
  /** Whether this page shows more of it than text: its user has run the cell, or the notebook is trusted. */
  trusted: boolean;
  toJSON(): { data: Bundle };
}

/** An output as it is saved, a map of Yjs: a change of it changes nothing that is drawn. */
interface SavedOutput {
  get(name: "data"): Readonly<Bundle>;
  set(name: "data", data: Bundle): void;
}

export interface NotebookCell {
  readonly contentChanged: Signal<void>;
  readonly sharedModel: {
    getSource(): string;
    setSource(source: string): void;
    updateSource(start: number, end: number, value?: string): void;
    transact(change: () => void, undoable: boolean): void;
    readonly ymodel: { get(name: "outputs"): { get(index: number): SavedOutput | undefined } | undefined };
  };
  /** Of a code cell: by MIME type. */
  readonly outputs?: {
    length: number;
    get(index: number): NotebookOutput;
    /** Reports the index of an output that must be drawn again. */
    readonly stateChanged: Signal<number>;
  };
}

export interface Notebook {
  /** "started" is reported before the model is written, in the same call. */
  readonly saveState: Signal<"started" | "completed" | "failed" | "completed manually">;
  save(): Promise<void>;
  readonly model: {
    /** Whether the notebook is to be saved: Jupyter saves it then unasked, and asks before it is closed. */
    dirty: boolean;
    /** Whether the server saves it after each change. */
    readonly collaborative?: boolean;
    readonly contentChanged: Signal<void>;
    readonly cells: { length: number; get(index: number): NotebookCell | undefined } | null;
    readonly sharedModel: { insertCell(index: number, cell: { cell_type: "code"; source: string }): unknown };
  };
}

/** The part of a widget's model from which its notebook is found. */
export interface HostedModel {
  widget_manager?: WidgetManager;
}

export interface WidgetManager {
  readonly context?: Notebook;
  has_model?(id: string): boolean;
  /** The model is live if the kernel has it: others were stored with the notebook. */
  get_model?(id: string): Promise<{ comm_live?: boolean; get(name: string): unknown }>;
}

/** The cells of a notebook; none of one that was closed. */
export function* cellsOf({ model: { cells } }: Notebook): Generator<NotebookCell> {
  for (let place = 0; cells && place < cells.length; place++) {
    const cell = cells.get(place);
    if (cell) yield cell;
  }
}

/** The outputs that show a lab, or a part of one, each with its widget's identifier and where it is. */
export function* labsIn(notebook: Notebook) {
  for (const cell of cellsOf(notebook)) {
    const { outputs } = cell;
    for (let index = 0; outputs && index < outputs.length; index++) {
      const output = outputs.get(index);
      const widget = output?.metadata?.[OURS]?.widget;
      if (widget) yield { widget, output, outputs, cell, index };
    }
  }
}

/** Change what is saved of an output; returns whether it was different before. */
export function saveOutput({ sharedModel }: NotebookCell, index: number, changes: Bundle): boolean {
  const saved = sharedModel.ymodel.get("outputs")?.get(index);
  const data = saved?.get?.("data");
  if (!saved || !data) return false;
  const wanted = Object.entries({ ...data, ...changes }).filter(([, value]) => value !== undefined);
  const isSame =
    Object.keys(data).length === wanted.length &&
    wanted.every(([type, value]) => textOf(data[type]) === textOf(value));
  if (!isSame) sharedModel.transact(() => saved.set("data", Object.fromEntries(wanted)), false);
  return !isSame;
}

/** A text of a file may be a list of its lines. */
export function textOf(value: unknown): unknown {
  return Array.isArray(value) ? value.join("") : value;
}

export interface CellPlace {
  notebook: Notebook;
  cell: NotebookCell;
  /** Where the cell is now: others can be inserted above it. */
  readonly index: number;
  /** The cell as it is drawn. */
  element: HTMLElement;
}

/** The cell whose output contains an element; null if the host shows no notebook. */
export function cellAround(model: HostedModel, inside: HTMLElement): CellPlace | null {
  const notebook = model.widget_manager?.context;
  const element = inside.closest<HTMLElement>(".jp-Cell");
  const index = () => Number(element?.dataset.windowedListIndex ?? Number.NaN);
  const cell = notebook?.model?.cells?.get(index());
  if (!notebook || !element || !cell) return null;
  return {
    notebook,
    cell,
    element,
    get index() {
      return index();
    },
  };
}

/**
 * Write code into a cell below another one, and run it by the key that its user would press. The cell of the
 * last time is used again. Returns a sentence if it cannot run now, or an empty one.
 */
export async function runBelow({ notebook, element, index }: CellPlace, source: string): Promise<string> {
  const page = element.closest(".jp-Notebook") ?? document;
  const waiting = page.querySelector<HTMLElement>(".jp-Stdin-input");
  if (waiting) {
    waiting.focus();
    return "A cell waits for input. End the debugger there with `q` first.";
  }
  const { cells, sharedModel } = notebook.model;
  const below = cells?.get(index + 1)?.sharedModel;
  if (below && /^%(load_ext lrp_jupyter\n%)?lrp debug\b/.test(below.getSource())) below.setSource(source);
  else sharedModel.insertCell(index + 1, { cell_type: "code", source });
  const cell = `[data-windowed-list-index="${index + 1}"]`;
  (await appears(page, `.jp-Cell${cell} .cm-content`))?.focus(); // selects the cell, at the next frame
  const editor = await appears(page, `.jp-mod-editMode .jp-Cell.jp-mod-active${cell} .cm-content`);
  editor?.dispatchEvent(new KeyboardEvent("keydown", CTRL_ENTER));
  return "";
}

/** Wait for something that the notebook is about to draw. */
async function appears(page: ParentNode, selector: string): Promise<HTMLElement | null> {
  for (let frame = 0; frame < FRAMES; frame++) {
    const found = page.querySelector<HTMLElement>(selector);
    if (found) return found;
    await new Promise(requestAnimationFrame);
  }
  return null;
}
