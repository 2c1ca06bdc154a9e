// Tests of the calls of `window.segueReady`, one by one.

import assert from "node:assert/strict";
import { onBothBackends, onOneBackend } from "./harness.mjs";
import { STRIP, apart, count, isClay, timelineOf, until } from "./help.mjs";

const SMALL = { viewport: [960, 640] };

// Fails when a refused value or one beside it is set, and when the message does not name it.
onOneBackend("set with a wrong value names it and changes nothing", async ({ open }) => {
  const { page, segue } = await open("lab=blend&play=off", SMALL);
  const [params, url] = [await segue("params"), await segue("url")];
  for (const [values, reason] of [
    [{ blend_window: 12, colour: "red" }, /`colour`/],
    [{ align: false, blend_window: 0 }, /blend_window: found 0, expected 1 to 240 frames/],
    [{ align: false, blend_window: 241 }, /blend_window: found 241, expected 1 to 240 frames/],
    [{ blend_window: "many" }, /blend_window: found `many`, expected a number of frames/],
    [{ align: false, weight_law: "steep" }, /weight_law: found `steep`, expected smooth, linear, smoother/],
    [{ align: false, a: "nobody" }, /a: .*`nobody`/],
    [{ align: false, compare: "lab:1,2" }, /compare: found `lab:1,2`/],
    ["blend_window", /an object of keys and values/],
  ]) {
    await assert.rejects(segue("set", values), reason, JSON.stringify(values));
    assert.deepEqual(await segue("params"), params, JSON.stringify(values));
  }
  assert.equal(await segue("url"), url);
  // Values that JSON cannot represent.
  await assert.rejects(page.evaluate(() => window.segue.set({ blend_window: NaN })), /blend_window/);
  await assert.rejects(segue("pose", "nobody", 0), /found `nobody`/);
  await assert.rejects(segue("export", "result", "doc"), /found `doc`/);
  await assert.rejects(segue("seek", "soon"), /seek/);
});

onOneBackend("keys has every parameter, and set calls the listeners", async ({ open, backend }) => {
  const { page, segue } = await open("lab=blend&play=off", SMALL);
  assert.match(await segue("version"), /^\d+\.\d+\.\d+/);
  const [keys, params, stats] = [await segue("keys"), await segue("params"), await segue("stats")];
  assert.deepEqual(keys.map(({ key }) => key).toSorted(), Object.keys(params).toSorted());
  for (const { key, type, min, max, step, choices, label, help } of keys) {
    assert.ok(label && help, key);
    if (type === "integer" || type === "number") assert.ok(min < max && step > 0, key);
    if (type === "choice") assert.ok(choices.includes(params[key]), key);
  }
  assert.equal(stats.backend, backend);
  assert.ok(stats.frames > 0 && stats.wasm_bytes > 1e6 && stats.frame_ms.p50 <= stats.frame_ms.max);

  const before = await segue("pose", "result", 2.4);
  const reported = await page.evaluate(async () => {
    const reported = [];
    const stop = window.segue.on("change", ({ query }) => reported.push(query));
    await window.segue.set({ blend_window: 90 });
    await new Promise((resolve) => setTimeout(resolve));
    stop();
    return reported;
  });
  assert.ok(reported.some((query) => query.includes("blend_window=90")), String(reported));
  assert.ok(apart(await segue("pose", "result", 2.4), before) > 1e-3, "set resolves when the result is computed");
});

onOneBackend("play, pause, seek and time", async ({ open }) => {
  const { segue } = await open("lab=blend&play=off", SMALL);
  await segue("seek", 1.25);
  assert.ok(Math.abs((await segue("time")) - 1.25) < 1e-3);
  await segue("play");
  assert.equal((await segue("params")).play, true);
  await until("time runs", async () => (await segue("time")) > 1.3);
  await segue("pause");
  const stopped = await segue("time");
  const { frames } = await segue("stats");
  await until("frames are drawn", async () => { await segue("set", { ghosts: 0 }); return (await segue("stats")).frames >= frames; });
  assert.equal(await segue("time"), stopped);
  assert.equal((await segue("params")).play, false);
});

// Fails when the picture is empty, as a canvas is that is read outside of its frame.
onBothBackends("a snapshot is a picture of the stage", async ({ open }) => {
  const { page, segue, snapshot } = await open("lab=blend&play=off&follow=off", { scale: 1, ...SMALL });
  await segue("set", {});
  const picture = await snapshot();
  assert.equal(picture.height, 640 - 48 - timelineOf(640) - STRIP, "between bar and numbers");
  assert.ok(picture.width > 400 && picture.width < 960 - 200 - 288, `${picture.width} points wide: between the panels`);
  assert.ok(count(picture, [0, 40, picture.width, picture.height - 60], isClay) > 2000, "the character is in it");

  // In software, a picture in motion has fewer triangles and pixels: not one that is taken.
  await segue("set", { t: 1 });
  const atOnce = await snapshot();
  await page.waitForTimeout(1000);
  assert.ok(Buffer.compare(atOnce.data, (await snapshot()).data) === 0, "a picture at once is as fine as one at rest");
});

onOneBackend("exported file can be loaded", async ({ open }) => {
  const { segue, load } = await open("lab=blend&play=off", SMALL);
  await segue("set", {});
  const bytes = await segue("export", "result", "bvh");
  const { clips: [clip], warnings } = await load("back.bvh", bytes);
  assert.deepEqual(warnings, []);
  const joints = (await segue("pose", "result", 0)).joints.length;
  assert.equal(clip.joints, joints);
  await segue("set", { lab: "view", a: clip.id });
  const exported = await load("again.bvh", await segue("export", clip.id, "bvh"));
  assert.deepEqual([exported.clips[0].frames, exported.clips[0].joints], [clip.frames, joints]);
  for (const t of [0, 0.7, 2.4]) assert.ok(apart(await segue("pose", clip.id, t), await segue("pose", exported.clips[0].id, t)) < 1e-4, `at ${t} s`);
});

// Fails when a call returns an earlier result for clips that it was not made from.
onOneBackend("every call on a refused result rejects with its sentence", async ({ open }) => {
  const { segue } = await open("lab=path&a=walk&play=off", SMALL);
  await until("it is measured", async () => Object.keys(await segue("metrics")).length > 0);
  const clips = (await segue("clips")).length;
  await segue("set", { a: "idle" });
  for (const call of [["pose", "result", 0], ["metrics"], ["export", "result", "bvh"], ["report"], ["keep", "result"]]) {
    await assert.rejects(segue(...call), /stays within/, call[0]);
  }
  assert.equal((await segue("clips")).length, clips);
  await segue("set", { a: "walk" });
  assert.ok((await segue("pose", "result", 0)).joints.length > 10);
});
