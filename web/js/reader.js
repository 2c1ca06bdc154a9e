// A worker that reads motion files, with a WebAssembly of its own (src/bin/reader.rs). src/platform/web/reader.rs gives it tasks.
//
// Tasks are { task, name, setup, file }. For each the worker answers with messages { task, progress }, { task, head },
// { task, piece } …, { task, end: true }, or { task, failed: reason }.

import init, { readFile } from "./read/reader.js";

const started = init();
started.catch(() => {}); // each task tells of it

/** A trap, while so much memory is held, comes from an allocation that failed. */
const MUCH_MEMORY = 1 << 30;

self.onmessage = async ({ data: { task, name, setup, file } }) => {
  const tell = (news, transfer = []) => self.postMessage({ task, ...news }, transfer);
  try {
    await started;
    const buffer = await file.arrayBuffer();
    const sha256 = await digest(buffer);
    const bytes = new Uint8Array(buffer);
    const progress = (done) => tell({ progress: done });
    readFile(name, bytes, setup, sha256, progress, (head) => tell({ head }), (piece) => tell({ piece }, [piece.buffer]));
    tell({ end: true });
  } catch (reason) {
    const trapped = reason instanceof WebAssembly.RuntimeError;
    const noMemory = trapped && (await started).memory.buffer.byteLength >= MUCH_MEMORY;
    tell({ failed: noMemory ? "there is no memory to read it" : String(reason?.message ?? reason) });
  }
};

/** The browser's own digest is several times as fast; it has none on an insecure address. */
async function digest(buffer) {
  if (!self.crypto?.subtle) return undefined;
  const sum = new Uint8Array(await crypto.subtle.digest("SHA-256", buffer));
  return Array.from(sum, (byte) => byte.toString(16).padStart(2, "0")).join("");
}
