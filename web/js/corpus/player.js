// Puts clips of a corpus into the app: on the stage, or into A and B of a lab.
//
// A clip of a corpus at an address is loaded by that address, as in a link, so that the link to the
// present state has it. One of a folder is loaded as a file.

import { clipAddress, clipOf } from "./address.js";
import { clipsRead } from "./client.js";

/** The most addresses of files in a link. */
const MAX_SOURCES = 16;

export class Player {
  #api;
  #app;
  /** Clips that were only looked at: id in the library by address or by a key of its own. */
  #lookedAt = new Map();
  /** Addresses whose clips the app was asked for, and that failed or gave way to a newer click. */
  #dropped = new Set();
  #queue = Promise.resolve();
  /** Drops the clip that is being put on the stage to be looked at. */
  #drop = new AbortController();

  /**
   * @param api the page's API
   * @param app returns the app, of which the API shows a part: `discard(id)` takes a clip out of the
   *   library, `joinSteps(begins)` makes one step of undo of several changes
   */
  constructor(api, app) {
    [this.#api, this.#app] = [api, app];
  }

  /**
   * Puts a clip into a slot.
   * @param clip { corpus, id, range }; `read` instead of `corpus` returns its name and bytes
   * @param options.slot "A" or "B" of the open lab; without it, the clip plays alone
   * @param options.seconds where it begins to play
   *
   * Of several that are asked for, those that would play alone give way to the last one: they end
   * with an `AbortError`, also while they are read.
   */
  put(clip, options = {}) {
    this.#drop.abort(new DOMException("another clip was asked for", "AbortError"));
    this.#drop = new AbortController();
    const signal = options.slot ? undefined : this.#drop.signal;
    const done = this.#queue.then(() => this.#putInOneStep(clip, options, signal));
    this.#queue = done.catch(() => {});
    return done;
  }

  async #putInOneStep(clip, options, signal) {
    signal?.throwIfAborted();
    this.#app().joinSteps(true);
    try {
      await this.#put(clip, options, signal);
    } finally {
      this.#app().joinSteps(false);
    }
  }

  async #put({ corpus, id, range, read }, { slot, seconds }, signal) {
    const params = this.#api.params();
    const address = corpus && clipAddress(corpus, id, range);
    const clipId = address ? await this.#fetch(address, params, signal) : await this.#load(await unlessDropped(read(), signal));
    const lab = !slot ? "view" : slot === "B" && !this.#hasB(params.lab) ? "blend" : params.lab;
    const values = { lab, [slot === "B" ? "b" : "a"]: clipId };
    const wanted = { ...this.#api.params(), ...values };
    this.#lookAtDropped(address);
    const unused = this.#unused(wanted, clipId);
    values.src = this.#sources(wanted).filter((other) => !unused.has(other)).join(" ");
    await this.#api.set(values);
    this.#dropped.clear();
    for (const [key, old] of unused) {
      this.#lookedAt.delete(key);
      // It may be gone by the user's hand.
      try { this.#app().discard(old); } catch { /* nothing to discard */ }
    }
    const key = address ?? clipId;
    if (slot) this.#lookedAt.delete(key);
    else if (!this.#lookedAt.has(key)) this.#lookedAt.set(key, clipId);
    if (slot || signal.aborted) return;
    this.#api.seek(seconds ?? 0);
    if (!window.matchMedia("(prefers-reduced-motion: reduce)").matches) this.#api.play();
  }

  /** Returns whether a lab has a B. */
  #hasB(lab) {
    return this.#api.keys().some(({ key, labs }) => key === "b" && labs.includes(lab));
  }

  /** Has the app load an address. Returns the id of the clip in the library. */
  async #fetch(address, params, signal) {
    const sources = addresses(params);
    if (sources.includes(address) && this.#idOf(address) !== undefined) return this.#idOf(address);
    let failure;
    const stop = this.#api.on("error", ({ message }) => { failure ??= message; });
    try {
      await unlessDropped(this.#request(address, params, signal), signal);
      const id = this.#idOf(address);
      if (id === undefined) throw new Error(failure ?? address);
      return id;
    } catch (reason) {
      this.#dropped.add(address);
      throw reason;
    } finally {
      stop();
    }
  }

  async #request(address, params, signal) {
    const others = this.#sources(params).filter((other) => other !== address).slice(-(MAX_SOURCES - 1));
    // An address that is there already is fetched again only when it comes anew.
    if (addresses(params).includes(address)) await this.#api.set({ src: others.join(" ") });
    signal?.throwIfAborted();
    this.#dropped.delete(address);
    // Both slots are named, so that the clip that comes takes neither by itself.
    const here = new Set(this.#api.clips().map(({ id }) => id));
    const slots = Object.fromEntries(["a", "b"].filter((key) => here.has(params[key])).map((key) => [key, params[key]]));
    await this.#api.set({ src: [...others, address].join(" "), ...slots });
    await this.#api.loaded();
  }

  /** Returns the addresses in the link, without those that were dropped: the app stops to read these. */
  #sources(params) {
    return addresses(params).filter((address) => !this.#dropped.has(address));
  }

  /** Takes clips that came though they were dropped for such that were looked at. */
  #lookAtDropped(exceptAddress) {
    for (const address of this.#dropped) {
      const id = this.#idOf(address);
      if (id !== undefined && address !== exceptAddress) this.#lookedAt.set(address, id);
    }
  }

  async #load([name, bytes]) {
    const { clips } = await this.#api.load(name, bytes);
    return clips[0].id;
  }

  /** Returns the id in the library of the clip at an address; undefined if it is not there. */
  #idOf(address) {
    const read = clipsRead.get(address);
    if (!read) return undefined;
    // A page at an insecure address has no SHA-256 of its own, so that the name must do. Built-in
    // clips have none.
    const isIt = ({ id, sha256 }) => (read.sha256 ? sha256 === read.sha256 : sha256 && stemOf(id) === read.name);
    return this.#api.clips().find(isIt)?.id;
  }

  /** Returns whether the library has a clip with the name of a clip of a corpus. */
  hasNamed(name) {
    return this.#api.clips().some(({ id, sha256 }) => sha256 && stemOf(id) === name);
  }

  /** Returns clips that were only looked at, and that nothing uses any more: their ids by their keys. */
  #unused(params, exceptId) {
    const others = this.#api.clips().map(({ id }) => id);
    const texts = Object.entries(params).filter(([key]) => key !== "src" && key !== "corpus").map(([, value]) => String(value));
    const isUsed = (id) => texts.some((text) => text.includes(id)) || others.some((other) => other !== id && other.includes(id));
    return new Map([...this.#lookedAt].filter(([, id]) => id !== exceptId && !isUsed(id)));
  }

  /**
   * Returns the clip of a corpus in A: its id, range and id in the library; undefined if A has
   * another one.
   */
  playing(corpus) {
    const params = this.#api.params();
    for (const address of addresses(params).reverse()) {
      const clip = clipOf(address);
      if (clip?.corpus !== corpus) continue;
      const id = this.#idOf(address);
      if (id !== undefined && id === params.a) return { ...clip, clipId: id };
    }
    return undefined;
  }
}

/** Waits for a promise, unless the signal comes before. */
function unlessDropped(promise, signal) {
  if (!signal) return promise;
  return new Promise((resolve, reject) => {
    signal.addEventListener("abort", () => reject(signal.reason), { once: true });
    promise.then(resolve, reject);
  });
}

/** Returns the addresses of files in the link. */
export const addresses = ({ src }) => String(src ?? "").split(/\s+/).filter(Boolean);

/** Returns the name of a clip's file without its ending, given the clip's id. */
const stemOf = (id) => id.split("~")[0];
