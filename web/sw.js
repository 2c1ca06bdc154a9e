// Keeps the page for visits without a network. `cargo xtask seal` fills in what this build is called and consists of.
//
// One worker serves one build, whole: a page that it has begun gets everything else from the same build. A newer worker
// waits until no page of the older one is open; a reload of the only page counts as that.
//
// What is not of the build is a host's own, such as lessons and takes beside the page: the network gives it, and a copy of it
// is there only for visits without one. What other pages of the host ask for is theirs alone.

const BUILD = "BUILD";
/** What the page begins with. */
const FILES = [/* FILES */];
/** What is fetched when somebody asks for it, and kept from then on. */
const LATER = [/* LATER */];

const BASE = new URL("./", self.location);
const PREFIX = `segue ${BASE.pathname} `; // several pages may live on one host
const CACHE = PREFIX + BUILD;
/** Copies of what lies beside the page, whatever build it is of. */
const BESIDE = `${PREFIX}beside`;

const addressOf = (name) => new URL(name, BASE).href;
const PAGE = addressOf("index.html");
const OF_BUILD = new Set([...FILES, ...LATER].map(addressOf));

self.addEventListener("install", (event) => event.waitUntil(keep()));
self.addEventListener("activate", (event) => event.waitUntil(begin()));
self.addEventListener("message", (event) => {
  if (event.data === "begin") self.skipWaiting();
});
self.addEventListener("fetch", (event) => {
  const { request } = event;
  if (request.method !== "GET") return;
  // The query is part of what is asked for, but for the page itself: there it is the state.
  const address = withoutHash(request.url);
  if (request.mode === "navigate") {
    if (isPage(request.url)) event.respondWith(page(request));
  } else if (OF_BUILD.has(address)) {
    event.respondWith(file(request));
  } else if (address.startsWith(BASE.href) && !address.endsWith("/sw.js")) {
    event.respondWith(beside(event));
  }
});

function withoutHash(url) {
  return url.split("#", 1)[0];
}

function isPage(url) {
  const { origin, pathname } = new URL(url);
  return origin === BASE.origin && (pathname === BASE.pathname || origin + pathname === PAGE);
}

async function keep() {
  const cache = await caches.open(CACHE);
  // Asked for anew, though not transferred again when nothing has changed: a browser's own copy may be of another build.
  await cache.addAll(FILES.map((name) => new Request(addressOf(name), { cache: "no-cache" })));
  const html = await (await cache.match(PAGE)).text();
  // All other names change with what is in them. If the page is of another build, the host is in the middle of an update.
  if (!html.includes(`content="${BUILD}"`)) {
    await caches.delete(CACHE);
    throw new Error("the page is of another build; next time");
  }
}

async function begin() {
  for (const name of await caches.keys()) {
    if (name.startsWith(PREFIX) && name !== CACHE && name !== BESIDE) await caches.delete(name);
  }
  await self.clients.claim();
}

async function page(request) {
  const { waiting } = self.registration;
  if (waiting && (await self.clients.matchAll({ type: "window" })).length <= 1) {
    waiting.postMessage("begin");
    return new Response("", { headers: { Refresh: "0", "Content-Type": "text/html" } });
  }
  return (await (await caches.open(CACHE)).match(PAGE)) ?? fetch(request);
}

async function file(request) {
  const cache = await caches.open(CACHE);
  const kept = await cache.match(request.url);
  if (kept) return kept;
  const response = await fetch(request);
  if (response.status === 200) await cache.put(request.url, response.clone());
  return response;
}

/** Something that is not of the build. */
async function beside({ request, clientId }) {
  const client = await self.clients.get(clientId);
  if (!client || !isPage(client.url)) return fetch(request);
  const cache = await caches.open(BESIDE);
  try {
    const response = await fetch(request);
    if (response.status === 200) await cache.put(request, response.clone());
    return response;
  } catch (reason) {
    const kept = await cache.match(request);
    if (kept) return kept;
    throw reason;
  }
}
