// Tests of the workers that compute: their results are those of a page without them, and a worker
// that ends is replaced.

import assert from "node:assert/strict";
import { onOneBackend } from "./harness.mjs";
import { striding, until } from "./help.mjs";

const SMALL = { viewport: [800, 600] };
const GRAPH = "lab=graph&walk_seconds=10&play=off";

/** Waits until nothing is computed, and returns what the page shows. */
async function result({ segue }) {
  await segue("set", {});
  const times = [0, 2.5, 7.1];
  const poses = [];
  for (const time of times) poses.push(await segue("pose", "result", time));
  return { metrics: await segue("metrics"), poses };
}

const workers = async ({ segue }) => (await segue("stats")).workers;

// Fails when no job goes to a worker, when its result differs in a bit, and when `pool=` becomes a
// part of the link.
onOneBackend("results of workers are those of a page without them", async ({ open }) => {
  const [alone, shared] = [await open(`${GRAPH}&pool=off`, SMALL), await open(`${GRAPH}&pool=2`, SMALL)];
  assert.deepEqual(await result(shared), await result(alone));
  const first = await workers(shared);
  assert.ok(first.jobs >= 3 && first.running === 2 && first.replaced === 0, JSON.stringify(first));
  for (const values of [{ blend_window: 21 }, { edge_threshold: 19.5 }]) {
    for (const page of [alone, shared]) await page.segue("set", values);
    assert.deepEqual(await result(shared), await result(alone), JSON.stringify(values));
  }
  assert.ok((await workers(shared)).jobs > first.jobs);
  assert.deepEqual(await workers(alone), { running: 0, jobs: 0, replaced: 0 });
  assert.ok(!(await shared.segue("url")).includes("pool"), "it is no part of the link");

  // Registrations, of clips that came from files.
  for (const { segue, load } of [alone, shared]) {
    const [a, b] = [await load("a.bvh", striding({ frames: 900, hertz: 0.9 })), await load("b.bvh", striding({ frames: 800, hertz: 1.1, swing: 40 }))];
    await segue("set", { lab: "register", a: a.clips[0].id, b: b.clips[0].id });
  }
  const before = (await workers(shared)).jobs;
  assert.deepEqual(await result(shared), await result(alone));
  for (const page of [alone, shared]) await page.segue("set", { registration_window: 11, slope_limit: 3 });
  assert.deepEqual(await result(shared), await result(alone));
  assert.ok((await workers(shared)).jobs > before - 1);
});

// Fails when workers do not get the buffers of their answers again, and when a distance is one of an
// earlier answer: clips of different lengths have tiles of different sizes.
onOneBackend("buffers of answers are used again, and answers stay those of a page without workers", async ({ open }) => {
  const countReturned = (page) => page.addInitScript(() => {
    window.returnedBuffers = 0;
    const { postMessage } = Worker.prototype;
    Worker.prototype.postMessage = function (message, ...more) {
      window.returnedBuffers += message?.spares?.length ?? 0;
      return postMessage.call(this, message, ...more);
    };
  });
  const link = "lab=view&play=off&walk_seconds=10";
  const [alone, shared] = [await open(`${link}&pool=off`, SMALL), await open(`${link}&pool=2`, { ...SMALL, prepare: countReturned })];
  for (const { segue, load } of [alone, shared]) {
    const clips = [];
    for (const [index, frames] of [1100, 420, 700].entries()) clips.push((await load(`${index}.bvh`, striding({ frames, hertz: 0.8 + 0.1 * index, swing: 25 + 3 * index }))).clips[0].id);
    await segue("set", { lab: "graph", clips: clips.join(",") });
  }
  assert.deepEqual(await result(shared), await result(alone));
  for (const blend_window of [24, 19, 35]) {
    for (const page of [alone, shared]) await page.segue("set", { blend_window });
    assert.deepEqual(await result(shared), await result(alone), `a window of ${blend_window}`);
  }
  const returned = await shared.page.evaluate(() => window.returnedBuffers);
  assert.ok(returned >= 6, `${returned} buffers`);
});

// Fails when no clip of a database goes to a worker, and when its measurement differs in a bit.
onOneBackend("database of workers is that of a page without them", async ({ open }) => {
  const link = "lab=match&scenario=spin&play=off";
  const [alone, shared] = [await open(`${link}&pool=off`, SMALL), await open(`${link}&pool=2`, SMALL)];
  assert.deepEqual(await result(shared), await result(alone));
  const first = await workers(shared);
  assert.ok(first.jobs >= 30 && first.running === 2 && first.replaced === 0, JSON.stringify(first));
  assert.deepEqual(await workers(alone), { running: 0, jobs: 0, replaced: 0 });

  // Clips that came from files, at several rates.
  for (const { segue, load } of [alone, shared]) {
    const clips = [];
    for (let i = 0; i < 3; i++) clips.push((await load(`${i}.bvh`, striding({ frames: 2500, hertz: 0.8 + 0.1 * i, swing: 25 + 3 * i, fps: 30 * (i + 1) }))).clips[0].id);
    await segue("set", { match_clips: clips.join(",") });
  }
  assert.deepEqual(await result(shared), await result(alone));
  const second = await workers(shared);
  assert.equal(second.jobs, first.jobs + 3);
  // Other trajectory times need no worker, a database without mirror images does.
  for (const values of [{ ahead_far: 0.9 }, { mirrored: false }]) {
    for (const page of [alone, shared]) await page.segue("set", values);
    assert.deepEqual(await result(shared), await result(alone), JSON.stringify(values));
  }
  assert.equal((await workers(shared)).jobs, second.jobs + 3);
});

// Fails when the work for a long clip stays on the page, when one of the pieces in which the clip
// travels is lost, and when a result differs in a bit.
onOneBackend("work for a long clip is done by workers as by a page without them", async ({ open }) => {
  const link = "lab=view&play=off";
  const [alone, shared] = [await open(`${link}&pool=off`, SMALL), await open(`${link}&pool=2`, SMALL)];
  const bytes = striding({ frames: 9000, swing: 33 });
  let long;
  for (const { segue, load } of [alone, shared]) {
    long = (await load("long.bvh", bytes)).clips[0].id;
    await segue("set", { a: long, b: long });
  }
  // Its measurement; its foot lock; its feet, read anew, and their lock; the search for a cycle,
  // and for faults; a layer of it over itself, and another.
  const steps = [[{}, 1], [{ foot_lock: true }, 2], [{ contact_height: 3 }, 4], [{ lab: "loop" }, 5], [{ lab: "clean" }, 6], [{ lab: "layers" }, 7], [{ layer_weight: 0.4 }, 8]];
  for (const [values, jobs] of steps) {
    for (const page of [alone, shared]) await page.segue("set", values);
    assert.deepEqual(await result(shared), await result(alone), JSON.stringify(values));
    assert.equal((await workers(shared)).jobs, jobs, JSON.stringify(values));
  }
});

// Fails when the jobs of a worker that ended are lost.
onOneBackend("jobs of a worker that ends are done by another", async ({ open }) => {
  const alone = await open(`${GRAPH}&pool=off`, SMALL);
  const shared = await open("lab=view&play=off&pool=2", { ...SMALL, prepare: watchWorkers });
  await shared.page.evaluate((values) => {
    // The first job ends its worker.
    window.endNext = true;
    return window.segue.set(values);
  }, { lab: "graph", walk_seconds: 10 });
  assert.deepEqual(await result(shared), await result(alone));
  const { replaced, jobs } = await workers(shared);
  assert.ok(replaced === 1 && jobs >= 3, `${replaced} replaced, ${jobs} jobs`);
});

// Fails when the page waits for workers that do not come.
onOneBackend("page whose workers do not start computes by itself", async ({ open }) => {
  const alone = await open(`${GRAPH}&pool=off`, SMALL);
  const prepare = (page) => page.route("**/compute_bg.wasm", (route) => route.abort());
  const shared = await open(`${GRAPH}&pool=2`, { ...SMALL, prepare });
  assert.deepEqual(await result(shared), await result(alone));
  assert.deepEqual(await workers(shared), { running: 0, jobs: 0, replaced: 0 });
});

// Fails when workers go on with what nobody looks at.
onOneBackend("work for what was left is cancelled", async ({ open }) => {
  const shared = await open("lab=view&play=off&pool=1", SMALL);
  const clips = [];
  for (let i = 0; i < 3; i++) clips.push((await shared.load(`${i}.bvh`, striding({ frames: 1500, hertz: 0.8 + 0.1 * i }))).clips[0].id);
  await shared.page.evaluate((clips) => { window.segue.set({ lab: "graph", clips, blend_window: 40 }); }, clips.join(","));
  await until("a job has been done", async () => (await workers(shared)).jobs > 0);
  await shared.segue("set", { lab: "view" });
  const left = (await workers(shared)).jobs;
  assert.deepEqual((await shared.segue("stats")).jobs, []);
  await shared.page.waitForTimeout(1500);
  // Those that the worker had already are answered.
  assert.ok((await workers(shared)).jobs <= left + 2);
});

/** Makes the page end the worker of the next job when `endNext` is set. */
function watchWorkers(page) {
  return page.addInitScript(() => {
    window.Worker = class extends Worker {
      postMessage(message, ...rest) {
        super.postMessage(message, ...rest);
        if (window.endNext && message.job !== undefined) {
          window.endNext = false;
          this.terminate();
          setTimeout(() => this.dispatchEvent(new ErrorEvent("error", { message: "ended by the test" })));
        }
      }
    };
  });
}
