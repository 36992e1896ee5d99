/**
 * The plain page: one lab and no notebook. Python and the simulator run in a worker of this page, and what is
 * typed stays in this browser until its owner shares a link.
 */

import type lab from "../index";
import { copyText } from "../ui/clipboard";
import { h } from "../ui/dom";
import { addressOf, readAddress, type Wanted } from "./address";
import { keepFiles } from "./keeping";
import type { Site } from "./messages";
import { writeNotebook } from "./notebook";
import { Python } from "./python";
import { element, say } from "./said";

const HUNG = "lrp-hung"; // in this tab's storage: Python was ended because it did not answer
const UNKEPT =
  "This browser does not keep what you type here: its storage cannot be used. Share makes a link that contains it.";
const VERSION = new URL(import.meta.url).search; // of the site: `?v=…`

const base = new URL("./", location.href);
const file = (name: string) => new URL(name + VERSION, base);
const host = element("lab");

class Page {
  private wanted: Wanted = {};
  private isKept = true;
  private close: () => void = () => {};
  private readonly python = new Python(file("worker.js"), {
    step: (step) => say(`${step} …`),
    silent: (on) => {
      element("silent").hidden = !on;
    },
    unkept: () => this.warn(),
  });

  constructor(
    private readonly site: Site,
    private readonly render: typeof lab.render,
  ) {}

  async start(): Promise<void> {
    this.fillPicker();
    const jobs = { share: () => this.share(), notebook: () => this.openNotebook() };
    for (const [id, job] of Object.entries(jobs))
      element(id).addEventListener("click", () => void this.guarded(job));
    element("restart").addEventListener("click", () => {
      sessionStorage.setItem(HUNG, "1");
      this.python.end();
      location.reload();
    });
    addEventListener("popstate", () => void this.guarded(() => this.show(true)));
    await this.python.start(this.site, base.href);
    const [navigation] = performance.getEntriesByType("navigation") as PerformanceNavigationTiming[];
    await this.show(navigation?.type !== "navigate");
  }

  /** Open what the address asks for; `again` if this browser has shown it before. */
  private async show(again: boolean): Promise<void> {
    this.wanted = await readAddress(new URL(location.href));
    const hung = sessionStorage.getItem(HUNG) !== null;
    sessionStorage.removeItem(HUNG);
    this.close();
    this.close = () => {};
    host.replaceChildren();
    await this.python.open(this.wanted, again, hung);
    this.close = this.render({ model: this.python.model, el: host });
    say(this.isKept ? "" : UNKEPT, "error");
  }

  /** Say once that nothing is kept. */
  private warn(): void {
    if (this.isKept) say(UNKEPT, "error");
    this.isKept = false;
  }

  private fillPicker(): void {
    const picker = element("picker") as HTMLSelectElement;
    const group = (label: string, key: string, items: { name: string; title: string }[]) =>
      h(
        "optgroup",
        { label },
        ...items.map(({ name, title }) => h("option", { value: `${key}=${name}`, title }, name)),
      );
    const programs = this.site.programs.map(({ name, about }) => ({ name, title: about }));
    const series = new Map<string, { name: string; title: string }[]>();
    for (const { name, task, series: title } of this.site.challenges) {
      const key = title ? title.charAt(0).toUpperCase() + title.slice(1) : "Challenges";
      series.set(key, [...(series.get(key) ?? []), { name, title: task }]);
    }
    picker.append(
      group("Programs", "program", programs),
      ...[...series].map(([title, members]) => group(title, "challenge", members)),
    );
    picker.addEventListener("change", async () => {
      const [key, name] = picker.value.split("=") as ["program" | "challenge", string];
      history.pushState(null, "", await addressOf({ [key]: name }, base));
      picker.value = "";
      await this.guarded(() => this.show(false));
    });
  }

  private async share(): Promise<void> {
    const link = await addressOf({ ...this.wanted, ...(await this.python.shared()) }, base);
    history.replaceState(null, "", link);
    const copied = await copyText(link.href);
    say(
      copied ? "The link is copied. It contains the program." : "The address of this page is the link.",
      "done",
    );
  }

  private async openNotebook(): Promise<void> {
    location.href = new URL(await writeNotebook(await this.python.shared()), base).href;
  }

  async guarded(job: () => Promise<void>): Promise<void> {
    try {
      await job();
    } catch (error) {
      say((error as Error).message, "error");
    }
  }
}

async function main(): Promise<void> {
  const [site, module] = await Promise.all([
    fetch(file("site.json")).then((response) => response.json() as Promise<Site>),
    import(file("lab.js").href) as Promise<{ default: typeof lab }>,
  ]);
  await keepFiles(navigator.serviceWorker, file("cache.js")); // before Python's worker, whose files are kept, too
  const page = new Page(site, module.default.render);
  await page.guarded(() => page.start());
}

void main();
