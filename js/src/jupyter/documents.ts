/** The files that a lab shows: programs, and recordings. */

import { PathExt } from "@jupyterlab/coreutils";
import { ABCWidgetFactory, type DocumentRegistry, DocumentWidget } from "@jupyterlab/docregistry";
import type { ServiceManager } from "@jupyterlab/services";
import type { LabIcon } from "@jupyterlab/ui-components";
import { difference } from "../host/holder";
import { h } from "../ui/dom";
import { calledAfter } from "../ui/timers";
import { LabTab } from "./tab";

const EDITED = 300; // ms after which the lab gets what was edited elsewhere
const TYPED = 500; // ms after which the file has what was typed in the lab

/** The document is the program's text: what is typed in the lab is saved, what is edited elsewhere is in the lab. */
export class ProgramTab extends LabTab {
  /** The text that the kernel has. */
  private known = "";

  private get text() {
    return (this.context as DocumentRegistry.CodeContext).model.sharedModel;
  }

  protected override async open(): Promise<void> {
    const { model, localPath } = this.context;
    this.known = this.text.source;
    await this.call(
      "open_program",
      PathExt.basename(localPath, PathExt.extname(localPath)),
      this.known,
      this.isAgain,
    );
    model.contentChanged.connect(this.edited); // once, however often it is opened
  }

  override dispose(): void {
    if (!this.isDisposed) this.context.model.contentChanged.disconnect(this.edited);
    super.dispose();
  }

  private readonly edited = calledAfter(EDITED, () => {
    if (this.isDisposed || this.text.source === this.known) return;
    this.known = this.text.source;
    void this.call("reconcile", this.known);
  });

  private readonly save = calledAfter(TYPED, () => {
    if (this.isDisposed || this.context.model.collaborative) return;
    this.context.save().catch(() => {}); // it has told its user why
  });

  protected override received({ text }: Record<string, unknown>): void {
    if (typeof text !== "string") return;
    if (this.text.source !== this.known) return; // what is newer here is about to be sent
    this.known = text;
    const { start, end, inserted } = difference(this.text.source, text);
    this.text.updateSource(start, this.text.source.length - end, inserted);
    this.save();
  }
}

export class RecordingTab extends LabTab {
  protected override async open(trusted = false): Promise<void> {
    const error = await this.call("open_recording", PathExt.basename(this.context.localPath), trusted);
    if (error !== "StrangerError") return;
    const run = h(
      "button",
      { class: "jp-mod-styled jp-mod-accept", onclick: () => void this.open(true) },
      "Run it",
    );
    this.node.append(run);
  }
}

/** What makes the tabs of one kind. */
export class TabFactory extends ABCWidgetFactory<DocumentWidget<LabTab>> {
  constructor(
    private readonly tab: new (...given: ConstructorParameters<typeof LabTab>) => LabTab,
    private readonly icon: LabIcon,
    private readonly manager: ServiceManager.IManager,
    private readonly isRestoring: () => boolean,
    options: DocumentRegistry.IWidgetFactoryOptions<DocumentWidget<LabTab>>,
  ) {
    super(options);
  }

  protected override createNewWidget(context: DocumentRegistry.Context): DocumentWidget<LabTab> {
    const widget = new DocumentWidget({
      content: new this.tab(context, this.manager, this.isRestoring()),
      context,
    });
    widget.toolbar.hide();
    widget.title.icon = this.icon;
    return widget;
  }
}
