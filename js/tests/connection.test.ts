import { beforeEach, describe, expect, it } from "vitest";
import type { AnswerMessage, FromKernel, FromPage, SnapshotMessage } from "../src/protocol";
import { type Clock, Connection } from "../src/session/connection";
import { initialState, type Link } from "../src/session/state";

class Wire {
  sent: FromPage[] = [];
  links: Link[] = [];
  got: string[] = [];
  time = 0;
  broken = false;
  private callback: (message: FromKernel, buffers: DataView[]) => void = () => {};
  fails = false;
  commChanged = () => {};
  private ticks: (() => void)[] = [];
  connection: Connection;

  constructor() {
    const clock: Clock = {
      now: () => this.time,
      every: (_, callback) => {
        this.ticks.push(callback);
        return () => {
          this.ticks = [];
        };
      },
    };
    const model = {
      send: (message: unknown) => {
        if (this.broken) throw new Error("Cannot send");
        this.sent.push(message as FromPage);
      },
      on: (event: string, callback: (...args: never[]) => void) => {
        if (event === "msg:custom") this.callback = callback as never;
        else this.commChanged = callback as () => void;
      },
      off: () => {},
    };
    const listener = {
      message: (message: FromKernel) => {
        this.got.push(message.type);
        if (this.fails) throw new Error("A panel failed");
      },
      link: (link: Link) => void this.links.push(link),
    };
    this.connection = new Connection(model, "lab", listener, clock, "me");
  }

  hear(message: object): void {
    this.callback({ view: "me", ...message } as FromKernel, []);
  }

  wait(milliseconds: number): void {
    for (let left = milliseconds; left > 0; left -= 100) {
      this.time += Math.min(left, 100);
      for (const tick of [...this.ticks]) tick();
    }
  }

  texts(): string[] {
    return this.sent.flatMap((message) => (message.type === "text" ? [message.text] : []));
  }
}

const answer = (seq: number, revision = seq): Partial<AnswerMessage> => ({ type: "answer", seq, revision });
const snapshot = (text: string): Partial<SnapshotMessage> => ({
  type: "snapshot",
  text,
  revision: 1,
  frame: { type: "frame", view: "me", frame: 1 },
});

let wire: Wire;
beforeEach(() => {
  wire = new Wire();
});

describe("text", () => {
  it("is sent one at a time, and of those that wait the newest", () => {
    for (const text of ["a", "ab", "abc", "abcd"]) wire.connection.text(text);
    expect(wire.texts()).toEqual(["a"]);
    wire.hear(answer(1));
    expect(wire.texts()).toEqual(["a", "abcd"]);
    wire.hear(answer(2));
    expect(wire.texts()).toEqual(["a", "abcd"]);
  });

  it("is sent although a panel fails at the message that makes way for it", () => {
    wire.connection.text("a");
    wire.connection.text("ab");
    wire.fails = true;
    expect(() => wire.hear(answer(1))).toThrow("A panel failed");
    expect(wire.texts()).toEqual(["a", "ab"]);
    expect(() => wire.hear(snapshot(""))).toThrow("A panel failed");
    expect(wire.texts()).toEqual(["a", "ab", "ab"]);
  });

  it("is sent again when its last word is meant", () => {
    const sent = () =>
      wire.sent.flatMap((message) => (message.type === "text" ? [[message.text, message.meant]] : []));
    wire.connection.text("a", [1, 2], false);
    wire.connection.text("a", [1, 2], true);
    wire.hear(answer(1));
    expect(sent()).toEqual([
      ["a", false],
      ["a", true],
    ]);
  });

  it("is not freed by the answer to another view's text", () => {
    wire.connection.text("a");
    wire.connection.text("ab");
    wire.hear(answer(0, 7));
    expect(wire.texts()).toEqual(["a"]);
  });

  it("names the revision that it is based on", () => {
    wire.hear(answer(0, 7));
    wire.connection.text("a");
    expect(wire.sent.at(-1)).toMatchObject({ type: "text", base: 7, seq: 1 });
  });

  it("is sent again when a new kernel side does not know it", () => {
    wire.connection.text("mine");
    wire.hear(snapshot("theirs"));
    expect(wire.texts()).toEqual(["mine", "mine"]);
  });
});

describe("frames", () => {
  const credits = () => wire.sent.flatMap((message) => (message.type === "credit" ? [message.frame] : []));

  it("are acknowledged two at a time while many come", () => {
    for (let frame = 5; frame < 10; frame++) wire.hear({ type: "frame", frame });
    expect(credits()).toEqual([5, 7, 9]);
  });

  it("that come one by one are acknowledged at once", () => {
    wire.hear({ type: "frame", frame: 5 });
    wire.wait(1000);
    wire.hear({ type: "frame", frame: 6 });
    expect(credits()).toEqual([5, 6]);
  });

  it("of other views are ignored", () => {
    wire.hear({ type: "frame", frame: 5, view: "other" });
    expect(wire.got).toEqual([]);
    expect(wire.sent.some((message) => message.type === "credit")).toBe(false);
  });
});

describe("the link", () => {
  it("is live once a message has arrived", () => {
    wire.time = 10;
    wire.hear(snapshot(""));
    expect(wire.links).toEqual(["live"]);
  });

  it("is busy while a command is not answered, and live again after it", async () => {
    wire.time = 10;
    wire.hear(snapshot(""));
    const reply = wire.connection.command({ do: "pause" });
    wire.wait(400);
    expect(wire.links).toEqual(["live", "busy"]);
    wire.hear({ type: "reply", id: 1, error: null });
    expect((await reply).error).toBeNull();
    expect(wire.links).toEqual(["live", "busy", "live"]);
  });

  it("is lost after three silent seconds, asks again, and comes back", () => {
    wire.time = 10;
    wire.hear(snapshot(""));
    wire.wait(3100);
    expect(wire.links.at(-1)).toBe("lost");
    expect(wire.sent.filter((message) => message.type === "hello")).toHaveLength(2);
    wire.hear({ type: "frame", frame: 2 });
    expect(wire.links.at(-1)).toBe("live");
  });

  it("is dead when the comm is reported to close and no message follows", () => {
    wire.time = 10;
    wire.hear(snapshot(""));
    wire.commChanged();
    wire.wait(1600);
    expect(wire.links.at(-1)).toBe("dead");
  });

  it("stays live when the comm is reported to open", () => {
    wire.commChanged();
    wire.wait(200);
    wire.hear(snapshot(""));
    wire.wait(1600);
    expect(wire.links).toEqual(["live"]);
  });

  it("is dead when the comm is closed", () => {
    wire.broken = true;
    wire.connection.send({ do: "rate", value: 5 });
    expect(wire.links).toEqual(["dead"]);
  });

  it("refuses what waits for a reply and what is asked later, once it is dead", async () => {
    const waiting = wire.connection.command({ do: "reset" });
    wire.broken = true;
    wire.connection.send({ do: "rate", value: 5 });
    const later = wire.connection.ask({ type: "versions" });
    for (const { error } of await Promise.all([waiting, later])) expect(error).toContain("Run the cell");
  });
});

it("a state begins empty and running nothing", () => {
  expect(initialState().lit).toEqual([]);
});
