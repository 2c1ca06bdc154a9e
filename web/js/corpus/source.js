// Where a corpus is read from: an address, or a folder of this computer. Both give whole files and
// ranges of files. What goes wrong is thrown as a `SourceError`: a key of words.js, and its values.

/** The time without any data after which a request is stopped, milliseconds. */
const TIMEOUT_MS = 20_000;
/** The number of requests at once. */
const MAX_AT_ONCE = 6;
/** The size up to which a file is read whole from a host that does not serve ranges, bytes. */
const MAX_WHOLE_BYTES = 8 << 20;

export class SourceError extends Error {
  /** @param word a key of the texts in words.js */
  constructor(word, values = {}) {
    super(word);
    Object.assign(this, { word, values });
  }
}

/** A corpus at an address. */
export class WebSource {
  #manifest;
  /** Whole files of a host that does not serve ranges, by their names. */
  #whole = new Map();
  #running = 0;
  #waiting = [];

  /** @param address that of corpus.json */
  constructor(address) {
    this.#manifest = new URL(address);
  }

  /** Reads a file. */
  whole(name, signal) {
    return this.#inTurn(signal, async () => (await this.#request(name, undefined, signal)).bytes);
  }

  /** Reads a part of a file. */
  range(name, offset, length, signal) {
    if (length === 0) return Promise.resolve(new Uint8Array());
    const kept = this.#whole.get(name);
    if (kept) return kept.then((bytes) => part(bytes, name, offset, length));
    return this.#inTurn(signal, async () => {
      const { isWhole, bytes } = await this.#request(name, [offset, length], signal);
      if (!isWhole) return part(bytes, name, 0, length);
      this.#whole.set(name, Promise.resolve(bytes));
      return part(bytes, name, offset, length);
    });
  }

  /** Runs a task when fewer than the most others run. One that is stopped before that does not begin. */
  async #inTurn(signal, task) {
    if (this.#running >= MAX_AT_ONCE) await new Promise((resolve) => this.#waiting.push(resolve));
    else this.#running++;
    try {
      signal?.throwIfAborted();
      return await task();
    } finally {
      const next = this.#waiting.shift();
      if (next) next();
      else this.#running--;
    }
  }

  async #request(name, range, signal) {
    const address = new URL(name, this.#manifest);
    address.search = this.#manifest.search;
    const facts = { host: address.host, file: name, seconds: TIMEOUT_MS / 1000 };
    const controller = new AbortController();
    const stop = () => controller.abort();
    signal?.addEventListener("abort", stop);
    let [timer, isLate] = [undefined, false];
    const restart = () => {
      clearTimeout(timer);
      timer = setTimeout(() => {
        isLate = true;
        stop();
      }, TIMEOUT_MS);
    };
    restart();
    try {
      const headers = range ? { Range: `bytes=${range[0]}-${range[0] + range[1] - 1}` } : {};
      // The browser's cache would answer one request of a range after the other, and could have whole
      // files of a corpus that has been written again since.
      const cache = range ? "no-store" : "no-cache";
      const response = await fetch(address, { credentials: "omit", cache, headers, signal: controller.signal });
      restart();
      const isWhole = range !== undefined && response.status === 200;
      if (response.status === 416) throw new SourceError("shortFile", facts);
      if (!response.ok) throw statusError(response.status, facts);
      if (/^text\/html/.test(response.headers.get("content-type") ?? "")) throw new SourceError("webPage", facts);
      const most = isWhole ? MAX_WHOLE_BYTES : Infinity;
      if (Number(response.headers.get("content-length")) > most) throw new SourceError("noRanges", facts);
      const bytes = await body(response, restart, most);
      if (!bytes) throw new SourceError("noRanges", facts);
      return { isWhole, bytes };
    } catch (reason) {
      signal?.throwIfAborted();
      if (reason instanceof SourceError) throw reason;
      if (isLate) throw new SourceError("late", facts);
      throw await refusal(address, facts);
    } finally {
      clearTimeout(timer);
      signal?.removeEventListener("abort", stop);
      // Ends the transfer of an answer that is not read to its end.
      stop();
    }
  }
}

/** A corpus in a folder of this computer. */
export class FolderSource {
  #files;

  /** @param files its files by their paths in it */
  constructor(files) {
    this.#files = files;
  }

  async whole(name) {
    return this.#read(name, this.#file(name));
  }

  async range(name, offset, length) {
    const bytes = await this.#read(name, this.#file(name).slice(offset, offset + length));
    return part(bytes, name, 0, length);
  }

  #file(name) {
    const file = this.#files.get(name);
    if (!file) throw new SourceError("noFile", { file: name });
    return file;
  }

  async #read(name, blob) {
    try {
      return new Uint8Array(await blob.arrayBuffer());
    } catch {
      throw new SourceError("changedFile", { file: name });
    }
  }
}

/** Returns a part of some bytes. */
function part(bytes, name, offset, length) {
  if (bytes.length < offset + length) throw new SourceError("shortFile", { file: name });
  return bytes.subarray(offset, offset + length);
}

/** Reads an answer; null if it has more than `most` bytes. */
async function body(response, onProgress, most) {
  if (!response.body) return new Uint8Array();
  const reader = response.body.getReader();
  const pieces = [];
  let size = 0;
  for (;;) {
    const { done, value } = await reader.read();
    onProgress();
    if (done) break;
    size += value.length;
    if (size > most) return null;
    pieces.push(value);
  }
  if (pieces.length === 1) return pieces[0];
  const bytes = new Uint8Array(size);
  let at = 0;
  for (const piece of pieces) {
    bytes.set(piece, at);
    at += piece.length;
  }
  return bytes;
}

function statusError(status, facts) {
  if (status === 404 || status === 410) return new SourceError("notThere", { ...facts, status });
  if (status === 401 || status === 403) return new SourceError("notAllowed", { ...facts, status });
  return new SourceError("wrongStatus", { ...facts, status });
}

/**
 * Returns the reason for a request that the browser refused without one. A second request, whose
 * answer cannot be read, tells a host that refuses other pages (CORS) from one that is not there.
 */
async function refusal(address, facts) {
  if (!navigator.onLine) return new SourceError("offline", facts);
  if (address.protocol === "http:" && self.location.protocol === "https:") return new SourceError("insecure", facts);
  const controller = new AbortController();
  const timer = setTimeout(() => controller.abort(), TIMEOUT_MS);
  const isThere = await fetch(address, { mode: "no-cors", credentials: "omit", signal: controller.signal }).then(() => true, () => false);
  clearTimeout(timer);
  controller.abort();
  return new SourceError(isThere ? "cors" : "unreachable", facts);
}
