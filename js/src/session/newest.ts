/** Questions of which only the newest counts: one at a time, not too often, and none after the view is closed. */

/** Return what asks when `mayAsk` says (in ms of `performance.now`); calls while it asks become one more question. */
export function newest(closed: AbortSignal, mayAsk: () => number, ask: () => Promise<void>): () => void {
  let isDue = false;
  let isAsking = false;
  const run = async () => {
    isAsking = true;
    while (isDue && !closed.aborted) {
      const wait = mayAsk() - performance.now();
      if (wait > 0) {
        await new Promise((over) => setTimeout(over, wait));
        continue;
      }
      isDue = false;
      await ask();
    }
    isAsking = false;
  };
  return () => {
    isDue = true;
    if (!isAsking) void run();
  };
}
