// Tests of the service worker: visits without a network, and updates to a newer build.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { fileURLToPath } from "node:url";
import { onBackend, onBothBackends, onOneBackend } from "./harness.mjs";
import { until } from "./help.mjs";

const SMALL = { viewport: [640, 480], keeps: true };
const DIST = new URL("../../dist/", import.meta.url);
const TYPES = { html: "text/html", js: "text/javascript", wasm: "application/wasm", webmanifest: "application/manifest+json", svg: "image/svg+xml" };

/** Returns the build of a page. */
const buildOf = (page) => page.evaluate(() => document.querySelector('meta[name="build"]').content);
const keptBuilds = (page) => page.evaluate(() => caches.keys());
/** Returns the names of the modules that the worker keeps. */
const keptModules = (page) => page.evaluate(async () => {
  const files = await (await caches.open((await caches.keys())[0])).keys();
  return files.map(({ url }) => url.match(/([^/]*)\.wasm$/)?.[1].replace(/-[^_]*/, "")).filter(Boolean).sort();
});
/** Waits until the worker has cached all files and controls this page. */
const isKept = (page) => until("the page is kept", () => page.evaluate(() => Boolean(navigator.serviceWorker.controller)));

/**
 * Starts a host whose build changes while the page is open: `html` and `worker` are the builds of
 * its two entry files.
 */
async function host(t) {
  const real = (await readFile(new URL("index.html", DIST), "utf8")).match(/name="build" content="(\w+)"/)[1];
  const now = { html: real, worker: real, real, beside: {} };
  const server = createServer(async (request, response) => {
    const name = decodeURI(new URL(request.url, "http://host").pathname.slice("/somewhere/".length)) || "index.html";
    let bytes;
    try {
      bytes = now.beside[name] ?? await readFile(fileURLToPath(new URL(name, DIST)));
    } catch {
      return response.writeHead(404).end();
    }
    if (name === "index.html") bytes = String(bytes).replaceAll(real, now.html);
    if (name === "sw.js") bytes = String(bytes).replaceAll(real, now.worker);
    response.writeHead(200, { "Content-Type": TYPES[name.split(".").pop()] ?? "application/octet-stream", "Cache-Control": "no-cache" });
    response.end(bytes);
  });
  await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
  t.after(() => server.close());
  return { now, base: `http://127.0.0.1:${server.address().port}/somewhere/` };
}

// Fails when a file of the first visit is not cached, when the cached page uses the network, and
// when a module is kept that the browser's graphics do not need.
onBothBackends("second visit needs no network", async ({ open, backend }) => {
  const { page, ready, segue } = await open("lab=make&gait_speed=1.2", SMALL);
  await isKept(page);
  const module = backend === "webgpu" ? "webgpu" : "segue";
  assert.deepEqual(await keptModules(page), ["reader_bg", `${module}_bg`, `${module}_rest`], "the modules of a visit");
  await page.context().setOffline(true);
  await page.goto(page.url().replace("1.2", "1.4"), { waitUntil: "commit" });
  await ready();
  assert.equal((await segue("params")).gait_speed, 1.4);
  assert.ok((await segue("pose", "result", 0.1)).joints.length > 10);
});

// Fails when a page waits for an adapter however long, and when later visits stay with the module
// of the first.
onBackend("webgpu", "late adapter draws in the module with WebGL 2, and the smaller one is kept", async ({ open }) => {
  const prepare = (page) => page.addInitScript(() => {
    const { requestAdapter } = GPU.prototype;
    GPU.prototype.requestAdapter = async function (...options) {
      await new Promise((resolve) => setTimeout(resolve, 500));
      return requestAdapter.apply(this, options);
    };
  });
  const { page, segue } = await open("play=off", { ...SMALL, prepare });
  const run = await page.evaluate(() => performance.getEntriesByType("resource").map(({ name }) => name.match(/([^/]*)_rest\.wasm$/)?.[1]).filter(Boolean));
  assert.deepEqual(run.map((name) => name.replace(/-.*/, "")), ["segue"]);
  await isKept(page);
  const module = (await segue("stats")).backend === "webgpu" ? "webgpu" : "segue";
  assert.deepEqual(await keptModules(page), ["reader_bg", `${module}_bg`, `${module}_rest`]);
});

// Fails when a worker caches files of two builds, and when reloads never get the new one.
onOneBackend("newer build replaces all files with the next reload", async ({ open, t }) => {
  const { now, base } = await host(t);
  const { page, ready } = await open("play=off", { ...SMALL, base });
  await isKept(page);
  assert.equal(await buildOf(page), now.real);

  // The host is being updated: the worker is new, the page is not.
  now.worker = "1111111111111111";
  const refused = await page.evaluate(async () => {
    const registration = await navigator.serviceWorker.getRegistration();
    await registration.update().catch(() => {});
    while (registration.installing) await new Promise((later) => setTimeout(later, 50));
    return registration.waiting === null;
  });
  assert.ok(refused, "half a build is none");
  assert.deepEqual((await keptBuilds(page)).map((name) => name.split(" ").pop()), [now.real]);

  now.html = now.worker = "2222222222222222";
  await page.evaluate(async () => (await navigator.serviceWorker.getRegistration()).update());
  await until("the new build is kept", () => page.evaluate(async () => Boolean((await navigator.serviceWorker.getRegistration()).waiting)));
  assert.equal(await buildOf(page), now.real, "the open page stays what it is");

  await page.reload({ waitUntil: "commit" });
  await until("the new build is shown", async () => (await buildOf(page).catch(() => "")) === now.html);
  await ready();
  assert.deepEqual((await keptBuilds(page)).map((name) => name.split(" ").pop()), [now.html]);
});

// Fails when a host cannot replace files beside the page, and when files of its other pages are
// cached.
onOneBackend("files beside the page come from the network while there is one", async ({ open, t }) => {
  const { now, base } = await host(t);
  Object.assign(now.beside, { "mine.md": "one", "other.html": "<!doctype html><title>Other</title>", "other.json": "1" });
  const { page } = await open("play=off", { ...SMALL, base });
  await isKept(page);
  const get = (name) => page.evaluate((name) => fetch(name).then((response) => response.text()), name);
  assert.equal(await get("mine.md?v=1"), "one");
  now.beside["mine.md"] = "two";
  assert.deepEqual([await get("mine.md?v=1"), await get("mine.md?v=2"), await get("mine.md")], ["two", "two", "two"]);
  now.beside["mine.md"] = "three";
  assert.equal(await get("mine.md?v=3"), "three");

  const other = await page.context().newPage();
  await other.goto(`${base}other.html`);
  assert.equal(await other.evaluate(() => fetch("other.json").then((response) => response.text())), "1");
  const kept = await page.evaluate(async () => {
    const caches = await window.caches.keys();
    const all = await Promise.all(caches.map(async (name) => (await (await window.caches.open(name)).keys()).map(({ url }) => url)));
    return all.flat().filter((url) => /mine|other/.test(url)).map((url) => url.split("/").pop()).toSorted();
  });
  assert.deepEqual(kept, ["mine.md", "mine.md?v=1", "mine.md?v=2", "mine.md?v=3"]);

  await page.context().setOffline(true);
  assert.deepEqual([await get("mine.md?v=2"), await get("mine.md?v=3")], ["two", "three"]);
});
