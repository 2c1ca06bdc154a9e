// Starts the app: compiles the WebAssembly that first.js downloads, hands it the canvas, and
// settles `window.segueReady`.
//
// The app (the wasm-bindgen module) must have a class `SegueHandle` with
//   static start(canvas, newReader, newComputer, corpora) -> Promise<SegueHandle>   the app runs on this canvas; newReader makes a
//                                                  worker for files, newComputer one that computes, corpora calls corpus/
//   firstFrame() -> Promise                        its first frame is on screen
//   setComplete()                                  the whole program is there (rest.js); input is held back until then
//   restart(canvas) -> Promise                     continues on a new canvas after the graphics context was lost; false: only a
//                                                  module with WebGL 2 can
//   stored() -> Promise                            waits until all files are stored; false: they cannot be
//   isEmbedded()                                   whether the link says so; the page then answers the one around it, and
//                                                  stores nothing
//   hasPanicked(), panicSummary()                  callable at any time, also in the middle of another call
//   setListener((event, detail) => …)              "change", "error", "progress" for the public API, and "lost" when
//                                                  the graphics device of the app is lost
// and the methods that api.js calls. Every method borrows the handle shared: after a panic inside
// an exclusive one, wasm-bindgen would refuse all others, panicSummary among them.

import { makeApi } from "./api.js";
import { answerParent } from "./embed.js";
import { showDownloadFailed, showLost, showNoMemory, showPanic, showStartFailed, showUnsupported } from "./panels.js";
import { agreePixels } from "./pixels.js";
import { Rest, compilesNow } from "./rest.js";

const PANIC_POLL_MS = 500;
/** The memory from which on a trap without a panic is taken for a failed allocation, bytes. */
const MIN_EXHAUSTED_BYTES = 1 << 30;
/**
 * The pause before each attempt to replace a lost graphics device; a device may need time to
 * recover.
 */
const REPLACE_AFTER_MS = [0, 100, 300, 1000, 3000];
/** The name of the database of stored work (src/platform/web/storage.rs). */
const DATABASE = "segue";
/** The longest time for which the names of databases are awaited. */
const MAX_LISTING_MS = 500;
/** The longest time for which a WebGPU device is awaited: a browser may never answer. */
const MAX_DEVICE_MS = 30_000;

/** The reasons why the app goes on with WebGL 2 in a new page. */
const NEEDS_WEBGL2 = new Error("WebGPU was lost twice within 10 seconds.");
const NO_ANSWER = new Error("The browser gives no WebGPU device.");

async function start() {
  // Only a cheap test precedes the start. The graphics are tested thoroughly when the start has
  // failed.
  if (!navigator.gpu && !window.WebGL2RenderingContext) {
    showUnsupported();
    throw new Error("Neither WebGPU nor WebGL2 is available");
  }

  let chosen;
  try {
    chosen = await chosenModule();
  } catch (reason) {
    return withWebgl2Instead(reason);
  }
  const needsAll = hasMoreThanFirstVisit();
  let bindings;
  let memory;
  let rest;
  try {
    const module = import(new URL(chosen.js, document.baseURI)); // relative to the page, not to this module
    rest = new Rest(chosen.rest, needsAll.then((all) => (all ? undefined : chosen.compiled)));
    needsAll.then((all) => all && rest.compile());
    const compiled = await chosen.compiled;
    bindings = await module;
    const exports = await bindings.default({ module_or_path: compiled });
    memory = exports?.memory;
    // Before this, nothing of the app has run but the set-up of its log.
    rest.follow(exports);
    if (await needsAll) await rest.complete();
  } catch (reason) {
    throw notDownloaded(reason);
  }

  const { SegueHandle } = bindings;
  if (!SegueHandle?.start) {
    loaded();
    throw new Error("The WebAssembly module exports no SegueHandle");
  }

  agreePixels();
  const app = new RunningApp(memory);
  // Corpora have modules of their own, which come with the first call.
  const corpora = async (call, ...args) => (await import("./corpus/corpora.js"))[call](app, ...args);
  try {
    const started = Promise.race([SegueHandle.start(canvas(), newReader, newComputer, corpora), app.trapped]);
    app.handle = await (mayUseWebgpu() ? answerOf(started) : started);
    app.watch();
    rest.compile();
    await Promise.race([app.handle.firstFrame(), app.trapped]);
  } catch (reason) {
    const text = app.handle ? app.panicText(reason) : String(reason?.message ?? reason);
    if (reason instanceof WebAssembly.RuntimeError) {
      showPanic(text, app.facts());
    } else if ((!chosen.hasWebgl2 || reason === NO_ANSWER) && !isAsked("webgpu")) {
      return withWebgl2Instead(text);
    } else if (!(await hasGraphics())) {
      showUnsupported();
    } else {
      showStartFailed(text, app.facts());
    }
    throw new Error(`Segue could not start: ${text}`, { cause: reason });
  }

  loaded();
  document.documentElement.classList.add("waiting");
  // From here on it hears of a lost graphics device.
  const api = makeApi(app.handle, { stopped: () => app.stopped, onLost: () => app.rebuild() });
  try {
    await Promise.race([rest.complete(), app.trapped]);
  } catch (reason) {
    throw reason instanceof WebAssembly.RuntimeError ? reason : notDownloaded(reason);
  } finally {
    document.documentElement.classList.remove("waiting");
  }
  app.handle.setComplete();
  window.segue = api;
  answerParent(api, app.handle.isEmbedded());
  registerServiceWorker(app.handle.stats().backend);
  // After the first frame, so that nothing waits for it.
  import("./outline.js").then(({ Outline }) => new Outline(app.handle, canvas), (reason) => console.error(reason));
  return api;
}

/**
 * Returns whether the page shows more than a first visit does, and so needs the whole program for
 * its first frame: a link's state, or stored work.
 */
async function hasMoreThanFirstVisit() {
  const asked = new URLSearchParams(location.search);
  if ([...asked.keys()].some((key) => !["backend", "lang"].includes(key)) || isAsked("fallback") || !compilesNow()) return true;
  // A browser that does not tell may have one.
  const late = new Promise((resolve) => setTimeout(resolve, MAX_LISTING_MS));
  try {
    const databases = await Promise.race([indexedDB.databases(), late]);
    return !databases || databases.some(({ name }) => name === DATABASE);
  } catch {
    return true;
  }
}

/** Shows that a part of the app could not be downloaded, and returns the error for the API. */
function notDownloaded(reason) {
  const text = String(reason?.message ?? reason);
  showDownloadFailed(text);
  return new Error(`Segue could not be downloaded: ${text}`, { cause: reason });
}

/**
 * Registers sw.js, which serves the page without a network, with the module for the graphics that
 * the app draws with: after a late answer about WebGPU it is another one than that of this visit. A
 * development build has no name, and registers nothing.
 */
function registerServiceWorker(backend) {
  if (!document.querySelector('meta[name="build"]')) return;
  // After the start of the page, because all files are requested again, from the browser's cache
  // where it has them.
  const worker = new URL(`sw.js?module=${backend === "webgpu" ? backend : "webgl2"}`, document.baseURI);
  const register = () => navigator.serviceWorker?.register(worker).catch((reason) => console.info(reason));
  (window.requestIdleCallback ?? setTimeout)(register);
}

/** Makes a worker that reads files; see reader.js. */
const newReader = () => new Worker(new URL("./reader.js", import.meta.url), { type: "module" });

let computerModule;

/**
 * Makes a worker that computes; see compute.js. Its WebAssembly is downloaded and compiled once,
 * for the first one.
 */
function newComputer(maxBytes) {
  const worker = new Worker(new URL("./compute.js", import.meta.url), { type: "module" });
  computerModule ??= WebAssembly.compileStreaming(fetch(new URL("./compute/compute_bg.wasm", import.meta.url)));
  computerModule.then((module) => worker.postMessage({ module, maxBytes }), (reason) => worker.postMessage({ failed: String(reason?.message ?? reason) }));
  return worker;
}

/**
 * Returns the module that first.js downloads, or the one with WebGL 2 where that has WebGPU alone
 * and the browser has no device for it. Rejects where the browser does not answer: the module with
 * WebGL 2 would ask it again.
 */
async function chosenModule() {
  const { module: first, withWebgl2 } = window.segueDownload;
  const module = compiled(await answerOf(first));
  if (module.hasWebgl2 || isAsked("webgpu") || (await hasWebgpu())) return module;
  module.stop();
  return compiled(withWebgl2());
}

/** Returns a module that is being downloaded with the promise of its compiled code. */
function compiled(module) {
  const compiled = WebAssembly.compileStreaming(download(module));
  compiled.catch(() => {}); // start() shows it
  return { ...module, compiled };
}

/** Returns whether `backend=` in the page's address has this value. */
const isAsked = (backend) => new URLSearchParams(location.search).get("backend") === backend;

/**
 * Returns whether the app asks for WebGPU, which may fail, or never answer. The module with WebGL 2
 * does, too, unless the address says otherwise.
 */
const mayUseWebgpu = () => Boolean(navigator.gpu) && !isAsked("webgl2") && !isAsked("fallback");

/** Returns whether there is a WebGPU device. An adapter alone may have none. */
async function hasWebgpu() {
  try {
    const adapter = await answerOf(navigator.gpu.requestAdapter());
    const device = await answerOf(adapter?.requestDevice());
    device?.destroy();
    return Boolean(device);
  } catch (reason) {
    if (reason === NO_ANSWER) throw reason;
    return false;
  }
}

/** Waits for what needs a WebGPU device; rejects with `NO_ANSWER` where it takes too long. */
function answerOf(promise) {
  let timer;
  const late = new Promise((_, reject) => {
    timer = setTimeout(() => reject(NO_ANSWER), MAX_DEVICE_MS);
  });
  return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

/** Gives up WebGPU at the start of a page. */
function withWebgl2Instead(reason) {
  console.warn(reason);
  reloadWithWebgl2();
  return new Promise(() => {}); // the next page settles its own
}

/** Loads the page again with the module that has WebGL 2; the address forgets that. */
function reloadWithWebgl2() {
  const others = location.search.slice(1).split("&").filter((pair) => pair && !pair.startsWith("backend="));
  history.replaceState(history.state, "", `${location.pathname}?${[...others, "backend=fallback"].join("&")}${location.hash}`);
  location.reload();
}

/** Waits for the response of a module, and moves the progress bar as its bytes arrive. */
async function download({ wasm, response: asked }) {
  const response = await asked;
  if (!response.ok) throw new Error(`${wasm} answered ${response.status}`);
  // The stated length is that of the compressed bytes, and the bytes read are uncompressed. These
  // are the ratios for this module.
  const packed = { br: 3.3, gzip: 2.5 }[response.headers.get("content-encoding")] ?? 1;
  const total = Number(response.headers.get("content-length")) * packed || 5e6;
  // A clone is read to count the bytes, because the browser caches compiled code only of a response
  // that it reads itself.
  followBytes(response.clone().body, total).catch(() => {});
  return response;
}

async function followBytes(stream, total) {
  const bar = document.getElementById("progress");
  const reader = stream.getReader();
  for (let read = 0; ; ) {
    const { done, value } = await reader.read();
    if (done) break;
    read += value.byteLength;
    bar.style.transform = `scaleX(${Math.min(read / total, 0.97)})`;
  }
  bar.style.transform = "scaleX(1)";
  bar.classList.add("starting");
}

const canvas = () => document.getElementById("segue");

function loaded() {
  document.getElementById("loading")?.remove();
  canvas().focus();
}

async function hasGraphics() {
  const adapter = navigator.gpu && answerOf(navigator.gpu.requestAdapter());
  if (await adapter?.catch(() => null)) return true;
  return Boolean(document.createElement("canvas").getContext("webgl2"));
}

/** The running app, from its start to its panic. */
class RunningApp {
  handle = undefined;
  /** The reason why it no longer runs; undefined while it does. */
  stopped = undefined;
  #memory;
  #restarting = false;
  #lostMeanwhile = false;

  /** @param memory the app's `WebAssembly.Memory` */
  constructor(memory) {
    this.#memory = memory;
    // A panic in a callback surfaces only here, as a trap outside of any call of this script.
    this.trapped = new Promise((_, reject) => {
      window.addEventListener("error", ({ error }) => {
        if (!(error instanceof WebAssembly.RuntimeError)) return;
        reject(error);
        this.#check(error);
      });
      window.addEventListener("unhandledrejection", ({ reason }) => {
        if (!(reason instanceof WebAssembly.RuntimeError)) return;
        reject(reason);
        this.#check(reason);
      });
    });
    this.trapped.catch(() => {});
    this.#watchContext(canvas());
  }

  /** Starts to watch for panics. Call it when the handle exists. */
  watch() {
    const timer = setInterval(() => {
      this.#check();
      if (this.stopped) clearInterval(timer);
    }, PANIC_POLL_MS);
  }

  panicText(fallback) {
    // The package and the line matter, not the folder on the machine that compiled it.
    const summary = this.#summary()?.replace(/^panicked at .*\/registry\/src\/[^/]+\//, "panicked at ");
    return summary ?? String(fallback?.message ?? fallback ?? "The app stopped without a message.");
  }

  /** Returns the app's summary of its panic; undefined where there was none. */
  #summary() {
    try {
      const summary = this.handle.panicSummary();
      return summary ? String(summary) : undefined;
    } catch {
      return undefined; // an app that has trapped may be unable to answer
    }
  }

  facts() {
    const attempt = (call) => {
      try {
        return call();
      } catch {
        return undefined;
      }
    };
    return {
      version: attempt(() => this.handle?.version()),
      backend: attempt(() => this.handle?.stats()?.backend),
    };
  }

  #check(trap) {
    if (this.stopped || !this.handle) return;
    let panicked = Boolean(trap);
    try {
      panicked ||= this.handle.hasPanicked();
    } catch {
      panicked = true;
    }
    if (!panicked) return;
    this.stopped = this.panicText(trap);
    const bytes = this.#memory?.buffer.byteLength ?? 0;
    if (trap && bytes >= MIN_EXHAUSTED_BYTES && !this.#summary()) showNoMemory(bytes, this.stopped, this.facts());
    else showPanic(this.stopped, this.facts());
  }

  #watchContext(element) {
    element.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      if (element === canvas()) this.rebuild();
    });
  }

  /**
   * Moves the app to a new canvas after the graphics context was lost, repeatedly where the new one
   * is lost as well. A canvas keeps the kind of its first context, so the old one cannot be used
   * again.
   */
  async rebuild() {
    this.#lostMeanwhile = true;
    if (this.#restarting || this.stopped || !this.handle) return;
    this.#restarting = true;
    let last;
    for (const wait of REPLACE_AFTER_MS) {
      if (wait) await new Promise((resolve) => setTimeout(resolve, wait));
      if (this.stopped) break;
      this.#lostMeanwhile = false;
      last = await this.#replace().catch((reason) => reason);
      if (last === NEEDS_WEBGL2 || last === NO_ANSWER) return this.#moveToWebgl2(last);
      if (last) console.warn(last);
      if (!last && !this.#lostMeanwhile) break;
    }
    this.#restarting = false;
    if (this.stopped || !(last || this.#lostMeanwhile)) return;
    showLost(String(last?.message ?? last ?? "It was lost repeatedly."), this.facts());
  }

  async #replace() {
    const old = canvas();
    const fresh = old.cloneNode(false);
    old.replaceWith(fresh);
    this.#watchContext(fresh);
    const restarted = await answerOf(this.handle.restart(fresh));
    if (restarted === false) throw NEEDS_WEBGL2;
    canvas().focus();
  }

  /** Goes on in a new page, which restores everything from the storage. */
  async #moveToWebgl2(reason) {
    // A page in a frame stores nothing.
    if (await this.handle.stored()) reloadWithWebgl2();
    else showLost(reason.message, this.facts(), reloadWithWebgl2);
  }
}

if (document.documentElement.lang === "zh-Hant") document.getElementById("loading").setAttribute("aria-label", "Segue 載入中");

start().then(window.segueSettle.resolve, (reason) => {
  window.segueSettle.reject(reason);
  console.error(reason);
});
