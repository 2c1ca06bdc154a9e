// Tests of large files, which a worker reads while the page goes on.

import assert from "node:assert/strict";
import { onOneBackend } from "./harness.mjs";
import { apart, striding, until } from "./help.mjs";

const SMALL = { viewport: [960, 640] };
/** A size well above that of the largest file that is read at once. */
const LARGE = striding({ frames: 12_000 });

// Fails when the file is read between two frames, when answers of the worker are incomplete, and
// when no progress is reported.
onOneBackend("large file is read while the page goes on", async ({ open }) => {
  const { page, segue, dropFile, load } = await open("lab=view&play=off", SMALL);
  await page.evaluate(() => {
    window.progress = [];
    window.segue.on("progress", (job) => window.progress.push(job));
  });
  await dropFile("long.bvh", LARGE);
  const [clip] = await until("it is in the library", async () => {
    const clips = (await segue("clips")).filter((clip) => clip.sha256);
    return clips.length && clips;
  });
  assert.deepEqual([clip.name, clip.joints, clip.frames], ["long", 31, 12_000]);
  assert.equal((await segue("params")).a, clip.id);
  const reported = await page.evaluate(() => window.progress.filter(({ name }) => name === "long.bvh").map(({ progress }) => progress));
  assert.ok(reported.length > 0 && reported.every((progress) => progress >= 0 && progress <= 1), `progress: ${reported}`);
  // The same motion as a short file that is read at once.
  const short = (await load("short.bvh", striding({ frames: 200 }))).clips[0];
  for (const time of [0, 1.5]) assert.ok(apart(await segue("pose", clip.id, time), await segue("pose", short.id, time)) < 1e-6);

  // The API returns the result.
  await assert.rejects(load("torn.bvh", LARGE.subarray(0, LARGE.length / 2).toString().replace("MOTION", "NOTION")), /torn\.bvh:\d+:\d+: found .+, expected /);
});

onOneBackend("reading of a large file can be stopped", async ({ open }) => {
  const { page, segue } = await open("lab=view&play=off", SMALL);
  await segue("set", {});
  const before = await segue("clips");
  const [stopped, next] = await page.evaluate(async (text) => {
    const bytes = new TextEncoder().encode(text);
    const long = window.segue.load("long.bvh", bytes).then(() => "read", (error) => error.message);
    const next = window.segue.load("next.bvh", bytes.slice());
    while (!window.segue.stats().jobs.some(({ name }) => name === "long.bvh")) await new Promise((resolve) => setTimeout(resolve, 1));
    window.segue.stop("long.bvh");
    return [await long, (await next).clips[0].name];
  }, LARGE.toString());
  assert.match(stopped, /long\.bvh: .*stopped/);
  assert.equal(next, "next", "the one behind it is read");
  assert.equal((await segue("clips")).length, before.length + 1);
});

onOneBackend("large file is restored after a reload", async ({ open }) => {
  const { page, segue, load, ready } = await open("", SMALL);
  const { clips } = await load("long.bvh", LARGE);
  await segue("set", { lab: "view", compare: "", a: clips[0].id, play: false });
  const pose = await segue("pose", clips[0].id, 3);
  await until("the work is stored", () => page.evaluate(async () => {
    const database = await new Promise((resolve, reject) => Object.assign(indexedDB.open("segue"), { onsuccess: (event) => resolve(event.target.result), onerror: reject }));
    const files = await new Promise((resolve) => { database.transaction("files").objectStore("files").getAll().onsuccess = (event) => resolve(event.target.result); });
    database.close();
    return files.length === 1 && files[0] instanceof Blob;
  }));
  await page.goto(new URL(page.url()).origin, { waitUntil: "commit" });
  await ready();
  const again = await until("it was read again", () => segue("pose", clips[0].id, 3).catch(() => undefined));
  assert.ok(apart(again, pose) < 1e-6);
});
