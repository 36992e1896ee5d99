/**
 * Single parts of one session in one page show and follow the same machine, mean the same instance, and a click in one finds the source
 * in another. They communicate through the document.
 */

import type { ElementKind, TextRange } from "../protocol";
import type { LabState } from "../session/state";
import type { Store } from "../session/store";

interface Message {
  goTo?: { kind: ElementKind; path: string };
  range?: TextRange;
  ofRunning?: boolean;
  machine?: string;
  instance?: string;
  follow?: LabState["follow"];
}

const EVENT = "lrp-together";

export function together(
  store: Store,
  receive: (message: Message) => void,
): { send(message: Message): void; close(): void } {
  let { machine, instance, follow } = store.state; // what all views show, have selected, and follow
  const listen = (event: Event) => {
    const { from, name, message } = (event as CustomEvent).detail;
    if (from === store || name !== store.state.name) return;
    if (message.follow) {
      follow = message.follow;
      store.set("follow", follow);
    } else if (message.instance !== undefined) {
      instance = message.instance;
      store.set("instance", instance);
    } else if (message.machine === undefined) receive(message);
    else {
      machine = message.machine;
      store.set("machine", machine);
    }
  };
  const send = (message: Message) => {
    const { name } = store.state;
    if (name) document.dispatchEvent(new CustomEvent(EVENT, { detail: { from: store, name, message } }));
  };
  document.addEventListener(EVENT, listen);
  store.watch(["machine"], () => {
    const before = machine;
    machine = store.state.machine;
    if (before && machine && before !== machine) send({ machine });
  });
  store.watch(["instance"], () => {
    if (instance === store.state.instance) return;
    instance = store.state.instance;
    send({ instance });
  });
  store.watch(["follow"], () => {
    if (follow === store.state.follow) return;
    follow = store.state.follow;
    send({ follow });
  });
  return { send, close: () => document.removeEventListener(EVENT, listen) };
}
