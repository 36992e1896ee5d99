/** What if the program as it is now had run from the moment looked at? Asked after every edit made there. */

import type { WhatIf } from "../protocol";
import { newest } from "../session/newest";
import type { Lab } from "../session/store";
import { unmarked } from "../ui/dom";

const LEAST = 10; // s
const MOST = 60;
const CALM = 150; // ms without another edit or moment

export function askWhatIf(lab: Lab): void {
  const { store } = lab;
  let wanted = ""; // for which moment and revision
  let changed = 0; // when, in ms
  const ask = newest(
    lab.closed,
    () => changed + CALM,
    async () => {
      const { looking } = store.state;
      if (!looking?.edited) return;
      const asked = wanted;
      const seconds = Math.min(MOST, Math.max(LEAST, looking.ago));
      const reply = await lab.ask({ type: "what_if", seconds });
      if (asked !== wanted) return;
      if (reply.error) lab.notify(reply.error);
      store.set("whatIf", reply.what_if ?? null);
    },
  );
  store.watch(["looking", "revision"], () => {
    const { looking, revision } = store.state;
    const key = looking?.edited ? `${looking.tick} ${revision}` : "";
    if (key === wanted) return;
    wanted = key;
    changed = performance.now();
    if (key) ask();
    else store.set("whatIf", null);
  });
}

/** What is different after an edit of the past. */
export function whatIfWords({ divergence, end, open_loop }: WhatIf): string {
  const loop = open_loop ? " (open loop: the readings are the recorded ones)" : "";
  if (!divergence) return `with the edit${loop}: there is no difference up to ${end.toFixed(1)} s.`;
  return `with the edit${loop}, from ${divergence.time.toFixed(1)} s on: ${unmarked(divergence.text)}`;
}
