// Puts clips of a corpus into the app: on the stage, or into A and B of a lab.
//
// A clip of a corpus at an address is loaded by that address, as in a link, so that the link to the
// present state has it. One of a folder is loaded as a file.

import { clipAddress, clipOf } from "./address.js";
import { clipsRead } from "./client.js";

/** Labs that have no B. */
const WITHOUT_B = new Set(["view", "make", "loop", "path", "graph", "match", "in_place", "edit", "clean"]);
/** The most addresses of files in a link. */
const MAX_SOURCES = 16;

export class Player {
  #api;
  #discard;
  /** Clips that were only looked at: id in the library by address or by a key of its own. */
  #lookedAt = new Map();
  #queue = Promise.resolve();
  #latest = 0;

  /**
   * @param api the page's API
   * @param discard takes a clip out of the library by its id
   */
  constructor(api, discard) {
    [this.#api, this.#discard] = [api, discard];
  }

  /**
   * Puts a clip into a slot.
   * @param clip { corpus, id, range }; `read` instead of `corpus` returns its name and bytes
   * @param options.slot "A" or "B" of the open lab; without it, the clip plays alone
   * @param options.seconds where it begins to play
   * @returns whether it was the latest that was asked for: of several at once only the last is put
   */
  put(clip, options = {}) {
    const number = ++this.#latest;
    const done = this.#queue.then(() => (number === this.#latest || options.slot ? this.#put(clip, options) : false));
    this.#queue = done.catch(() => {});
    return done;
  }

  async #put({ corpus, id, range, read }, { slot, seconds }) {
    const params = this.#api.params();
    const address = corpus && clipAddress(corpus, id, range);
    const clipId = address ? await this.#fetch(address, params) : await this.#load(await read());
    const lab = !slot ? "view" : slot === "B" && WITHOUT_B.has(params.lab) ? "blend" : params.lab;
    const values = { lab, [slot === "B" ? "b" : "a"]: clipId };
    const wanted = { ...this.#api.params(), ...values };
    const dropped = this.#unused(wanted, clipId);
    values.src = addresses(wanted).filter((other) => !dropped.has(other)).join(" ");
    await this.#api.set(values);
    for (const [key, old] of dropped) {
      this.#lookedAt.delete(key);
      // It may be gone by the user's hand.
      try { this.#discard(old); } catch { /* nothing to discard */ }
    }
    const key = address ?? clipId;
    if (slot) this.#lookedAt.delete(key);
    else if (!this.#lookedAt.has(key)) this.#lookedAt.set(key, clipId);
    if (slot) return true;
    this.#api.seek(seconds ?? 0);
    if (!window.matchMedia("(prefers-reduced-motion: reduce)").matches) this.#api.play();
    return true;
  }

  /** Has the app load an address. Returns the id of the clip in the library. */
  async #fetch(address, params) {
    const sources = addresses(params);
    if (!sources.includes(address) || this.#idOf(address) === undefined) {
      let failure;
      const stop = this.#api.on("error", ({ message }) => { failure ??= message; });
      try {
        // An address that is there already is fetched again only when it comes anew.
        if (sources.includes(address)) await this.#api.set({ src: sources.filter((other) => other !== address).join(" ") });
        const others = sources.filter((other) => other !== address).slice(-(MAX_SOURCES - 1));
        // Both slots are named, so that the clip that comes takes neither by itself.
        const here = new Set(this.#api.clips().map(({ id }) => id));
        const slots = Object.fromEntries(["a", "b"].filter((key) => here.has(params[key])).map((key) => [key, params[key]]));
        await this.#api.set({ src: [...others, address].join(" "), ...slots });
        await this.#api.loaded();
      } finally {
        stop();
      }
      if (this.#idOf(address) === undefined) throw new Error(failure ?? address);
    }
    return this.#idOf(address);
  }

  async #load([name, bytes]) {
    const { clips } = await this.#api.load(name, bytes);
    return clips[0].id;
  }

  /** Returns the id in the library of the clip at an address; undefined if it is not there. */
  #idOf(address) {
    const read = clipsRead.get(address);
    if (!read) return undefined;
    // Without a SHA-256, on an insecure address or of a file from the browser's storage, the name
    // must do. Built-in clips have none.
    const isIt = ({ id, sha256 }) => (read.sha256 ? sha256 === read.sha256 : sha256 && stemOf(id) === read.name);
    return this.#api.clips().find(isIt)?.id;
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

/** Returns the addresses of files in the link. */
const addresses = ({ src }) => String(src ?? "").split(/\s+/).filter(Boolean);

/** Returns the name of a clip's file without its ending, given the clip's id. */
const stemOf = (id) => id.split("~")[0];
