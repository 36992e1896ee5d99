/**
 * The editor: CodeMirror for LRP. What is typed here is ahead of the kernel's text until the kernel confirms it, and
 * is merged with what comes from elsewhere meanwhile: `@codemirror/collab` does that.
 */

import { closeBrackets } from "@codemirror/autocomplete";
import { collab, getSyncedVersion, receiveUpdates, sendableUpdates } from "@codemirror/collab";
import { redo, undo } from "@codemirror/commands";
import { bracketMatching, foldGutter, forceParsing, indentOnInput, indentUnit } from "@codemirror/language";
import { lintGutter } from "@codemirror/lint";
import { search } from "@codemirror/search";
import {
  type ChangeDesc,
  ChangeSet,
  Compartment,
  EditorState,
  type Extension,
  Prec,
  Text,
  Transaction,
} from "@codemirror/state";
import {
  EditorView,
  highlightActiveLine,
  highlightActiveLineGutter,
  keymap,
  lineNumbers,
  placeholder,
  tooltips,
} from "@codemirror/view";
import { followCursor } from "../graph/shown";
import { lrp, outlineOf } from "../language/lrp";
import type { Item } from "../language/outline";
import type { AnswerMessage, ElementKind, SnapshotMessage, TextRange, UpdateView } from "../protocol";
import type { Connection, Typed, Typist } from "../session/connection";
import { isJudged } from "../session/state";
import type { Lab } from "../session/store";
import { KeptSwitch } from "../ui/kept";
import { pointOf } from "../ui/point";
import { whenAttached } from "../ui/root";
import { alive } from "./alive";
import { completion } from "./complete";
import { contextAt } from "./context";
import { coverageGutter } from "./covered";
import { rememberCursor, rememberedCursor, reveal, select } from "./cursor";
import { severalCursors } from "./cursors";
import { Underlines } from "./diagnostics";
import { openFixes } from "./fixes";
import { format } from "./format";
import { breakpointGutter } from "./gutter";
import { otherHands, placeHands, typedBy } from "./hands";
import { hangingIndent } from "./hanging";
import { historyAtCursor } from "./history";
import { hover } from "./hover";
import { keys } from "./keys";
import { live, liveChanged, marksOf } from "./live";
import { goToDefinition, navigation, rename } from "./navigate";
import { Pen, renameOf, renames, sharedEffects } from "./pen";
import { rainbow } from "./rainbow";
import { scrubbing } from "./scrub";
import { steps } from "./steps";
import { taps } from "./tap";
import { difference, Tracked } from "./texts";
import { Typing } from "./typing";

const PARSE_FOR = 200; // ms: long enough to highlight a new text at once
const CURSOR_AFTER = 100; // ms: a cursor that moves on and on is sent so often
const MOST_UPDATES = 500; // of a message
const VALUES_AFTER = 200; // ms: values that change faster cannot be read, and each change lays out the page

/** Where cards may be: not cut off by the panel, nor below the window. */
function visiblePart(root: HTMLElement): { left: number; top: number; right: number; bottom: number } {
  const { left, top, right, bottom } = root.getBoundingClientRect();
  return { left, top: Math.max(0, top), right, bottom: Math.min(bottom, window.innerHeight) };
}

export class Editor implements Typist {
  readonly view: EditorView;
  readonly pen: Pen;
  /** The kernel's text, of the revision that is known here. */
  private confirmed = Text.empty;
  /** The text that the findings are about, and the running one. */
  private readonly judged = new Tracked();
  private readonly running = new Tracked();
  private readonly underlines = new Underlines();
  private readonly typing = new Typing(
    (hasCursor, meant) => this.send(hasCursor, meant),
    () => this.isOneOfSeveral,
  );
  /** The document of the kernel that this text is; empty before the first one. */
  private document = "";
  /** What is to be sent of the cursor, if anything: whether it is in the text, and whether its word is meant. */
  private cursor = { isDue: false, isHere: false, meant: true };
  private moving = 0;
  /** Whether values are shown in the text. */
  readonly values = new KeptSwitch("values", true, () => this.redraw());
  private readonly bracketColours = new Compartment();
  /** Whether brackets have colours by their depth. */
  readonly brackets = new KeptSwitch("brackets", true, () =>
    this.view.dispatch({ effects: this.bracketColours.reconfigure(this.brackets.on ? rainbow : []) }),
  );
  private readonly coverage = new Compartment();
  private isCovered = false;
  /** Called when the text has changed, other than by being opened. */
  onChange = (): void => {};
  /** The view that has changed the text last; empty for the kernel. */
  private lastHand = "";
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
      if (this.document) this.underlines.show(this.view, lab, this.judged, this.running);
    });
    store.watch(["breakpoints", "instance"], () => this.redraw());
    store.watch(["hands"], () => this.showHands());
    store.watch(["reached"], () => this.showReached());
    store.watch(["lit", "fired", "variables", "instances", "events", "program", "settings"], () =>
      this.update(),
    );
    store.watch(["members"], () => {
      if (marksOf(store.state) !== this.marks) this.update(); // a task, and not any reading
    });
  }

  private extensions(startVersion = 0): Extension {
    const { lab } = this;
    const nothing = () => true; // these would run the notebook's cell
    return [
      alive(() => this.view),
      lineNumbers(),
      breakpointGutter(lab),
      this.coverage.of(this.isCovered ? coverageGutter(lab.store.state) : []),
      lintGutter(),
      foldGutter(),
      collab({ startVersion, clientID: this.connection.view, sharedEffects }),
      severalCursors,
      otherHands,
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
      EditorView.clipboardInputFilter.of((text) => text.replace(/^\s*%%lrp\b.*\n?/, "")), // a whole cell
      this.bracketColours.of(this.brackets.on ? rainbow : []),
      tooltips({ parent: lab.root, tooltipSpace: () => visiblePart(lab.root) }),
      completion(lab),
      hover(lab),
      historyAtCursor(lab),
      navigation(lab),
      scrubbing(lab),
      taps(),
      followCursor(lab),
      live(lab.store.state, () => this.values.on),
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
        for (const text of [this.judged, this.running, this.underlines.text]) text.add(update.changes);
        if (!update.transactions.some((transaction) => transaction.annotation(Transaction.remote))) {
          this.lastHand = this.connection.view;
          this.typing.changed(update);
        }
        this.onChange();
      }),
    ];
  }

  private openLink(event: MouseEvent, view: EditorView): boolean {
    const offset = event.ctrlKey || event.metaKey ? view.posAtCoords(pointOf(event)) : null;
    if (offset === null) return false;
    void goToDefinition(view, this.lab, offset);
    return true;
  }

  private applyHeld(): boolean {
    if (this.lab.store.state.pending) void this.lab.act({ do: "apply" });
    return true;
  }

  private send(isHere: boolean, meant: boolean): void {
    this.cursor = { isDue: true, isHere, meant };
    if (this.isAhead || this.typing.waits) this.connection.text();
    else this.moving ||= window.setTimeout(() => this.sendCursor(), CURSOR_AFTER);
  }

  private sendCursor(): void {
    this.moving = 0;
    this.connection.text();
  }

  get text(): string {
    return this.view.state.sliceDoc();
  }

  get revision(): number {
    return getSyncedVersion(this.view.state);
  }

  get isAhead(): boolean {
    return this.document !== "" && sendableUpdates(this.view.state).length > 0;
  }

  /** The changes that the kernel has not confirmed, as one. */
  private get ahead(): ChangeDesc | null {
    const updates = this.document ? sendableUpdates(this.view.state) : [];
    return updates.reduce<ChangeDesc | null>(
      (all, { changes }) => (all ? all.composeDesc(changes) : changes),
      null,
    );
  }

  next(): Typed | null {
    if (!this.document) return null;
    const { state } = this.view;
    const { main, ranges } = state.selection;
    const { isDue, isHere, meant } = this.cursor;
    const all = sendableUpdates(state);
    const first = all.findIndex(({ effects }) => renameOf(effects)); // which is sent on its own
    const updates = all.slice(0, first === 0 ? 1 : first < 0 ? MOST_UPDATES : Math.min(first, MOST_UPDATES));
    const isAll = updates.length === all.length;
    if (isAll) this.cursor.isDue = false;
    const selection: [number, number] | null = isAll && isHere ? [main.anchor, main.head] : null;
    const cursors = selection ? ranges.filter((range) => range !== main).map(({ head }) => head) : [];
    if (!all.length)
      return isDue ? { type: "cursor", revision: this.revision, selection, meant, cursors } : null;
    const rename = first === 0 ? renameOf(all[0]!.effects) : null;
    return {
      type: "text",
      base: this.revision,
      updates: updates.map(({ changes }) => changes.toJSON()),
      selection,
      meant: meant || !isAll,
      rename: rename && [rename.kind, rename.path, rename.name],
      cursors,
    };
  }

  /**
   * A text of the kernel, with the changes that lead to it from the one known here. Returns the text of this editor
   * if it has changes that cannot be merged with that, else null.
   */
  begin({ document, text, revision, updates, running, half_typed }: SnapshotMessage): string | null {
    const isOther = document !== this.document || !updates;
    const left = isOther && this.isAhead ? this.text : null;
    if (isOther) this.open(text, revision);
    else this.receive(updates, revision);
    this.document = document;
    forceParsing(this.view, this.view.state.doc.length, PARSE_FOR);
    this.judged.begin(this.confirmed, this.ahead);
    if (isOther) this.underlines.text.become(this.judged); // it has no marks yet
    this.running.differs(this.view.state.toText(running), this.view.state.doc);
    this.typing.answered(half_typed);
    if (!this.view.hasFocus) this.typing.left(); // it was typed before the page was loaded again
    return left;
  }

  private open(text: string, revision: number): void {
    const cursor = this.document
      ? this.view.state.selection.main.head
      : rememberedCursor(this.lab.store.state.name);
    this.view.setState(EditorState.create({ doc: text, extensions: this.extensions(revision) }));
    this.confirmed = this.view.state.doc;
    const head = Math.min(cursor, this.confirmed.length);
    this.view.dispatch({ selection: { anchor: head } });
    reveal(this.view, head);
  }

  /**
   * Handle updates that lead to a revision: others' are merged with what is ahead here, own ones confirm it. They
   * are mapped one by one, as the kernel does it.
   */
  private receive(updates: UpdateView[], revision: number): void {
    const known = this.revision - (revision - updates.length);
    for (const { view, changes } of updates.slice(Math.max(0, known))) {
      this.lastHand = view;
      const update = { changes: ChangeSet.fromJSON(changes), clientID: view, effects: [typedBy.of(view)] };
      this.view.dispatch(receiveUpdates(this.view.state, [update]));
      this.confirmed = update.changes.apply(this.confirmed);
    }
    this.showHands();
  }

  /** Handle the answer to a text; it is running if `applied`. */
  wasAnswered(answer: AnswerMessage): void {
    const { updates, revision, applied, running, half_typed } = answer;
    this.receive(updates, revision);
    if (isJudged(answer)) this.judged.begin(this.confirmed, this.ahead);
    if (applied) this.running.begin(this.confirmed, this.ahead);
    else if (running !== null) this.running.differs(this.view.state.toText(running), this.view.state.doc);
    if (this.connection.isAnswered) this.typing.answered(half_typed);
  }

  /** Whether another view has an editor, too, and shows the cursor of this one. */
  private get isOneOfSeveral(): boolean {
    return Object.keys(this.lab.store.state.hands).length > 1;
  }

  /** Whether of all views with an editor this one has changed the text last, or stands for one that is gone. */
  get isLast(): boolean {
    const { view } = this.connection;
    const hands = Object.keys(this.lab.store.state.hands);
    return this.lastHand === view || (!hands.includes(this.lastHand) && view === (hands.sort()[0] ?? view));
  }

  private wasOneOfSeveral = false;

  /** Show the cursors of other views, as soon as the text that they refer to is known. */
  private showHands(): void {
    const { hands } = this.lab.store.state;
    if (this.isOneOfSeveral !== this.wasOneOfSeveral) {
      this.wasOneOfSeveral = this.isOneOfSeveral;
      if (this.view.hasFocus) this.send(true, this.cursor.meant);
    }
    const others = Object.entries(hands).filter(([view]) => view !== this.connection.view);
    if (!this.document || others.some(([, hand]) => hand.revision !== this.revision)) return;
    placeHands(this.view, others, this.ahead);
  }

  close(): void {
    clearTimeout(this.moving);
    this.typing.stop();
    this.view.destroy();
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

  private showReached(): void {
    const { state } = this.lab.store;
    const isCovered = state.reached !== null;
    if (isCovered === this.isCovered) {
      if (isCovered) this.redraw();
      return;
    }
    this.isCovered = isCovered;
    this.view.dispatch({ effects: this.coverage.reconfigure(isCovered ? coverageGutter(state) : []) });
  }

  undo(): void {
    undo(this.view);
  }

  redo(): void {
    redo(this.view);
  }

  goTo(kind: ElementKind, path: string): Item | undefined {
    const item = outlineOf(this.view.state).find(kind, path);
    if (item) select(this.view, item.nameFrom, item.nameTo);
    return item;
  }

  goToRange(range: TextRange, ofRunning: boolean): void {
    const span = (ofRunning ? this.running : this.judged).span(range);
    if (span) select(this.view, span.from, span.to);
  }

  rename(kind: ElementKind, path: string): void {
    const item = this.goTo(kind, path);
    if (item) void rename(this.view, this.lab, item.nameFrom);
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
