import { beforeEach, describe, expect, it } from "vitest";
import type { AnswerMessage, FromKernel, FromPage, Sections, SnapshotMessage } from "../src/protocol";
import { type Clock, Connection, type Typed } from "../src/session/connection";
import { type Packed, packed, unpacked } from "../src/session/plain";
import { initialState, type Link } from "../src/session/state";

class Wire {
  sent: FromPage[] = [];
  links: Link[] = [];
  got: string[] = [];
  time = 0;
  broken = false;
  private callback: (message: Packed, buffers: DataView[]) => void = () => {};
  fails = false;
  commChanged = () => {};
  private ticks: (() => void)[] = [];
  connection: Connection;
  typed: Sections[] = [];
  moved = false;

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
        this.sent.push(unpacked(message as Packed));
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
      typist: {
        revision: 7,
        isAhead: false,
        next: (): Typed | null => {
          const updates = this.typed.splice(0);
          if (updates.length) return { type: "text", base: 7, updates };
          return this.moved ? { type: "cursor", revision: 7, selection: null, meant: true } : null;
        },
      },
    };
    this.connection = new Connection(model, "lab", listener, clock, "me");
  }

  hear(message: object): void {
    this.callback(packed({ view: "me", ...message }), []);
  }

  wait(milliseconds: number): void {
    for (let left = milliseconds; left > 0; left -= 100) {
      this.time += Math.min(left, 100);
      for (const tick of [...this.ticks]) tick();
    }
  }

  texts(): Sections[][] {
    return this.sent.flatMap((message) => (message.type === "text" ? [message.updates] : []));
  }

  /** Type a letter. */
  type(letter: string): void {
    this.typed.push([[0, letter]]);
    this.connection.text();
  }
}

const answer = (number: number, seq = number): Partial<AnswerMessage> => ({ type: "answer", number, seq });
const snapshot = (seq = 0, number = 0): Partial<SnapshotMessage> => ({
  type: "snapshot",
  document: "d",
  seq,
  number,
  revision: 1,
  frame: { type: "frame", view: "me", frame: 1 },
});

/** What was sent about the program. */
const acts = ({ sent }: Wire) =>
  sent.flatMap((each) =>
    each.type === "command" ? [each.do] : /text|cursor/.test(each.type) ? [each.type] : [],
  );

let wire: Wire;
beforeEach(() => {
  wire = new Wire();
});

describe("text", () => {
  const a = [[0, "a"]];

  it("is sent although a panel fails at the message that makes way for it", () => {
    wire.type("a");
    wire.type("b");
    wire.fails = true;
    expect(() => wire.hear(answer(1))).toThrow("A panel failed");
    expect(wire.texts()).toEqual([[a], [[[0, "b"]]]]);
    wire.type("c");
    expect(() => wire.hear(snapshot(2))).toThrow("A panel failed");
    expect(wire.texts()).toHaveLength(3);
  });

  it("is sent one at a time, and then what was typed meanwhile", () => {
    for (const letter of "abc") wire.type(letter);
    expect(wire.texts()).toEqual([[a]]);
    wire.hear(answer(1));
    expect(wire.texts()).toEqual([[a], [[[0, "b"]], [[0, "c"]]]]);
    wire.hear(answer(2));
    expect(wire.texts()).toHaveLength(2);
  });

  it("is not freed by the answer to another view's text", () => {
    wire.type("a");
    wire.type("b");
    wire.hear(answer(1, 0));
    expect(wire.texts()).toHaveLength(1);
    wire.hear(answer(2, 1));
    expect(wire.texts()).toHaveLength(2);
  });

  it("is followed by the cursor, with the number of the text before it", () => {
    wire.moved = true;
    wire.type("a");
    expect(wire.sent.at(-1)).toMatchObject({ type: "text", base: 7, seq: 1 });
    wire.hear(answer(1));
    expect(wire.sent.at(-1)).toMatchObject({ type: "cursor", revision: 7, seq: 1 });
  });

  it("is followed by the run that was asked for after it, also if it has to wait for another text", () => {
    wire.type("a");
    wire.type("b");
    wire.moved = true;
    void wire.connection.command({ do: "run" });
    void wire.connection.command({ do: "stop" });
    wire.hear(answer(1, 0));
    expect(acts(wire)).toEqual(["text", "stop"]);
    wire.hear(answer(2, 1));
    expect(acts(wire)).toEqual(["text", "stop", "text", "run"]);
    wire.hear(answer(3, 2));
    expect(acts(wire)).toEqual(["text", "stop", "text", "run", "cursor"]);
  });

  it("is free again after a snapshot that contains it, and only then", () => {
    wire.type("a");
    wire.hear(snapshot(0));
    wire.type("b");
    expect(wire.texts()).toHaveLength(1);
    wire.hear(snapshot(1));
    expect(wire.texts()).toHaveLength(2);
  });
});

describe("answers", () => {
  it("that come too early wait for their turn, and known ones are ignored", () => {
    for (const number of [2, 3, 1, 2, 1, 5]) wire.hear(answer(number, 0));
    expect(wire.got).toEqual(["answer", "answer", "answer"]);
    wire.hear(answer(4, 0));
    expect(wire.got).toHaveLength(5);
  });

  it("that are missing for long are asked for, and those before the snapshot are ignored", () => {
    wire.hear(snapshot());
    wire.hear(answer(2, 0));
    const hellos = () => wire.sent.filter(({ type }) => type === "hello");
    for (let second = 0; second < 4; second++) {
      wire.wait(1000);
      wire.hear({ type: "frame", frame: 2 });
    }
    expect(hellos().at(-1)).toMatchObject({ document: "d", revision: 7, seq: 0 });
    expect(hellos()).toHaveLength(2);
    wire.hear(snapshot(0, 2));
    wire.hear(answer(1, 0));
    wire.hear(answer(3, 0));
    expect(wire.got.filter((type) => type === "answer")).toHaveLength(1);
  });

  it("to a text that is lost are asked for", () => {
    wire.hear(snapshot());
    wire.type("a");
    for (let second = 0; second < 4; second++) {
      wire.wait(1000);
      wire.hear({ type: "frame", frame: 2 });
    }
    expect(wire.sent.filter(({ type }) => type === "hello").at(-1)).toMatchObject({ seq: 1 });
  });
});

describe("frames", () => {
  const credits = () => wire.sent.flatMap((message) => (message.type === "credit" ? [message.frame] : []));

  it("are acknowledged at once where they ask for it", () => {
    wire.hear({ type: "frame", frame: 5 });
    expect(credits()).toEqual([]);
    wire.hear({ type: "frame", frame: 6, asks: true });
    expect(credits()).toEqual([6]);
  });

  it("are acknowledged by what the page says next, once", () => {
    wire.hear({ type: "frame", frame: 5 });
    wire.connection.send({ do: "pause" });
    wire.connection.send({ do: "run" });
    expect(wire.sent.slice(-2).map(({ frame }) => frame)).toEqual([5, undefined]);
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
    wire.hear(snapshot());
    expect(wire.links).toEqual(["live"]);
  });

  it("is busy while other messages come than the answer to a command, and live again after it", async () => {
    wire.time = 10;
    wire.hear(snapshot());
    const reply = wire.connection.command({ do: "pause" });
    wire.wait(400);
    expect(wire.links).toEqual(["live"]); // it may be that nothing reaches it
    wire.hear({ type: "frame", frame: 2 });
    expect(wire.links).toEqual(["live", "busy"]);
    wire.hear({ type: "reply", id: 1, error: null });
    expect((await reply).error).toBeNull();
    expect(wire.links).toEqual(["live", "busy", "live"]);
  });

  it("is lost after three silent seconds, asks again, and comes back", () => {
    wire.time = 10;
    wire.hear(snapshot());
    wire.wait(3100);
    expect(wire.links.at(-1)).toBe("lost");
    expect(wire.sent.filter((message) => message.type === "hello")).toHaveLength(2);
    wire.hear({ type: "frame", frame: 2 });
    expect(wire.links.at(-1)).toBe("live");
  });

  it("is dead when the comm is reported to close and no message follows", () => {
    wire.time = 10;
    wire.hear(snapshot());
    wire.commChanged();
    wire.wait(1600);
    expect(wire.links.at(-1)).toBe("dead");
  });

  it("stays live when the comm is reported to open", () => {
    wire.commChanged();
    wire.wait(200);
    wire.hear(snapshot());
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
