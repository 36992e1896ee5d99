/** A lab in a tab of its own, with a kernel of its own, which ends with the tab. */

import { SessionContext } from "@jupyterlab/apputils";
import { PathExt } from "@jupyterlab/coreutils";
import type { DocumentRegistry } from "@jupyterlab/docregistry";
import type { Kernel, KernelMessage, KernelSpec, ServiceManager } from "@jupyterlab/services";
import { Widget } from "@lumino/widgets";
import { h, prose } from "../ui/dom";
import { drawn, LabModel, onOpened } from "./widget";

const PATIENCE = 5000; // ms until a kernel that was restarted is connected again, and twice that next time
const MODULE = "lrp_jupyter.widgets.documents";
const LACKING =
  "The kernel of this tab has no `lrp_jupyter`. Install it where the kernel runs: `pip install lrp-jupyter`.";

/** The path of the tab's session: an editor would take one with the path of the file for its own. */
const sessionOf = (path: string) => `${path}.lab`;

export abstract class LabTab extends Widget {
  private readonly session: SessionContext;
  private readonly kernelspecs: KernelSpec.IManager;
  private starting: Promise<void> | null = null;
  private kernel: Kernel.IKernelConnection | null = null;
  private stop: () => void = () => {};
  private again: ReturnType<typeof setTimeout> | undefined;

  constructor(
    protected readonly context: DocumentRegistry.Context,
    { sessions, kernels, kernelspecs }: ServiceManager.IManager,
    /** Whether the lab is opened again, by a page that is restored, or in the place of a kernel that has ended. */
    protected isAgain: boolean,
  ) {
    super();
    this.addClass("lrp-document");
    this.kernelspecs = kernelspecs;
    this.session = new SessionContext({
      sessionManager: sessions,
      specsManager: kernelspecs,
      kernelManager: kernels,
      path: sessionOf(context.localPath),
      name: PathExt.basename(context.localPath),
      type: "lrp",
    });
    context.pathChanged.connect(this.moved);
  }

  private readonly moved = () => void this.session.session?.setPath(sessionOf(this.context.localPath));

  protected override onAfterAttach(): void {
    this.starting ??= this.start(); // Notebook makes a widget that another page then shows
  }

  /** Open the lab in the kernel. */
  protected abstract open(): Promise<void>;

  /** Handle a message of the kernel that is not for the lab. */
  protected received(_content: Record<string, unknown>): void {}

  /** Call a function of Python, with texts and truths, and say what is wrong; returns the name of the error. */
  protected async call(name: string, ...values: (string | boolean)[]): Promise<string> {
    const written = values.map((value) =>
      value === true ? "True" : value === false ? "False" : JSON.stringify(value),
    );
    const code = `import ${MODULE} as _lrp\n_lrp.${name}(${written.join(", ")})`;
    const reply = await this.kernel?.requestExecute({ code, store_history: false }).done;
    if (reply?.content.status !== "error") return "";
    const { ename, evalue } = reply.content as KernelMessage.IReplyErrorContent;
    const sentence = evalue.endsWith(".") ? evalue : `${ename}: ${evalue}`; // else it is not one of ours
    this.say(ename === "ModuleNotFoundError" ? LACKING : sentence);
    return ename;
  }

  /** Show a sentence in place of the lab. */
  protected say(sentence: string): void {
    this.clear();
    this.node.replaceChildren(h("p", { class: "lrp-document-says" }, ...prose(sentence)));
  }

  private begin(): void {
    this.kernel = null;
    this.say("Starting a kernel …");
  }

  private async start(): Promise<void> {
    this.begin();
    await Promise.all([this.context.ready, this.kernelspecs.ready]);
    if (this.isDisposed) return;
    const { default: first = "", kernelspecs = {} } = this.kernelspecs.specs ?? {};
    const names = [first, ...Object.keys(kernelspecs)];
    const name = names.find((each) => kernelspecs[each]?.language === "python");
    if (!name)
      return this.say("This Jupyter has no Python kernel, which a lab needs: `pip install ipykernel`.");
    this.session.kernelPreference = { name, shutdownOnDispose: true };
    this.session.statusChanged.connect((_, status) => {
      if (status.endsWith("restarting")) {
        this.begin();
        this.connectAgain(PATIENCE);
      }
      if (status === "dead") this.say("The kernel ended. Close this tab, and open the file again.");
    });
    this.session.connectionStatusChanged.connect((_, status) => {
      if (status === "connected") this.hear();
    });
    await this.session.initialize();
    await this.session.ready;
    await this.fill();
  }

  /** Show the lab of a restarted kernel once it is heard: before something is run in it, no status tells. */
  private hear(): void {
    const kernel = this.session.session?.kernel;
    if (!kernel || kernel === this.kernel) return;
    const asked = kernel.requestKernelInfo();
    void asked.then(
      () => this.fill(),
      () => {}, // it has restarted again
    );
  }

  /** Connect until there is a lab: a connection may lead to where the old kernel was, and then says nothing. */
  private connectAgain(wait: number): void {
    this.again = setTimeout(() => {
      this.session.session?.kernel?.reconnect().catch(() => {});
      this.connectAgain(2 * wait);
    }, wait);
  }

  /** Show the lab of a kernel that is new here. */
  private async fill(): Promise<void> {
    const kernel = this.session.session?.kernel;
    if (!kernel || kernel === this.kernel) return;
    this.kernel = kernel;
    clearTimeout(this.again);
    const received = (content: Record<string, unknown>) => this.received(content);
    onOpened(kernel, (comm, state) => void this.draw(new LabModel(comm, state, received)));
    await this.open();
    this.isAgain = true;
  }

  private async draw(model: LabModel): Promise<void> {
    this.clear();
    this.stop = await drawn(model, this.node);
  }

  private clear(): void {
    clearTimeout(this.again);
    this.stop();
    this.stop = () => {};
  }

  override dispose(): void {
    if (this.isDisposed) return;
    this.clear();
    this.context.pathChanged.disconnect(this.moved);
    this.session.dispose();
    super.dispose();
  }
}
