// Starts the app: downloads and compiles the WebAssembly, hands it the canvas, and settles `window.segueReady`.
//
// What this expects of the app (the wasm-bindgen module): a class `SegueHandle` with
//   static start(canvas, newReader) -> Promise<SegueHandle>   the app runs on this canvas; newReader makes a worker for files
//   firstFrame() -> Promise                        its first frame is on screen
//   restart(canvas) -> Promise                     the graphics context was lost: go on, on this fresh canvas
//   isEmbedded()                                  whether the link says so: the frame then answers the page around it, and stores nothing
//   hasPanicked(), panicSummary()                  callable at any time, also in the middle of another call
//   setListener((event, detail) => …)              "change", "error", "progress" for the public API, and "lost" when
//                                                  the app itself learns that its graphics device is gone
// and what api.js calls. Every method borrows the handle shared: after a panic inside an exclusive one, wasm-bindgen
// would refuse all others, panicSummary among them.

import { makeApi } from "./api.js";
import { answerParent } from "./embed.js";
import { showDownloadFailed, showLost, showNoMemory, showPanic, showStartFailed, showUnsupported } from "./panels.js";

const PANIC_POLL_MS = 500;
/** A trap without a panic, while so much memory is held, comes from an allocation that failed. */
const MUCH_MEMORY = 1 << 30;
/** How long to wait before each attempt to replace a graphics device: one that dies at once is given time. */
const REPLACE_AFTER_MS = [0, 100, 300, 1000, 3000];

async function start(jsUrl, wasmUrl) {
  // Only what costs nothing is asked before the start; a real look at the graphics waits until the start has failed.
  if (!navigator.gpu && !window.WebGL2RenderingContext) {
    showUnsupported();
    throw new Error("Neither WebGPU nor WebGL2 is available");
  }

  let bindings;
  let memory;
  try {
    const module = import(new URL(jsUrl, document.baseURI)); // relative to the page, not to this module
    const compiled = await WebAssembly.compileStreaming(download(wasmUrl));
    bindings = await module;
    ({ memory } = (await bindings.default({ module_or_path: compiled })) ?? {});
  } catch (reason) {
    showDownloadFailed(String(reason?.message ?? reason));
    throw new Error(`Segue could not be downloaded: ${reason?.message ?? reason}`, { cause: reason });
  }

  const { SegueHandle } = bindings;
  if (!SegueHandle?.start) {
    loaded();
    throw new Error("The WebAssembly module exports no SegueHandle");
  }

  const life = new Life(memory);
  try {
    life.handle = await Promise.race([SegueHandle.start(canvas(), newReader), life.trapped]);
    life.watch();
    await Promise.race([life.handle.firstFrame(), life.trapped]);
  } catch (reason) {
    const text = life.handle ? life.panicText(reason) : String(reason?.message ?? reason);
    if (reason instanceof WebAssembly.RuntimeError) {
      showPanic(text, life.facts());
    } else if (!(await hasGraphics())) {
      showUnsupported();
    } else {
      showStartFailed(text, life.facts());
    }
    throw new Error(`Segue could not start: ${text}`, { cause: reason });
  }

  loaded();
  const api = makeApi(life.handle, { stopped: () => life.stopped, onLost: () => life.rebuild() });
  window.segue = api;
  answerParent(api, life.handle.isEmbedded());
  keepForLater();
  // After the first frame, so that nothing waits for it.
  import("./outline.js").then(({ Outline }) => new Outline(life.handle, canvas), (reason) => console.error(reason));
  return api;
}

/** From the second visit on the page comes without a network; see sw.js. A build that is worked on has no name and keeps nothing. */
function keepForLater() {
  if (!document.querySelector('meta[name="build"]')) return;
  // Not while the page begins: the files come a second time, from the browser's own copy where it has one.
  const keep = () => navigator.serviceWorker?.register(new URL("sw.js", document.baseURI)).catch((reason) => console.info(reason));
  (window.requestIdleCallback ?? setTimeout)(keep);
}

/** A worker that reads files; see reader.js. */
const newReader = () => new Worker(new URL("./reader.js", import.meta.url), { type: "module" });

/** Fetches the module and moves the bar as its bytes arrive. */
async function download(url) {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url} answered ${response.status}`);
  // The length is that of what travels, the bytes read are unpacked; these are how far this module packs.
  const packed = { br: 3.6, gzip: 2.9 }[response.headers.get("content-encoding")] ?? 1;
  const total = Number(response.headers.get("content-length")) * packed || 8e6;
  // A clone is read for the count, for the browser keeps compiled code only of a response that it got itself.
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
  if (await navigator.gpu?.requestAdapter().catch(() => null)) return true;
  return Boolean(document.createElement("canvas").getContext("webgl2"));
}

/** One life of the app, from its start to its panic. */
class Life {
  handle = undefined;
  /** Why it no longer runs, if it does not. */
  stopped = undefined;
  #memory;
  #restarting = false;
  #lostMeanwhile = false;

  /** @param memory the app's `WebAssembly.Memory` */
  constructor(memory) {
    this.#memory = memory;
    // A panic in a callback surfaces only here: as a trap, outside of any call of ours.
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
    this.#guard(canvas());
  }

  /** From here on the handle exists: look after it. */
  watch() {
    const timer = setInterval(() => {
      this.#check();
      if (this.stopped) clearInterval(timer);
    }, PANIC_POLL_MS);
  }

  panicText(fallback) {
    // Which package and line is of use, not where it lay on the machine that compiled it.
    const summary = this.#summary()?.replace(/^panicked at .*\/registry\/src\/[^/]+\//, "panicked at ");
    return summary ?? String(fallback?.message ?? fallback ?? "The app stopped without a word.");
  }

  /** What the app says of its panic, where there was one. */
  #summary() {
    try {
      const summary = this.handle.panicSummary();
      return summary ? String(summary) : undefined;
    } catch {
      return undefined; // what trapped can be past answering
    }
  }

  facts() {
    const ask = (question) => {
      try {
        return question();
      } catch {
        return undefined;
      }
    };
    return {
      version: ask(() => this.handle?.version()),
      backend: ask(() => this.handle?.stats()?.backend),
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
    if (trap && bytes >= MUCH_MEMORY && !this.#summary()) showNoMemory(bytes, this.stopped, this.facts());
    else showPanic(this.stopped, this.facts());
  }

  #guard(element) {
    element.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      if (element === canvas()) this.rebuild();
    });
  }

  /** The graphics context is gone. A canvas keeps the kind of context it once had, so the app moves to a new one, again and again where that is lost, too. */
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
      if (last) console.warn(last);
      if (!last && !this.#lostMeanwhile) break;
    }
    this.#restarting = false;
    if (this.stopped || !(last || this.#lostMeanwhile)) return;
    showLost(String(last?.message ?? last ?? "It was lost again and again."), this.facts());
  }

  async #replace() {
    const old = canvas();
    const fresh = old.cloneNode(false);
    old.replaceWith(fresh);
    this.#guard(fresh);
    await this.handle.restart(fresh);
    canvas().focus();
  }
}

if (document.documentElement.lang === "zh-Hant") document.getElementById("loading").setAttribute("aria-label", "Segue 載入中");

// The page names the two files of the app beside this script (Trunk.toml).
const { js, wasm } = document.querySelector("script[data-wasm]").dataset;
start(js, wasm).then(window.segueSettle.resolve, (reason) => {
  window.segueSettle.reject(reason);
  console.error(reason);
});
