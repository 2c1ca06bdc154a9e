// Keeps the page for visits without a network. `cargo xtask seal` fills in what this build is called and consists of.
//
// One worker serves one build, whole: a page that it has begun gets everything else from the same build. A newer worker
// waits until no page of the older one is open; a reload of the only page counts as that.

const BUILD = "BUILD";
const FILES = [/* FILES */];

const BASE = new URL("./", self.location);
const PREFIX = `segue ${BASE.pathname} `; // several pages may live on one host
const CACHE = PREFIX + BUILD;

self.addEventListener("install", (event) => event.waitUntil(keep()));
self.addEventListener("activate", (event) => event.waitUntil(begin()));
self.addEventListener("message", (event) => {
  if (event.data === "begin") self.skipWaiting();
});
self.addEventListener("fetch", (event) => {
  const { request } = event;
  const name = nameOf(request);
  if (name === undefined) return;
  event.respondWith(request.mode === "navigate" ? page(request) : file(request, name));
});

/** What a request asks for within this page's folder; undefined for what is none of ours. */
function nameOf({ method, mode, url }) {
  const { origin, pathname } = new URL(url);
  if (method !== "GET" || origin !== BASE.origin || !pathname.startsWith(BASE.pathname)) return undefined;
  const name = decodeURI(pathname.slice(BASE.pathname.length)) || "index.html";
  if (name === "sw.js") return undefined;
  return mode === "navigate" && name !== "index.html" ? undefined : name;
}

async function keep() {
  const cache = await caches.open(CACHE);
  // Asked for anew, though not transferred again when nothing has changed: a browser's own copy may be of another build.
  await cache.addAll(FILES.map((name) => new Request(new URL(name, BASE), { cache: "no-cache" })));
  const html = await (await cache.match(new URL("index.html", BASE))).text();
  // All other names change with what is in them. If the page is of another build, the host is in the middle of an update.
  if (!html.includes(`content="${BUILD}"`)) {
    await caches.delete(CACHE);
    throw new Error("the page is of another build; next time");
  }
}

async function begin() {
  for (const name of await caches.keys()) {
    if (name.startsWith(PREFIX) && name !== CACHE) await caches.delete(name);
  }
  await self.clients.claim();
}

async function page(request) {
  const { waiting } = self.registration;
  if (waiting && (await self.clients.matchAll({ type: "window" })).length <= 1) {
    waiting.postMessage("begin");
    return new Response("", { headers: { Refresh: "0", "Content-Type": "text/html" } });
  }
  return (await (await caches.open(CACHE)).match(new URL("index.html", BASE))) ?? fetch(request);
}

async function file(request, name) {
  const cache = await caches.open(CACHE);
  const address = new URL(name, BASE);
  const kept = await cache.match(address);
  if (kept) return kept;
  const response = await fetch(request);
  // What was asked for once is there from then on.
  if (response.status === 200) await cache.put(address, response.clone());
  return response;
}
