// The service worker: it serves the page without a network. `cargo xtask seal` fills in the name
// and the files of the build.
//
// One worker serves one complete build: all files of a page come from the same build. A newer
// worker waits until no page of the older one is open, or the only one is reloaded.
//
// Files that are not part of the build belong to the host, such as lessons and takes beside the
// page. They come from the network, and copies of them serve visits without one. Requests of other
// pages of the host are not handled.

const BUILD = "BUILD";
/**
 * The files that the page starts with, of the module that boot.js has chosen: with WebGL 2, or with
 * WebGPU alone.
 */
const FILES = [/* FILES */];
const MODULES = {
  webgl2: [/* WEBGL2 */],
  webgpu: [/* WEBGPU */],
};
/** The files that are fetched on request, and cached from then on. */
const LATER = [/* LATER */];

const BASE = new URL("./", self.location);
const PREFIX = `segue ${BASE.pathname} `; // several pages may live on one host
const CACHE = PREFIX + BUILD;
/** The cache of files beside the page, independent of the build. */
const BESIDE = `${PREFIX}beside`;

const addressOf = (name) => new URL(name, BASE).href;
const PAGE = addressOf("index.html");
const OF_BUILD = new Set([...FILES, ...LATER, ...Object.values(MODULES).flat()].map(addressOf));

self.addEventListener("install", (event) => event.waitUntil(install()));
self.addEventListener("activate", (event) => event.waitUntil(activate()));
self.addEventListener("message", (event) => {
  if (event.data === "begin") self.skipWaiting();
});
self.addEventListener("fetch", (event) => {
  const { request } = event;
  if (request.method !== "GET") return;
  // The query is a part of the address, except for the page, where it is the state.
  const address = withoutHash(request.url);
  if (request.mode === "navigate") {
    if (isPage(request.url)) event.respondWith(page(request));
  } else if (OF_BUILD.has(address)) {
    event.respondWith(file(request));
  } else if (address.startsWith(BASE.href) && !new URL(address).pathname.endsWith("/sw.js")) {
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

async function install() {
  const cache = await caches.open(CACHE);
  // Files are revalidated, because those in the browser's cache may be of another build.
  const module = MODULES[new URLSearchParams(self.location.search).get("module")] ?? MODULES.webgl2;
  await cache.addAll([...FILES, ...module].map((name) => new Request(addressOf(name), { cache: "no-cache" })));
  const html = await (await cache.match(PAGE)).text();
  // The names of all other files change with their content. A page of another build means that the
  // host is being updated.
  if (!html.includes(`content="${BUILD}"`)) {
    await caches.delete(CACHE);
    throw new Error("the page is of another build; the next visit tries again");
  }
}

async function activate() {
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
  return (await ofBuild(PAGE)) ?? fetch(request);
}

async function file(request) {
  const kept = await ofBuild(request.url);
  if (kept) return kept;
  const response = await fetch(request);
  if (response.status === 200 && (await caches.has(CACHE))) await (await caches.open(CACHE)).put(request.url, response.clone());
  return response;
}

/**
 * Returns a cached file of this build. The cache is not opened, because that would make the one
 * that a newer worker has deleted anew.
 */
const ofBuild = (address) => caches.match(address, { cacheName: CACHE });

/** Answers a request for a file that is not part of the build. */
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
