// Corpora that are open, each in a worker of its own (worker.js).

import { clipOf } from "./address.js";
import { sentence } from "./words.js";

/** The number of corpora that are kept open. */
const MAX_OPEN = 4;

/** The corpora at addresses, the latest last. */
const open = new Map();

/** What is known of clips that were read, by their addresses: row, name and SHA-256 of the file. */
export const clipsRead = new Map();

/** The addresses of clips that are being read. */
const reading = new Set();

/** Returns whether a clip at an address was read, or is being read. */
export const isRead = (address) => clipsRead.has(address) || reading.has(address);

/** Returns the corpus at the address of its corpus.json. It may be still opening. */
export function corpusAt(address) {
  let client = open.get(address);
  open.delete(address);
  if (!client || client.hasEnded) {
    client = new Client({ address });
    client.opened.catch(() => {
      client.end();
      if (open.get(address) === client) open.delete(address);
    });
  }
  open.set(address, client);
  // One that is shown or asked stays.
  const idle = [...open].filter(([, other]) => other !== client && !other.isShown && !other.isAsked);
  for (const [oldest, other] of idle) {
    if (open.size <= MAX_OPEN) break;
    other.end();
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
  reading.add(address);
  let bytes, name;
  try {
    await client.opened;
    const read = await client.call("clip", clip, { signal });
    ({ bytes, name } = read);
    clipsRead.set(address, { row: read.row, name, sha256: read.sha256 });
  } finally {
    reading.delete(address);
  }
  return [`${name.replaceAll("/", " ")}.npz`, bytes];
}

class Client {
  /** Whether the panel shows it. */
  isShown = false;
  #worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
  #calls = new Map();
  #count = 0;
  /** Why the worker answers no more. */
  #end;

  /** @param place { address } or { files } */
  constructor(place) {
    this.#worker.onmessage = ({ data: { call, part, result, error } }) => {
      const waiting = this.#calls.get(call);
      if (part !== undefined) return waiting?.onPart(part);
      if (!error) return waiting?.resolve(result);
      const reason = asError(error);
      waiting?.reject(reason);
      // WebAssembly that has trapped gives wrong answers from then on, or none.
      if (error.word === "trapped") this.#stop(reason);
    };
    this.#worker.onerror = (event) => {
      event.preventDefault();
      this.#stop(new Error(sentence("noWorker", { reason: event.message ?? "" })));
    };
    /** What the corpus says of itself: { rows, counts, columns }. */
    this.opened = this.call("open", place);
  }

  /** Whether calls are refused. */
  get hasEnded() {
    return this.#end !== undefined;
  }

  /** Whether a call waits for its answer. */
  get isAsked() {
    return this.#calls.size > 0;
  }

  /**
   * Calls the worker. Once it has ended, calls are refused.
   * @param options.signal cancels the call
   * @param options.onPart gets the parts of its answer
   */
  call(name, args = {}, { signal, onPart = () => {} } = {}) {
    if (this.#end) return Promise.reject(this.#end);
    if (signal?.aborted) return Promise.reject(signal.reason);
    const call = ++this.#count;
    return new Promise((resolve, reject) => {
      const cancel = () => {
        this.#worker.postMessage({ cancel: call });
        this.#calls.get(call)?.reject(signal.reason);
      };
      const done = (settle) => (value) => {
        this.#calls.delete(call);
        signal?.removeEventListener("abort", cancel);
        settle(value);
      };
      this.#calls.set(call, { resolve: done(resolve), reject: done(reject), onPart });
      signal?.addEventListener("abort", cancel);
      this.#worker.postMessage({ call, name, args });
    });
  }

  /** Ends the worker. Calls that wait are cancelled. */
  end() {
    this.#stop(new Error(sentence("ended")), new DOMException("the corpus was closed", "AbortError"));
  }

  /** Ends the worker, which answers no more for a reason. Calls that wait get that, or another. */
  #stop(reason, forWaiting = reason) {
    this.#end ??= reason;
    this.#worker.terminate();
    for (const { reject } of [...this.#calls.values()]) reject(forWaiting);
  }
}

function asError({ word, values, text, isCancelled }) {
  if (isCancelled) return new DOMException("cancelled", "AbortError");
  if (word) return new Error(sentence(word, values));
  // The WebAssembly gives reasons, which become sentences here.
  return new Error(`${text.charAt(0).toUpperCase()}${text.slice(1)}${/[.!?]$/.test(text) ? "" : "."}`);
}
