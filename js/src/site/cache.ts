/**
 * The service worker: what the page has loaded once, this browser keeps, so that the next visit needs no
 * network. Another version of the site is another cache.
 */

interface Caching extends EventTarget {
  skipWaiting(): Promise<void>;
  clients: { claim(): Promise<void> };
  registration: { scope: string };
}
interface Extended extends Event {
  waitUntil(promise: Promise<unknown>): void;
}
interface Fetching extends Extended {
  request: Request;
  respondWith(response: Promise<Response>): void;
}

const worker = self as unknown as Caching;
const VERSION = new URL(location.href).searchParams.get("v");
const NAME = `lrp-${VERSION}`;
const PAGE = ["page.js", "page.css", "lab.js", "lab.css", "site.json", "worker.js"];

worker.addEventListener("install", (event) => {
  const filled = caches
    .open(NAME)
    .then((cache) => cache.addAll(["./", ...PAGE.map((file) => `${file}?v=${VERSION}`)]));
  (event as Extended).waitUntil(filled.then(() => worker.skipWaiting()));
});

worker.addEventListener("activate", (event) => {
  const names = caches
    .keys()
    .then((names) => names.filter((name) => name.startsWith("lrp-") && name !== NAME));
  const cleaned = names.then((old) => Promise.all(old.map((name) => caches.delete(name))));
  (event as Extended).waitUntil(cleaned.then(() => worker.clients.claim()));
});

worker.addEventListener("fetch", (event) => {
  const { request, respondWith } = event as Fetching;
  if (request.method === "GET" && !isNotebook(request.url))
    respondWith.call(event, request.mode === "navigate" ? newest(request) : kept(request));
});

/** Whether a file belongs to the notebooks, which have a service worker of their own. */
function isNotebook(url: string): boolean {
  return url.startsWith(`${worker.registration.scope}jupyter/`);
}

/** The kept file; without one, load it and keep it. */
async function kept(request: Request): Promise<Response> {
  const cache = await caches.open(NAME);
  const found = await cache.match(request);
  if (found) return found;
  const response = await fetch(request);
  if (response.ok) await cache.put(request, response.clone());
  return response;
}

/** The page as it is published now; without a network as it was. One that was never visited is the first one. */
async function newest(request: Request): Promise<Response> {
  const [page] = request.url.split(/[?#]/) as [string];
  const cache = await caches.open(NAME);
  try {
    const response = await fetch(request);
    if (response.ok) await cache.put(page, response.clone());
    return response;
  } catch (error) {
    const found = (await cache.match(page)) ?? (await caches.match("./", { ignoreSearch: true }));
    if (found) return found;
    throw error;
  }
}
