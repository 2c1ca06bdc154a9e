// A worker that reads motion files, with a WebAssembly of its own (src/bin/reader.rs), and converts
// and writes them with another one (src/bin/converter.rs). src/platform/web/reader.rs gives it tasks.
//
// Tasks are { task, name, setup, convert, isPacked, file, stored, returnsBytes }: a Blob, or the place
// of the bytes in the storage, or both; `convert` has the options of a file that is converted, and
// `isPacked` says that the bytes are those of a packed motion, in an ArrayBuffer. For each the worker answers with
// messages { task, progress }, { task, head }, { task, piece } …, { task, end: true, bytes }, or
// { task, failed: reason }, { task, refused: message }, or { task, lost: true } when there is no such
// file any more.

import init, { readFile } from "./read/reader.js";

/** The least time between two messages of progress, ms. Each makes the page draw a frame, and software drawing slows the reading. */
const PROGRESS_MS = 250;

const reader = init();
reader.catch(() => {}); // each task reports a failure
/** The program that converts files, from the first of them on: a promise. */
let starting;

/** The memory from which on a trap is taken for a failed allocation, bytes. */
const MIN_EXHAUSTED_BYTES = 1 << 30;

self.onmessage = async ({ data: { task, name, setup, convert, isPacked, file, stored, returnsBytes } }) => {
  const post = (message, transfer = []) => self.postMessage({ task, ...message }, transfer);
  let memory;
  try {
    const converter = (convert || isPacked) && await (starting ??= startConverter());
    ({ memory } = converter || await reader);
    const buffer = await bytesOf(file, stored);
    if (!buffer) return post({ lost: true });
    if (isPacked) {
      const made = converter.writePacked(new Uint8Array(buffer));
      return typeof made === "string" ? post({ refused: made }) : post({ end: true, bytes: made }, [made.buffer]);
    }
    const sha256 = await digest(buffer);
    const bytes = new Uint8Array(buffer);
    let told = performance.now();
    const receiver = {
      progress: (done) => {
        if (performance.now() - told < PROGRESS_MS) return;
        told = performance.now();
        post({ progress: done });
      },
      head: (head) => post({ head }),
      piece: (piece) => post({ piece }, [piece.buffer]),
    };
    if (converter) converter.convertFile(receiver, name, bytes, setup, convert, sha256);
    else readFile(receiver, name, bytes, setup, sha256);
    if (returnsBytes) post({ end: true, bytes }, [buffer]);
    else post({ end: true });
  } catch (reason) {
    const trapped = reason instanceof WebAssembly.RuntimeError;
    const noMemory = trapped && memory?.buffer.byteLength >= MIN_EXHAUSTED_BYTES;
    post({ failed: noMemory ? "there is no memory to read it" : String(reason?.message ?? reason) });
  }
};

async function startConverter() {
  try {
    const { default: init, convertFile, writePacked } = await import("./convert/converter.js");
    const { memory } = await init();
    return { convertFile, writePacked, memory };
  } catch {
    throw new Error("the program that converts files cannot be fetched: check the network and try again");
  }
}

/** Returns the bytes of a file, from the storage where the file cannot be read; null where there are none. */
async function bytesOf(file, stored) {
  try {
    if (file instanceof ArrayBuffer) return file;
    if (file) return await file.arrayBuffer();
  } catch (reason) {
    if (!stored) throw reason;
  }
  const value = stored && (await storedValue(stored).catch(() => undefined));
  if (!value) return null;
  if (value instanceof Blob) return value.arrayBuffer();
  // The array may be a part of its buffer.
  return value.byteLength === value.buffer.byteLength ? value.buffer : value.slice().buffer;
}

/** Returns what the storage has under a key. */
async function storedValue({ database, store, key }) {
  const answer = (request) => new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
  const opening = indexedDB.open(database);
  // A storage that is not there must not be made.
  opening.onupgradeneeded = () => opening.transaction.abort();
  const opened = await answer(opening);
  try {
    return await answer(opened.transaction(store).objectStore(store).get(key));
  } finally {
    opened.close();
  }
}

/**
 * Returns the browser's SHA-256, which is several times as fast as the app's; undefined on an
 * insecure address.
 */
async function digest(buffer) {
  if (!self.crypto?.subtle) return undefined;
  const sum = new Uint8Array(await crypto.subtle.digest("SHA-256", buffer));
  return Array.from(sum, (byte) => byte.toString(16).padStart(2, "0")).join("");
}
