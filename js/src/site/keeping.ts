/**
 * Let the service worker keep what is loaded from now on. Without one the page works, but loads all at each visit.
 */
export async function keepFiles(workers: ServiceWorkerContainer | undefined, script: URL): Promise<void> {
  try {
    const registered = await workers?.register(script);
    if (registered) await controls(workers!, registered);
  } catch {
    // a private window, or a page without https
  }
}

/**
 * Wait until a worker that is on its way controls the page. One that is there does, unless the page was loaded
 * without it on purpose.
 */
function controls(
  workers: ServiceWorkerContainer,
  { installing, waiting, active }: ServiceWorkerRegistration,
): Promise<void> | undefined {
  const coming = installing ?? waiting ?? (active?.state === "activating" ? active : null);
  if (!coming) return;
  return new Promise((resolve) => {
    const look = () => {
      if (workers.controller === coming || coming.state === "redundant") resolve();
    };
    workers.addEventListener("controllerchange", look);
    coming.addEventListener("statechange", look);
    look();
  });
}
