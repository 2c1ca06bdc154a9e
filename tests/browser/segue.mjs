// Segue in a real Chromium, for the tests of harness.mjs and the pictures of shot.mjs.

import { execFileSync, spawn } from "node:child_process";
import { Buffer } from "node:buffer";
import { once } from "node:events";
import process from "node:process";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";
import { decodePng } from "./png.mjs";

export const BACKENDS = ["webgl2", "webgpu"];

/**
 * The time limit for a condition. Software rendering takes seconds for a frame on a busy machine.
 */
export const WAIT_TIMEOUT_MS = 120_000;
/** The time limit for a browser to make a graphics device, or to end. */
const GRAPHICS_TIMEOUT_MS = 30_000;

const COMMON_FLAGS = [
  "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
];
const BACKEND_FLAGS = {
  webgl2: ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-features=WebGPU"],
  // The last three are needed because pictures of a page lack what WebGPU draws, unless Vulkan
  // composes the page.
  webgpu: [
    "--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--enable-features=Vulkan", "--use-vulkan=swiftshader", "--use-angle=vulkan",
  ],
  // For tests that change from WebGPU to WebGL 2. Pictures of WebGPU are empty here.
  both: [
    "--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--enable-unsafe-swiftshader", "--enable-features=Vulkan", "--use-vulkan=swiftshader", "--use-angle=swiftshader",
  ],
};

/**
 * Opens the page and waits for `window.segueReady`.
 * @param options.viewport [width, height]
 * @param options.scale device pixels per CSS pixel
 * @param options.theme "dark" or "light"
 * @param options.motion "reduce" for a user who prefers reduced motion
 * @param options.base the address to open instead of the served build
 * @param options.keeps true: the page may register its service worker (sw.js), which other tests
 *   must not have
 * @param options.wait false: return at once, ready or not
 * @param options.prepare called with the page before it navigates, to add routes and init scripts
 */
export async function openSegue(backend, query = "", options = {}) {
  const { viewport = [1280, 800], scale = 1, theme = "dark", motion = "no-preference", base, keeps = false, wait = true, prepare } = options;
  const browser = await launch(backend);
  const [width, height] = viewport;
  const context = await browser.newContext({
    viewport: { width, height }, deviceScaleFactor: scale, colorScheme: theme, reducedMotion: motion, serviceWorkers: keeps ? "allow" : "block",
  });
  // A page that is loaded again has no API for a moment: calls wait for that of the new one.
  await context.addInitScript(() => {
    window.whenReady = async () => {
      while (!("segueReady" in window)) await new Promise((resolve) => setTimeout(resolve, 10));
      return window.segueReady;
    };
  });
  const page = await context.newPage();
  page.setDefaultTimeout(WAIT_TIMEOUT_MS);
  const log = [];
  /**
   * Uncaught errors, which fail the test. A test that expects one empties the list
   * (`problems.length = 0`).
   */
  const problems = [];
  page.on("console", (message) => log.push(`${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => problems.push(String(error.stack ?? error)));
  await prepare?.(page);
  await page.goto(`${base ?? await address()}${query ? `?${query}` : ""}`, { waitUntil: "commit" });

  const opened = {
    page,
    log,
    problems,
    /** Resolves when the page is ready, rejects with the page's own reason. */
    ready: () => {
      const asked = page.waitForFunction(() => "segueReady" in window).then(() => page.evaluate(() => window.whenReady().then(() => true)));
      return withTimeout(asked, WAIT_TIMEOUT_MS, () => `the page did not get ready; it said:\n${log.join("\n")}`);
    },
    /**
     * Calls the page's API: `segue("set", { lab: "blend" })`; a property by its name alone:
     * `segue("version")`.
     */
    segue: (member, ...args) => call(page, member, args),
    /** Loads a file through the API. */
    load: (name, bytes) => load(page, name, bytes),
    dropFile: (name, bytes, at) => dropFiles(page, [[name, bytes]], at),
    dropFiles: (files, at) => dropFiles(page, files, at),
    drag: (from, to, steps) => drag(page, from, to, steps),
    /** Returns a picture of the page as PNG bytes. */
    screenshot: () => page.screenshot({ type: "png" }),
    /** Returns a decoded picture of the page: `{ width, height, at(x, y), colours(), … }`. */
    pixels: async () => decodePng(await page.screenshot({ type: "png" })),
    /**
     * Returns a decoded picture of the stage from the app. The browser's own pictures wait for a
     * compositor, which a lost device stops.
     */
    snapshot: async () => decodePng(await snapshot(page)),
  };
  if (wait) await opened.ready();
  return opened;
}

/**
 * Drops files, each a name and its bytes, on the canvas with the events that a browser sends for
 * real ones.
 */
export async function dropFiles(page, files, [x, y] = [400, 300]) {
  await page.evaluate((files) => {
    window.toDrop = files.map(([name, base64]) => new File([Uint8Array.from(atob(base64), (char) => char.charCodeAt(0))], name));
  }, files.map(([name, bytes]) => [name, Buffer.from(bytes).toString("base64")]));
  await dropPrepared(page, [x, y]);
}

/** Drops the files in `toDrop`, a variable of the page. */
export async function dropPrepared(page, [x, y] = [400, 300]) {
  await page.evaluate(async ([x, y]) => {
    const dataTransfer = new DataTransfer();
    for (const file of window.toDrop) dataTransfer.items.add(file);
    const canvas = document.getElementById("segue");
    for (const type of ["dragenter", "dragover", "dragover", "drop"]) {
      canvas.dispatchEvent(new DragEvent(type, { bubbles: true, cancelable: true, composed: true, clientX: x, clientY: y, dataTransfer }));
      await new Promise((resolve) => requestAnimationFrame(resolve));
    }
  }, [x, y]);
}

/** Drags the real mouse with its first button down. */
export async function drag(page, from, to, steps = 12) {
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(...to, { steps });
  await page.mouse.up();
}

function call(page, member, args) {
  return page.evaluate(async ([member, args]) => {
    const segue = await window.whenReady();
    const value = segue[member];
    const result = typeof value === "function" ? await value(...args) : value;
    return result instanceof Uint8Array ? { base64: btoa(Array.from(result, (byte) => String.fromCharCode(byte)).join("")) } : result;
  }, [member, args]).then((result) => (result?.base64 === undefined ? result : Buffer.from(result.base64, "base64")));
}

function load(page, name, bytes) {
  return page.evaluate(async ([name, base64]) => {
    const segue = await window.whenReady();
    return segue.load(name, Uint8Array.from(atob(base64), (char) => char.charCodeAt(0)));
  }, [name, Buffer.from(bytes).toString("base64")]);
}

async function snapshot(page) {
  const base64 = await page.evaluate(async () => {
    const blob = await (await window.whenReady()).snapshot();
    if (!(blob instanceof Blob) || blob.type !== "image/png") throw new Error(`no PNG: ${blob.type}`);
    return btoa(Array.from(new Uint8Array(await blob.arrayBuffer()), (byte) => String.fromCharCode(byte)).join(""));
  });
  return Buffer.from(base64, "base64");
}

const browsers = new Map();
let ownFlags = [];

/** Sets options of the browsers that are started from now on, beside those of their backend. */
export function setBrowserFlags(flags) {
  ownFlags = flags;
}

/** The browsers of this test file by backend, started on demand. */
export function launch(backend) {
  if (!BACKEND_FLAGS[backend]) throw new Error(`there is no backend "${backend}", only ${Object.keys(BACKEND_FLAGS).join(", ")}`);
  if (!browsers.has(backend)) {
    browsers.set(backend, chromium.launch({ executablePath: chromiumPath(), args: [...COMMON_FLAGS, ...BACKEND_FLAGS[backend], ...ownFlags] }));
  }
  return browsers.get(backend);
}

function chromiumPath() {
  const names = [process.env.CHROMIUM, "chromium", "chromium-browser", "google-chrome-stable", "google-chrome"].filter(Boolean);
  for (const name of names) {
    try {
      return execFileSync("sh", ["-c", 'command -v "$1"', "sh", name], { encoding: "utf8" }).trim();
    } catch {
      // the next name
    }
  }
  throw new Error("no Chromium on the path: install one, or name it in the variable CHROMIUM");
}

// The server: the one that `cargo xtask test` has started, or a server of dist/ that is started
// here.
let server;
let addressPromise;

function address() {
  addressPromise ??= process.env.SEGUE_URL ? Promise.resolve(process.env.SEGUE_URL) : serve();
  return addressPromise;
}

async function serve() {
  const root = fileURLToPath(new URL("../..", import.meta.url));
  server = spawn("cargo", ["xtask", "serve", "--no-build", "--port", "0"], { cwd: root, stdio: ["ignore", "pipe", "inherit"] });
  for await (const line of createInterface(server.stdout)) {
    const found = /http:\/\/\S+/.exec(line);
    if (found) return found[0];
  }
  throw new Error("the server did not start");
}

/**
 * Returns whether the graphics of a browser answer, in a page without Segue. SwiftShader hangs at
 * times, and with it everything that draws in this browser.
 */
export async function hasGraphics(backend) {
  const asked = (async () => {
    const page = await (await (await launch(backend)).newContext()).newPage();
    await page.goto(new URL("icons/icon.svg", await address()).href);
    return page.evaluate(async (backend) => {
      if (backend === "webgl2") return new OffscreenCanvas(1, 1).getContext("webgl2")?.getError() === 0;
      const device = await (await navigator.gpu.requestAdapter()).requestDevice();
      await device.queue.onSubmittedWorkDone();
      return true;
    }, backend).finally(() => page.context().close());
  })();
  return withTimeout(asked, GRAPHICS_TIMEOUT_MS, () => "no answer").catch(() => false);
}

/** Ends a browser. The next page opens in a new one. */
export async function endBrowser(backend) {
  const browser = await browsers.get(backend);
  browsers.delete(backend);
  if (!browser) return;
  await withTimeout(browser.close(), GRAPHICS_TIMEOUT_MS, () => `the browser for ${backend} does not end`);
}

/** Ends the browsers and the server. */
export async function close() {
  for (const backend of browsers.keys()) await endBrowser(backend).catch((reason) => console.warn(reason.message));
  if (server && server.exitCode === null) {
    const ended = once(server, "exit");
    server.kill();
    await ended;
  }
}

/** Waits for a promise, and rejects with a `TimeoutError` where it takes longer than `ms`. */
export function withTimeout(promise, ms, message) {
  let timer;
  const late = new Promise((_, reject) => {
    // The name of Playwright's own.
    timer = setTimeout(() => reject(Object.assign(new Error(`${message()}\n(after ${ms / 1000} s)`), { name: "TimeoutError" })), ms);
  });
  return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}
