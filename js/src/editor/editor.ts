/** The editor: CodeMirror for LRP. It sends what is typed; the kernel's echo never changes the document. */

import { closeBrackets } from "@codemirror/autocomplete";
import { bracketMatching, foldGutter, forceParsing, indentOnInput, indentUnit } from "@codemirror/language";
import { lintGutter } from "@codemirror/lint";
import { search } from "@codemirror/search";
import { Compartment, EditorState, type Extension, Prec, Text } from "@codemirror/state";
import {
  EditorView,
  highlightActiveLine,
  highlightActiveLineGutter,
  keymap,
  lineNumbers,
  placeholder,
  tooltips,
  type ViewUpdate,
} from "@codemirror/view";
import { showTyped } from "../graph/shown";
import { lrp, outlineOf } from "../language/lrp";
import type { AnswerMessage, ElementKind, TextRange } from "../protocol";
import type { Connection } from "../session/connection";
import type { Lab } from "../session/store";
import { isOn, keepOn } from "../ui/kept";
import { whenAttached } from "../ui/root";
import { completion } from "./complete";
import { contextAt } from "./context";
import { rememberCursor, rememberedCursor, reveal, select } from "./cursor";
import { showDiagnostics } from "./diagnostics";
import { openFixes } from "./fixes";
import { format } from "./format";
import { breakpointGutter } from "./gutter";
import { hangingIndent } from "./hanging";
import { hover } from "./hover";
import { keys } from "./keys";
import { live, liveChanged, marksOf } from "./live";
import { goToDefinition, navigation, rename } from "./navigate";
import { Pen, renameOf, renames } from "./pen";
import { lineSeparator, placeOf } from "./places";
import { rainbow } from "./rainbow";
import { scrubbing } from "./scrub";
import { steps } from "./steps";
import { adopt, adopted, difference, Tracked } from "./texts";
import { Typing } from "./typing";

const PARSE_FOR = 200; // ms: long enough to highlight a new text at once
const VALUES_AFTER = 200; // ms: values that change faster cannot be read, and each change lays out the page

/** Where cards may be: not cut off by the panel, nor below the window. */
function visiblePart(root: HTMLElement): { left: number; top: number; right: number; bottom: number } {
  const { left, top, right, bottom } = root.getBoundingClientRect();
  return { left, top: Math.max(0, top), right, bottom: Math.min(bottom, window.innerHeight) };
}

export class Editor {
  readonly view: EditorView;
  readonly pen: Pen;
  /** The text in flight, the last one answered, and the running one. */
  private readonly onItsWay = new Tracked();
  private readonly answered = new Tracked();
  private readonly running = new Tracked();
  private readonly typing = new Typing((hasCursor, meant) => this.send(hasCursor, meant));
  private began = false;
  private values = isOn("values", true);
  private readonly brackets = new Compartment();
  private colours = isOn("brackets", true);
  private marks = "";
  private redrawing = 0;

  constructor(
    private readonly lab: Lab,
    private readonly connection: Connection,
  ) {
    this.view = new EditorView({ state: EditorState.create({ extensions: this.extensions() }) });
    whenAttached(lab.root, lab.closed, (tree) => this.view.setRoot(tree));
    this.pen = new Pen(this.view, lab);
    const { store } = lab;
    store.watch(["findings", "issues", "revision"], () => {
      if (this.began) showDiagnostics(this.view, store.state, this.answered, this.running);
    });
    store.watch(["breakpoints"], () => this.redraw());
    store.watch(["lit", "fired", "variables", "events", "program"], () => this.update());
  }

  private extensions(): Extension {
    const { lab } = this;
    const nothing = () => true; // these would run the notebook's cell
    return [
      lineNumbers(),
      breakpointGutter(lab),
      lintGutter(),
      foldGutter(),
      steps,
      renames,
      indentUnit.of("  "),
      indentOnInput(),
      bracketMatching(),
      closeBrackets(),
      highlightActiveLine(),
      highlightActiveLineGutter(),
      search({ top: true }),
      EditorView.lineWrapping,
      hangingIndent,
      lrp(),
      this.brackets.of(this.colours ? rainbow : []),
      tooltips({ parent: lab.root, tooltipSpace: () => visiblePart(lab.root) }),
      completion(lab),
      hover(lab),
      navigation(lab),
      scrubbing,
      showTyped(lab),
      live(lab.store.state, () => this.values),
      placeholder("(machine follower …) (spawn follower moving)"),
      Prec.high(
        keymap.of([
          { key: "Mod-Enter", run: () => this.applyHeld() },
          { key: "Shift-Alt-f", run: () => this.format() },
          { key: "Mod-.", run: (view) => openFixes(view, lab) },
          { key: "Shift-Enter", run: nothing },
          { key: "Mod-Shift-Enter", run: nothing },
        ]),
      ),
      keymap.of(keys),
      EditorView.contentAttributes.of({
        tabindex: "0",
        "aria-label": "LRP program; Escape, then Tab leaves the editor",
      }),
      EditorView.domEventHandlers({
        mousedown: (event, view) => this.openLink(event, view),
        blur: () => this.typing.left(),
      }),
      EditorView.updateListener.of((update) => {
        if (update.selectionSet) rememberCursor(lab.store.state.name, update.state.selection.main.head);
        if (!update.docChanged) {
          if (update.selectionSet) this.typing.moved(update);
          return;
        }
        for (const text of [this.onItsWay, this.answered, this.running]) text.add(update.changes);
        if (!update.transactions.some((transaction) => transaction.annotation(adopted)))
          void this.sendChange(update);
      }),
    ];
  }

  private async sendChange(update: ViewUpdate): Promise<void> {
    const rename = renameOf(update);
    if (rename && !(await this.lab.act({ do: "rename", ...rename }, true))) return;
    this.typing.changed(update);
  }

  private openLink(event: MouseEvent, view: EditorView): boolean {
    const offset =
      event.ctrlKey || event.metaKey ? view.posAtCoords({ x: event.clientX, y: event.clientY }) : null;
    if (offset === null) return false;
    void goToDefinition(view, this.lab, offset);
    return true;
  }

  private applyHeld(): boolean {
    if (this.lab.store.state.pending) void this.lab.act({ do: "apply" });
    return true;
  }

  private send(hasCursor: boolean, meant: boolean): void {
    const { doc, selection } = this.view.state;
    const place = hasCursor ? placeOf(doc, selection.main.head) : null;
    this.connection.text(this.text, place && [place.line, place.column], meant);
  }

  get text(): string {
    return this.view.state.sliceDoc();
  }

  /** The text of a session that this view did not know; `running` is the program's. */
  begin(text: string, running: string, halfTyped: boolean): void {
    if (!this.began) this.open(text, rememberedCursor(this.lab.store.state.name));
    else if (this.text !== text && !this.connection.inFlight) this.put(text);
    this.began = true;
    forceParsing(this.view, this.view.state.doc.length, PARSE_FOR);
    this.answered.differs(this.view.state.toText(text), this.view.state.doc);
    this.onItsWay.copy(this.answered);
    this.running.differs(this.view.state.toText(running), this.view.state.doc);
    this.typing.answered(halfTyped);
    if (!this.view.hasFocus) this.typing.left(); // it was typed before the page was loaded again
  }

  private put(text: string): void {
    const separator = lineSeparator(text);
    const same = !/[\r\n]/.test(text) || (separator ?? "\n") === this.view.state.lineBreak;
    if (same) adopt(this.view, text);
    else this.open(text, this.view.state.selection.main.head); // an editor's line ends are for its life
  }

  private open(text: string, cursor: number): void {
    const separator = lineSeparator(text);
    const extensions: Extension[] = [this.extensions()];
    if (separator) extensions.push(EditorState.lineSeparator.of(separator));
    this.view.setState(EditorState.create({ doc: text, extensions }));
    const head = Math.min(cursor, this.view.state.doc.length);
    this.view.dispatch({ selection: { anchor: head } });
    reveal(this.view, head);
  }

  /** Apply a text from elsewhere (another view, a rename, a cell). What is typed here is newer and kept. */
  replaceText(text: string): void {
    if (!this.connection.inFlight) {
      this.put(text);
      this.onItsWay.begin(this.view.state.doc);
    }
  }

  /** Handle an answer to the text in flight or to one that replaced it; it is running if `applied`. */
  wasAnswered({ applied, running, half_typed, seq }: AnswerMessage): void {
    this.answered.copy(this.onItsWay);
    if (applied) this.running.copy(this.onItsWay);
    else if (running !== null) this.running.differs(this.view.state.toText(running), this.view.state.doc);
    if (seq && this.connection.isAnswered) this.typing.answered(half_typed);
  }

  close(): void {
    this.typing.stop();
    this.view.destroy();
  }

  /** Record the text that is being sent; called before each sending. */
  markSent(): void {
    this.onItsWay.begin(this.view.state.doc);
  }

  get showsValues(): boolean {
    return this.values;
  }

  showValues(on: boolean): void {
    keepOn("values", on);
    this.values = on;
    this.redraw();
  }

  /** Whether brackets have colours by their depth. */
  get showsBrackets(): boolean {
    return this.colours;
  }

  showBrackets(on: boolean): void {
    keepOn("brackets", on);
    this.colours = on;
    this.view.dispatch({ effects: this.brackets.reconfigure(on ? rainbow : []) });
  }

  format(): boolean {
    void format(this.view, this.lab);
    return true;
  }

  /** Draw the program's run: its marks at once, values alone now and then. */
  private update(): void {
    const marks = marksOf(this.lab.store.state);
    if (marks !== this.marks) this.redraw();
    else this.redrawing ||= window.setTimeout(() => this.redraw(), VALUES_AFTER);
    this.marks = marks;
  }

  private redraw(): void {
    clearTimeout(this.redrawing);
    this.redrawing = 0;
    this.view.dispatch({ effects: liveChanged.of(null) });
  }

  goTo(kind: ElementKind, path: string): void {
    const item = outlineOf(this.view.state).find(kind, path);
    if (item) select(this.view, item.nameFrom, item.nameTo);
  }

  goToRange(range: TextRange, ofRunning: boolean): void {
    const span = (ofRunning ? this.running : this.answered).span(range);
    if (span) select(this.view, span.from, span.to);
  }

  rename(kind: ElementKind, path: string): void {
    const item = outlineOf(this.view.state).find(kind, path);
    if (!item) return;
    select(this.view, item.nameFrom, item.nameTo);
    void rename(this.view, this.lab, item.nameFrom);
  }

  /** Replace the text as if the new one were typed: it is sent, and can be undone. */
  edit(text: string): void {
    const { doc } = this.view.state;
    const changes = difference(doc, Text.of(text.split(/\r\n?|\n/)));
    if (changes) this.view.dispatch({ changes });
  }

  /** Insert a piece of Python at the cursor; returns false if no block is there. */
  insert(text: string): boolean {
    if (contextAt(this.view.state, this.view.state.selection.main.head).wanted !== "python") return false;
    this.view.dispatch(this.view.state.replaceSelection(text), { scrollIntoView: true });
    this.view.focus();
    return true;
  }
}
