/**
 * The page that `lrp run --serve` serves: the lab of a run, without a notebook. The token comes in the fragment of
 * its link, which browsers send to no server, and stays in this tab.
 */

import type lab from "../index";
import { element, say } from "../site/said";
import { type About, RunSocket } from "./socket";

const TOKEN = "lrp-token"; // in this tab's storage
const NO_TOKEN =
  "Open the link that `lrp run` has printed: it ends with a token, without which nothing is shown.";
const AWAY = "The robot's computer does not answer. The program may be running there. Trying again …";
const WORDS: Record<number, string> = {
  1009: "What was sent from this page is too large, so its connection was ended. Load it again.",
  4400: "This page is not of the version that runs. Load it again.",
  4401: "This link is not the one of the present run. Open the link that `lrp run` has printed.",
  4408: "This page has sent too much in a short time, so its connection was ended. Load it again.",
  4410: "The run has ended. This is how it was at the end.",
  4503: "Too many pages are open. Close one of them, and this one goes on.",
};

/** The token of the link, which leaves the address bar; or the one of this tab. */
function takeToken(): string {
  const [, token] = /^#token=([\w-]+)$/.exec(location.hash) ?? [];
  if (!token) return sessionStorage.getItem(TOKEN) ?? "";
  sessionStorage.setItem(TOKEN, token);
  history.replaceState(null, "", location.pathname);
  return token;
}

function describe({ name, file, read_only }: About): void {
  document.title = `${name} on ${location.hostname}`;
  const what = file || `${name} (not saved)`;
  element("about").textContent = `${what} on ${location.host}${read_only ? ", read only" : ""}`;
}

async function main(): Promise<void> {
  const token = takeToken();
  addEventListener("hashchange", () => takeToken() && location.reload()); // a new link, in the same tab
  if (!token) {
    say(NO_TOKEN, "error");
    return;
  }
  const module: { default: typeof lab } = await import(new URL("lab.js", location.href).href);
  const address = new URL("socket", location.href);
  address.protocol = address.protocol.replace("http", "ws");
  let isShown = false;
  const socket = new RunSocket(address, token, {
    here(about) {
      say("");
      describe(about);
      if (!isShown) module.default.render({ model: socket.model, el: element("lab") });
      isShown = true;
      if (about.read_only)
        element("lab").querySelector(".cm-content")?.setAttribute("contenteditable", "false");
    },
    away: () => say(AWAY, "error"),
    over(code) {
      if (code === 4401) sessionStorage.removeItem(TOKEN);
      say(WORDS[code] ?? AWAY, "error");
    },
    missed: () => say(`${AWAY} What you have just done has not reached it.`, "error"),
  });
}

void main();
