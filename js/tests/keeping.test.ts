import { expect, test } from "vitest";

import { keepFiles } from "../src/site/keeping";

/** A browser whose service worker comes as far as `state` before the page hears of it. */
function browser(state: ServiceWorkerState) {
  const worker = Object.assign(new EventTarget(), { state });
  const slot = state === "installing" ? "installing" : state === "installed" ? "waiting" : "active";
  const workers = Object.assign(new EventTarget(), {
    controller: null as unknown,
    register: async () => ({ installing: null, waiting: null, active: null, [slot]: worker }),
    claim(): void {
      workers.controller = worker;
      workers.dispatchEvent(new Event("controllerchange"));
    },
    fail(): void {
      worker.state = "redundant";
      worker.dispatchEvent(new Event("statechange"));
    },
  });
  return workers;
}

function kept(workers: unknown): { done: boolean; promise: Promise<void> } {
  const seen = { done: false, promise: Promise.resolve() };
  const files = keepFiles(workers as ServiceWorkerContainer, new URL("http://site/cache.js"));
  seen.promise = files.then(() => {
    seen.done = true;
  });
  return seen;
}

const turns = async () => {
  for (let turn = 0; turn < 10; turn++) await Promise.resolve();
};

test.each(["installing", "installed", "activating"] as const)(
  "a worker that is %s is waited for until it controls the page, or fails",
  async (state) => {
    for (const end of ["claim", "fail"] as const) {
      const workers = browser(state);
      const files = kept(workers);
      await turns();
      expect(files.done).toBe(false);
      workers[end]();
      await files.promise;
    }
  },
);

test("nothing is waited for where there is no worker, it is there, or it is refused", async () => {
  const refused = { register: () => Promise.reject(new Error("a private window")) };
  for (const workers of [undefined, browser("activated"), refused]) await kept(workers).promise;
});
