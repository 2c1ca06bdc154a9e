// Corpora that are open, each in a worker of its own (worker.js).

import { clipOf } from "./address.js";
import { sentence } from "./words.js";

/** The number of corpora that are kept open. */
const MAX_OPEN = 4;

/** The corpora at addresses, the latest last. */
const open = new Map();

/** What is known of clips that were read, by their addresses: row, name and SHA-256 of the file. */
export const clipsRead = new Map();

/** Returns the corpus at the address of its corpus.json. It may be still opening. */
export function corpusAt(address) {
  let client = open.get(address);
  open.delete(address);
  client ??= new Client({ address });
  open.set(address, client);
  client.opened.catch(() => {
    if (open.get(address) === client) open.delete(address);
    client.end();
  });
  for (const [oldest, { end }] of open) {
    if (open.size <= MAX_OPEN) break;
    end();
    open.delete(oldest);
  }
  return client;
}

/** Returns the corpus in files of this computer, by their paths. */
export const corpusOf = (files) => new Client({ files });

/** Reads the clip at an address. Returns the name of its file, and its bytes. */
export async function readClip(address, signal) {
  const clip = clipOf(address);
  if (!clip) throw new Error(sentence("noClipAddress", { address }));
  const client = corpusAt(clip.corpus);
  await client.opened;
  const { row, name, sha256, bytes } = await client.call("clip", clip, { signal });
  clipsRead.set(address, { row, name, sha256 });
  return [`${name.replaceAll("/", " ")}.npz`, bytes];
}

class Client {
  #worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
  #calls = new Map();
  #count = 0;

  /** @param place { address } or { files } */
  constructor(place) {
    this.#worker.onmessage = ({ data: { call, part, result, error } }) => {
      const waiting = this.#calls.get(call);
      if (part !== undefined) return waiting?.onPart(part);
      this.#calls.delete(call);
      if (error) waiting?.reject(asError(error));
      else waiting?.resolve(result);
    };
    this.#worker.onerror = (event) => {
      event.preventDefault();
      this.#fail(new Error(sentence("noWorker", { reason: event.message ?? "" })));
    };
    /** What the corpus says of itself: { rows, counts, columns }. */
    this.opened = this.call("open", place);
  }

  /**
   * Calls the worker.
   * @param options.signal cancels the call
   * @param options.onPart gets the parts of its answer
   */
  call(name, args = {}, { signal, onPart = () => {} } = {}) {
    const call = ++this.#count;
    return new Promise((resolve, reject) => {
      if (signal?.aborted) return reject(signal.reason);
      this.#calls.set(call, { resolve, reject, onPart });
      signal?.addEventListener("abort", () => {
        if (!this.#calls.delete(call)) return;
        this.#worker.postMessage({ cancel: call });
        reject(signal.reason);
      });
      this.#worker.postMessage({ call, name, args });
    });
  }

  /** Ends the worker. */
  end = () => {
    this.#worker.terminate();
    this.#fail(new DOMException("the corpus was closed", "AbortError"));
  };

  #fail(error) {
    for (const { reject } of this.#calls.values()) reject(error);
    this.#calls.clear();
  }
}

function asError({ word, values, text, isCancelled }) {
  if (isCancelled) return new DOMException("cancelled", "AbortError");
  if (word) return new Error(sentence(word, values));
  // The WebAssembly gives reasons, which become sentences here.
  return new Error(`${text.charAt(0).toUpperCase()}${text.slice(1)}${/[.!?]$/.test(text) ? "" : "."}`);
}
