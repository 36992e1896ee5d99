/** The state of one view, and its watchers, which are called at most once per animation frame. */

import type { Pen } from "../editor/pen";
import type { ElementKind, Looked, ReplyMessage, TextRange } from "../protocol";
import type { Act, Question } from "./connection";
import { initialState, type LabState, type Topic } from "./state";

type Update = (changed: ReadonlySet<Topic>) => void;

export class Store {
  readonly state: LabState = initialState();
  private readonly watchers = new Set<{ topics: readonly Topic[]; update: Update }>();
  private changed = new Set<Topic>();
  private scheduled = 0;

  /** Call `update` whenever one of these topics has changed, and once at the start. */
  watch(topics: readonly Topic[], update: Update): () => void {
    const watcher = { topics, update };
    this.watchers.add(watcher);
    update(new Set(topics));
    return () => this.watchers.delete(watcher);
  }

  /** Record changes; the watchers are called before the next animation frame. */
  touch(topics: Iterable<Topic>): void {
    for (const topic of topics) this.changed.add(topic);
    if (this.scheduled || !this.changed.size) return;
    this.scheduled = requestAnimationFrame(() => {
      const { changed } = this;
      this.changed = new Set();
      this.scheduled = 0;
      for (const { topics, update } of this.watchers) {
        if (!topics.some((topic) => changed.has(topic))) continue;
        try {
          update(changed);
        } catch (error) {
          reportError(error); // the others are called all the same
        }
      }
    });
  }

  set<K extends keyof LabState>(key: K, value: LabState[K]): void {
    if (this.state[key] === value) return;
    this.state[key] = value;
    this.touch([key]);
  }

  close(): void {
    cancelAnimationFrame(this.scheduled);
    this.watchers.clear();
  }
}

/** The interface that the parts of the lab use: the state, commands and requests. */
export interface Lab {
  readonly store: Store;
  /** Send a command; resolves to its error, which is also shown (unless quiet), or null. */
  act(act: Act, quiet?: boolean): Promise<string | null>;
  /** Send a command without a reply. */
  send(act: Act): void;
  ask(question: Question): Promise<ReplyMessage>;
  /** See `looked` in `parts/study.ts`. */
  tell(looked: { what: Looked; about: string; on: boolean }): void;
  /** Show the source of an element. */
  goTo(kind: ElementKind, path: string): void;
  goToRange(range: TextRange, ofRunning: boolean): void;
  inspect(kind: ElementKind, path: string): void;
  rename(kind: ElementKind, path: string): void;
  /** Insert Python into the block at the cursor; copy it if there is none. */
  insert(text: string): void;
  /** Run code in the cell below; copy it where that is not possible. */
  runBelow(source: string): void;
  /** Writes what is drawn on the graph into the text; null in a view without an editor. */
  readonly pen: Pen | null;
  /** Show a sentence for some seconds. */
  notify(sentence: string): void;
  readonly root: HTMLElement;
  /** Aborted when the view is closed: ends what listens outside of it. */
  readonly closed: AbortSignal;
}
