// A worker that computes for the page, with a WebAssembly of its own (src/bin/compute.rs), one of
// several. src/platform/web/pool.rs gives it jobs.
//
// The page posts { module, maxBytes }, the compiled WebAssembly, or { failed }, to which the worker
// answers with { ready } or { unusable: reason }. Before and after that come clips, each as { clip,
// head, bytes, length }, the number of its floats, and these in pieces in their order, { clip, at,
// piece }; clips to drop, { drop }; and jobs, { job, message, spares }, with buffers of earlier
// answers. To each job the worker answers with its long arrays in pieces in their order, { job,
// array, length, piece }, the first array its floats, the others rotations; then with { job, secs,
// head, bytes }; or with { job, failed: reason, trapped }. After a trap it is not used any more.

import init, { Computer } from "./compute/compute.js";

let begin;
/** The worker's program. Whatever comes before the WebAssembly waits for it. */
const computer = new Promise((resolve) => { begin = resolve; });

/** Buffers of earlier answers, which the page has given back. */
const spares = [];

/** The clips of which only a part has come, by their numbers. */
const begun = new Map();

/** Takes in a part of a clip. Returns the clip once it is whole. */
function arrived({ clip, head, bytes, length, at, piece }) {
  if (piece) begun.get(clip)?.floats.set(piece, at);
  else begun.set(clip, { head, bytes, floats: new Float32Array(length) });
  const found = begun.get(clip);
  const isWhole = found && (piece ? at + piece.length : 0) === found.floats.length;
  if (isWhole) begun.delete(clip);
  return isWhole ? found : undefined;
}

self.onmessage = async ({ data }) => {
  const { clip, drop, job } = data;
  if (data.module || data.failed) {
    begin(data.module
      ? init({ module_or_path: data.module }).then(() => new Computer(data.maxBytes))
      : Promise.reject(new Error(data.failed)));
    computer.then(
      () => self.postMessage({ ready: true }),
      (reason) => self.postMessage({ unusable: String(reason?.message ?? reason) }),
    );
    return;
  }
  try {
    const whole = clip === undefined ? undefined : arrived(data);
    if (drop !== undefined) begun.delete(drop);
    // All messages wait for the same promise, so that they are handled one after the other.
    const worker = await computer;
    if (whole) worker.takeClip(clip, whole.head, whole.floats, whole.bytes);
    if (drop !== undefined) worker.dropClip(drop);
    if (job === undefined) return;
    const start = performance.now();
    spares.push(...data.spares);
    const [head, bytes, arrays] = worker.run(data.message, spares);
    const secs = (performance.now() - start) / 1e3;
    for (const [array, pieces] of arrays.entries()) {
      const length = pieces.reduce((sum, piece) => sum + piece.length, 0);
      for (const piece of pieces) self.postMessage({ job, array, length, piece }, [piece.buffer]);
    }
    self.postMessage({ job, secs, head, bytes }, [bytes.buffer]);
  } catch (reason) {
    const trapped = reason instanceof WebAssembly.RuntimeError;
    // A clip that cannot be taken is missed by the jobs that need it.
    if (job !== undefined || trapped) self.postMessage({ job, failed: String(reason?.message ?? reason), trapped });
  }
};
