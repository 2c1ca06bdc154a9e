// A worker that reads motion files, with a WebAssembly of its own (src/bin/reader.rs).
// src/platform/web/reader.rs gives it tasks.
//
// Tasks are { task, name, setup, file }. For each the worker answers with messages { task, progress
// }, { task, head }, { task, piece } …, { task, end: true }, or { task, failed: reason }.

import init, { readFile } from "./read/reader.js";

const started = init();
started.catch(() => {}); // each task reports a failure

/** The memory from which on a trap is taken for a failed allocation, bytes. */
const MIN_EXHAUSTED_BYTES = 1 << 30;

self.onmessage = async ({ data: { task, name, setup, file } }) => {
  const post = (message, transfer = []) => self.postMessage({ task, ...message }, transfer);
  try {
    await started;
    const buffer = await file.arrayBuffer();
    const sha256 = await digest(buffer);
    const bytes = new Uint8Array(buffer);
    const progress = (done) => post({ progress: done });
    readFile(name, bytes, setup, sha256, progress, (head) => post({ head }), (piece) => post({ piece }, [piece.buffer]));
    post({ end: true });
  } catch (reason) {
    const trapped = reason instanceof WebAssembly.RuntimeError;
    const noMemory = trapped && (await started).memory.buffer.byteLength >= MIN_EXHAUSTED_BYTES;
    post({ failed: noMemory ? "there is no memory to read it" : String(reason?.message ?? reason) });
  }
};

/**
 * Returns the browser's SHA-256, which is several times as fast as the app's; undefined on an
 * insecure address.
 */
async function digest(buffer) {
  if (!self.crypto?.subtle) return undefined;
  const sum = new Uint8Array(await crypto.subtle.digest("SHA-256", buffer));
  return Array.from(sum, (byte) => byte.toString(16).padStart(2, "0")).join("");
}
