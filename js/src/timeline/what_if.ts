/** What if the program as it is now had run from the moment looked at? Asked after every edit made there. */

import type { Lab } from "../session/store";

const LEAST = 10; // s
const MOST = 60;
const CALM = 150; // ms without another edit or moment

export function askWhatIf(lab: Lab): void {
  const { store } = lab;
  let timer: ReturnType<typeof setTimeout> | undefined;
  let number = 0;
  let shown = ""; // for which moment and revision
  store.watch(["looking", "revision"], () => {
    const { looking, revision } = store.state;
    const key = looking?.edited ? `${looking.tick} ${revision}` : "";
    if (key === shown) return;
    shown = key;
    clearTimeout(timer);
    number += 1;
    if (!looking?.edited) {
      store.set("whatIf", null);
      return;
    }
    const mine = number;
    timer = setTimeout(async () => {
      const seconds = Math.min(MOST, Math.max(LEAST, looking.ago));
      const reply = await lab.ask({ type: "what_if", seconds });
      if (mine !== number) return;
      if (reply.error) lab.notify(reply.error);
      store.set("whatIf", reply.what_if ?? null);
    }, CALM);
  });
}
