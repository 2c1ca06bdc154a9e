// A worker that computes for the page, with a WebAssembly of its own (src/bin/compute.rs), one of
// several. src/platform/web/pool.rs gives it jobs.
//
// The page posts { module, maxBytes }, the compiled WebAssembly, or { failed }, to which the worker
// answers with { ready } or { unusable: reason }. Before and after that come clips, { clip, head, floats, bytes }, clips to drop, { drop }, and jobs, { job, message }. To each
// job the worker answers with { job, secs, head, floats, bytes } or { job, failed: reason, trapped }.
// After a trap it is not used any more.

import init, { Computer } from "./compute/compute.js";

let begin;
/** The worker's program. Whatever comes before the WebAssembly waits for it. */
const computer = new Promise((resolve) => { begin = resolve; });

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
    // All messages wait for the same promise, so that they are handled one after the other.
    const worker = await computer;
    if (clip !== undefined) worker.takeClip(clip, data.head, data.floats, data.bytes);
    if (drop !== undefined) worker.dropClip(drop);
    if (job === undefined) return;
    const start = performance.now();
    const [head, floats, bytes] = worker.run(data.message);
    const secs = (performance.now() - start) / 1e3;
    self.postMessage({ job, secs, head, floats, bytes }, [floats.buffer, bytes.buffer]);
  } catch (reason) {
    const trapped = reason instanceof WebAssembly.RuntimeError;
    // A clip that cannot be taken is missed by the jobs that need it.
    if (job !== undefined || trapped) self.postMessage({ job, failed: String(reason?.message ?? reason), trapped });
  }
};
