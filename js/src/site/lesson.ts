/**
 * A lesson as a page: its labs run in their places, one at a time, all in the Python of this page. What is typed
 * stays in this browser, a folder for each lesson, until its owner hands in a link.
 */

import type lab from "../index";
import { copyText } from "../ui/clipboard";
import { h, prose } from "../ui/dom";
import { addressOf } from "./address";
import { keepFiles } from "./keeping";
import type { InLesson, Site } from "./messages";
import { Python } from "./python";

const HUNG = "lrp-hung"; // in this tab's storage: Python was ended because it did not answer
const UNKEPT =
  "This browser does not keep what you type here: its storage cannot be used. Hand in before you leave.";
const VERSION = new URL(import.meta.url).search; // of the site: `?v=…`

const base = new URL("../", location.href);
const file = (name: string) => new URL(name + VERSION, base);

/** The place of a lab: its program and picture, or the lab itself. */
class Place {
  readonly wanted: InLesson;
  readonly live = h("div", { class: "live" });
  private readonly still: HTMLElement;
  private readonly status = h("span", { role: "status" });
  private readonly run: HTMLButtonElement;
  private readonly handIn = h("button", { type: "button", "data-do": "hand-in" }, "Hand in");

  constructor(
    readonly element: HTMLElement,
    lesson: Lesson,
  ) {
    this.wanted = JSON.parse(element.dataset.wanted!);
    this.still = element.querySelector<HTMLElement>(".still")!;
    this.run = element.querySelector<HTMLButtonElement>('[data-do="run"]')!;
    this.run.addEventListener("click", () => void lesson.guarded(this, () => lesson.open(this)));
    this.handIn.addEventListener("click", () => void lesson.guarded(this, () => lesson.handIn(this)));
    this.run.after(this.handIn, this.status);
    element.append(this.live);
    this.show(false);
  }

  /** Show the lab, or the program and its picture. */
  show(isOpen: boolean): void {
    this.live.hidden = !isOpen;
    this.still.hidden = isOpen;
    this.run.hidden = isOpen;
    this.handIn.hidden = !(isOpen && this.wanted.challenge);
    if (!isOpen) this.live.replaceChildren();
  }

  say(sentence: string, kind: "busy" | "error" | "done" = "busy"): void {
    this.status.replaceChildren(...prose(sentence));
    this.status.dataset.kind = kind;
  }

  sayLink(link: URL, isCopied: boolean): void {
    this.status.dataset.kind = "done";
    const how = isCopied
      ? " is copied. Mail it to your teacher."
      : " is what you mail to your teacher: copy its address.";
    this.status.replaceChildren(h("a", { href: link.href }, "The link to your program"), how);
  }
}

class Lesson {
  private place: Place | null = null;
  private close: () => void = () => {};
  private python: Promise<Python> | null = null;
  private isKept = true;

  constructor(private readonly silent: HTMLElement) {
    for (const element of document.querySelectorAll<HTMLElement>(".lab")) new Place(element, this);
    document.getElementById("restart")!.addEventListener("click", () => {
      sessionStorage.setItem(HUNG, "1");
      location.reload(); // which ends the worker
    });
  }

  /** Run the lab of a place, and no other one. */
  async open(place: Place): Promise<void> {
    this.leave();
    this.place = place;
    place.say("Loading …");
    const module = import(file("lab.js").href) as Promise<{ default: typeof lab }>;
    this.python ??= this.start();
    const [python, { default: widget }] = await Promise.all([this.python, module]);
    if (this.place !== place) return; // another one was opened meanwhile
    const hung = sessionStorage.getItem(HUNG) !== null;
    sessionStorage.removeItem(HUNG);
    await python.open(place.wanted, true, hung);
    place.show(true);
    place.say(this.isKept ? "" : UNKEPT, "error");
    this.close = widget.render({ model: python.model, el: place.live });
  }

  /** Copy the link that contains the program. */
  async handIn(place: Place): Promise<void> {
    const { program, text, challenge } = await (await this.python!).shared();
    const link = await addressOf({ program, challenge, text }, base);
    place.sayLink(link, await copyText(link.href));
  }

  async guarded(place: Place, job: () => Promise<void>): Promise<void> {
    try {
      await job();
    } catch (error) {
      place.show(false);
      place.say((error as Error).message, "error");
    }
  }

  private leave(): void {
    this.close();
    this.close = () => {};
    this.place?.show(false);
    this.place?.say("");
    this.place = null;
  }

  private async start(): Promise<Python> {
    const site = (await (await fetch(file("site.json"))).json()) as Site;
    await keepFiles(navigator.serviceWorker, file("cache.js")); // before Python's worker, whose files are kept, too
    const python = new Python(file("worker.js"), {
      step: (step) => this.place?.say(`${step} …`),
      silent: (on) => {
        this.silent.hidden = !on;
      },
      unkept: () => {
        this.isKept = false;
        this.place?.say(UNKEPT, "error");
      },
    });
    await python.start(site, base.href);
    return python;
  }
}

new Lesson(document.getElementById("silent")!);
