/** The lab's model outside of a notebook: the page decides where messages go. */

import type { Model } from "../session/connection";
import type { Packed } from "../session/plain";

type Receive = (message: Packed, buffers: (ArrayBuffer | Uint8Array)[]) => void;

export class PageModel implements Model {
  private readonly receivers = new Set<Receive>();

  /** `post` sends a message, in JSON. */
  constructor(private readonly post: (json: string) => void) {}

  send(content: unknown): void {
    this.post((content as Packed).json);
  }

  on(event: string, callback: (...args: never[]) => void): void {
    if (event === "msg:custom") this.receivers.add(callback as Receive);
  }

  off(_event: string, callback: (...args: never[]) => void): void {
    this.receivers.delete(callback as Receive);
  }

  get(name: string): unknown {
    return name === "view" ? "lab" : undefined;
  }

  /** Pass a message, in JSON, on to the lab. */
  receive(json: string, buffers: (ArrayBuffer | Uint8Array)[]): void {
    for (const receive of this.receivers) receive({ json }, buffers);
  }
}
