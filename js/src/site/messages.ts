/** What the page and its worker say to each other. */

import type { Wanted } from "./address";

/** What a built site consists of. */
export interface Site {
  /** Where Python itself is, and the list of its packages. */
  python: string;
  lock: string;
  /** Packages to be loaded, and the wheel of this package. */
  packages: string[];
  wheel: string;
  programs: { name: string; about: string }[];
  challenges: { name: string; task: string; series: string }[];
}

/** What a lab in a lesson needs besides: its own robot, where texts are kept, and what is run before it. */
export interface InLesson extends Wanted {
  bridge?: string;
  folder?: string;
  setup?: string;
}

/** The program that is open: its name, its text, the bundled world of its robot, if it is one, its challenge. */
export interface Shared {
  program: string;
  text: string;
  world: string;
  challenge: string;
}

export type ToWorker =
  | { do: "start"; site: Site; base: string }
  | { do: "open"; wanted: InLesson & { again: boolean; hung: boolean } }
  | { do: "message"; message: string }
  | { do: "text" }
  | { do: "ping" };

export type FromWorker =
  | { is: "step"; step: string }
  | { is: "ready" }
  | { is: "unkept" }
  | { is: "opened" }
  | { is: "message"; message: string; buffers: Uint8Array[] }
  | ({ is: "text" } & Shared)
  | { is: "failed"; sentence: string }
  | { is: "pong" };
