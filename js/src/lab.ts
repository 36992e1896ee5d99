/** One view of a session: the whole lab, or the one part that the `view` trait names. */

import { keepInPlace } from "./editor/anchor";
import { Editor } from "./editor/editor";
import { graphView } from "./graph/view";
import { cellAround, type HostedModel, runBelow } from "./host/notebook";
import { cellSource } from "./host/source";
import { breakpointsView } from "./parts/breakpointlist";
import { controls } from "./parts/controls";
import { coverageSwitch } from "./parts/coverage";
import { editorPanel } from "./parts/editor";
import { glances } from "./parts/glance";
import { goalView } from "./parts/goal";
import { type Inspector, inspector } from "./parts/inspector";
import { errorsIn, issuesView } from "./parts/issues";
import { attachForm, keepForm } from "./parts/keep";
import type { Choices } from "./parts/menu";
import { announcer, notes } from "./parts/notes";
import { openForm } from "./parts/open";
import { restarts } from "./parts/restarts";
import { runsView } from "./parts/runs";
import { saveForm } from "./parts/save";
import { looked, recorded, watchPointer, withheld } from "./parts/study";
import { together } from "./parts/together";
import { treeView } from "./parts/tree";
import { variablesView } from "./parts/variables";
import { versionsForm } from "./parts/versions";
import type { FromKernel, PartName, ReplyMessage } from "./protocol";
import { Connection, type Model } from "./session/connection";
import { forgetLost, keepLost, lostTexts } from "./session/lost";
import { reportChanges } from "./session/reports";
import { apply } from "./session/state";
import { steady } from "./session/steady";
import { type Lab, Store } from "./session/store";
import { band, Looking } from "./timeline/looking";
import { timelineView } from "./timeline/view";
import { askWhatIf } from "./timeline/what_if";
import { copyText } from "./ui/clipboard";
import { h, prose, setAttribute } from "./ui/dom";
import { enlarging } from "./ui/enlarge";
import { useFingers } from "./ui/fingers";
import { Layout, type Panels, WITHHELD } from "./ui/layout";
import { bringIntoSight, fitHeight } from "./ui/sight";
import { watchTheme } from "./ui/theme";
import { stepOf } from "./ui/undo";
import { robotView } from "./world/members";
import { type WorldPart, worldView } from "./world/view";

const TOAST_TIME = 6000; // ms that an error stays

export function openLab(model: Model & HostedModel, part: PartName, host: HTMLElement): () => void {
  const store = new Store();
  const root = h("div", {
    class: "lrp-lab",
    "data-lrp": part === "lab" ? "lab" : null,
    "data-part": part,
    "data-lm-suppress-shortcuts": "true",
  });
  host.classList.add("lrp-host");
  host.append(root);
  const toast = h("div", { class: "lrp-toast", role: "alert", popover: "manual", hidden: true });
  let toastTimer: ReturnType<typeof setTimeout> | undefined;
  const showToast = (on: boolean) => {
    toast.hidden = !on;
    if (toast.isConnected) toast.togglePopover?.(on); // in view wherever the notebook is scrolled to
  };
  const closing = new AbortController();
  let editor: Editor | null = null;
  let world: WorldPart | null = null;
  let inspecting: Inspector | null = null;
  let rescued = false;
  let opened = false;

  const lab: Lab = {
    store,
    root,
    closed: closing.signal,
    async act(act, quiet = false) {
      const { error } = await connection.command(act);
      if (error && !quiet) lab.notify(error);
      return error;
    },
    send: (act) => connection.send(act),
    ask: (question): Promise<ReplyMessage> => connection.ask(question),
    tell: (looked) => connection.tell({ type: "looked", ...looked }),
    goTo(kind, path) {
      if (editor) editor.goTo(kind, path);
      else elsewhere.send({ goTo: { kind, path } });
    },
    goToRange(range, ofRunning) {
      if (editor) editor.goToRange(range, ofRunning);
      else elsewhere.send({ range, ofRunning });
    },
    rename: (kind, path) => editor?.rename(kind, path),
    async insert(text) {
      if (editor?.insert(text)) return;
      const copied = await copyText(text);
      lab.notify(
        `${copied ? `\`${text}\` is copied. ` : ""}To insert it with a click, put the cursor into a block \`[ ]\`.`,
      );
    },
    async runBelow(source) {
      const place = cellAround(model, root);
      if (place) {
        const sentence = await runBelow(place, source);
        if (sentence) lab.notify(sentence);
        return;
      }
      const copied = await copyText(source);
      lab.notify(`${copied ? "The command is copied. Run it" : `Run \`${source}\``} in a cell.`);
    },
    get pen() {
      return editor?.pen ?? null;
    },
    inspect: (kind, path) => inspecting?.open(kind, path),
    notify(sentence) {
      toast.replaceChildren(...prose(sentence));
      showToast(true);
      clearTimeout(toastTimer);
      toastTimer = setTimeout(() => showToast(false), TOAST_TIME);
    },
  };

  const connection = new Connection(model, part, {
    message: receive,
    link: steady((link) => {
      store.set("link", link);
      rescue();
    }, closing.signal),
    get typist() {
      return editor;
    },
    unanswered: () => rescue(true),
  });
  const elsewhere = together(store, (message) => {
    if (message.goTo) editor?.goTo(message.goTo.kind, message.goTo.path);
    if (message.range) editor?.goToRange(message.range, message.ofRunning ?? false);
  });

  function receive(message: FromKernel, buffers: DataView[]): void {
    if (message.type === "reply") return;
    store.touch(apply(store.state, message));
    if (message.type === "snapshot") {
      const left = editor?.begin(message) ?? null;
      forget();
      if (left !== null) keepLost(store.state, connection.view, left);
      void recover(message.text);
      if (part === "lab" && !opened) requestAnimationFrame(() => bringIntoSight(root));
      opened = true;
    }
    if (message.type === "answer") {
      editor?.wasAnswered(message);
      forget();
    }
    world?.message(message, buffers);
  }

  /** Offer what was typed into earlier views of this program and has not reached a kernel. */
  async function recover(text: string): Promise<void> {
    if (!editor || !connection.isAnswered) return;
    const { home, tab_only } = store.state;
    for (const [view, lost] of lostTexts({ home, tab_only })) {
      const isAsked = lost !== text || store.state.conflict; // whether it continues a text that is asked about
      if (isAsked && (await connection.command({ do: "recover", text: lost })).error) return;
      forgetLost({ home, tab_only }, view);
    }
  }

  /** Keep the text if the kernel has not answered it, is silent since, or has ended and could not keep it. */
  function rescue(isNew = false): void {
    const { link, tab_only, unkept } = store.state;
    const isLost = link === "lost" || (link === "dead" && (tab_only || unkept));
    if (!editor || !(isNew || !connection.isAnswered || isLost)) return;
    keepLost(store.state, connection.view, editor.text);
    rescued = true;
  }

  /** Forget the text of this view, as soon as the kernel has it. */
  function forget(): void {
    if (!rescued || !connection.isAnswered) return;
    forgetLost(store.state, connection.view);
    rescued = false;
  }

  const looking = new Looking(lab);
  const wanted = (name: PartName) => part === "lab" || part === name;
  if (wanted("editor")) editor = new Editor(lab, connection);
  if (wanted("world")) world = worldView(lab, looking);
  inspecting = inspector(lab);
  const coverage = coverageSwitch(lab);
  const keeping = keepForm(lab);
  const attaching = attachForm(lab);
  const panels = {
    goal: wanted("goal") ? goalView(lab, part === "lab" ? () => layout?.choose("runs") : null) : null,
    editor: editor && editorPanel(lab, editor),
    tree: wanted("tree") ? treeView(lab) : null,
    graph: wanted("graph") ? graphView(lab) : null,
    world: world?.element ?? null,
    variables: wanted("variables") ? variablesView(lab) : null,
    robot: wanted("world") ? robotView(lab) : null,
    issues: wanted("issues") ? issuesView(lab) : null,
    runs: wanted("issues") ? runsView(lab, coverage, keeping.open, attaching.open) : null,
    breakpoints: wanted("issues") ? breakpointsView(lab) : null,
  };
  const layout = part === "lab" ? new Layout(panels as Panels) : null; // a whole lab has all of them
  const height = part === "lab" ? fitHeight(root) : null;
  const { isFilling, fill } = enlarging(host, root, layout);
  const save = saveForm(lab);
  const text = () => editor?.text ?? "";
  const versions = versionsForm(lab, text);
  const opening = openForm(lab, text);
  const cell = editor && cellSource(model, lab, editor);
  const choices: Choices = {
    layout,
    resetSizes: () => {
      layout?.reset();
      height?.reset();
    },
    fills: { shown: isFilling, show: fill },
    editor,
    save: save.open,
    versions: versions.open,
    open: opening.open,
    cell,
  };
  const { notice, counter } = restarts(lab);
  const isControlled = part === "lab" || part === "controls";
  if (isControlled) root.append(controls(lab, choices, counter));
  if (part !== "lab") root.append(band(lab, looking));
  const [alone, ...below] = Object.values(panels).filter((panel) => panel !== null);
  if (layout) root.append(layout.element);
  else if (alone) {
    alone.append(...below);
    root.append(alone);
  }
  if (part === "lab") root.append(timelineView(lab, looking, keeping.open));
  if (!isControlled) root.append(recorded(lab));
  const forms = [save, versions, opening, keeping, attaching].map(({ element }) => element);
  root.append(h("div", { class: "lrp-notes" }, ...forms, notes(lab, text), notice));
  root.append(inspecting.element, toast, announcer(lab));

  if (part === "lab" || part === "world") askWhatIf(lab);
  store.watch(["settings"], () => {
    const { settings } = store.state;
    const away = withheld(settings);
    if (layout) layout.withhold(away);
    else
      for (const [name, panel] of Object.entries(panels))
        panel?.toggleAttribute(WITHHELD, away.includes(name));
  });
  if (layout) {
    layout.told = (panel, on) => looked(lab, "panel", panel, on);
    layout.holding = (change) => (editor ? keepInPlace(editor.view, change) : change());
    store.watch(["looking"], () => layout.lookBack(store.state.looking !== null));
    let errors = 0;
    store.watch(["findings", "issues"], () => {
      const before = errors;
      errors = errorsIn(store.state);
      if (errors > before) layout.call("issues");
      else if (!errors) layout.call(null);
    });
  }
  useFingers(root);
  watchPointer(lab);
  glances(lab);
  reportChanges(model, lab);
  store.watch(["tick", "revision", "status", "link"], () => {
    const { tick, revision, status, link } = store.state;
    setAttribute(root, "data-lrp-tick", tick);
    setAttribute(root, "data-lrp-revision", revision);
    setAttribute(root, "data-lrp-status", link === "dead" ? "dead" : status); // nothing runs without a kernel
    setAttribute(root, "data-link", link);
  });
  root.addEventListener("keydown", (event) => {
    event.stopPropagation(); // or the notebook, too, would act on it: `x` cuts away the cell
    const step = stepOf(event);
    if (step && editor) {
      event.preventDefault(); // or the browser would undo what was typed, and could not redo it
      editor[step]();
    }
    const saves = event.key.toLowerCase() === "s" && (event.ctrlKey || event.metaKey);
    if (!saves || event.shiftKey || event.altKey) return;
    event.preventDefault();
    host.dispatchEvent(new KeyboardEvent("keydown", event)); // saves the notebook, as everywhere else in it
  });
  watchTheme(root, closing.signal);
  window.addEventListener("pagehide", () => rescue(), { signal: closing.signal });
  return () => {
    closing.abort();
    rescue();
    height?.close();
    layout?.close();
    elsewhere.close();
    connection.close();
    cell?.close();
    store.close();
    editor?.close();
    root.remove();
  };
}
