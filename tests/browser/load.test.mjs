// Tests of loading: dropped files, broken files, and files after a reload.

import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import process from "node:process";
import { fileURLToPath } from "node:url";
import { onOneBackend } from "./harness.mjs";
import { apart, computingTime, striding, stored, until } from "./help.mjs";

const SMALL = { viewport: [960, 640] };
/** Returns the clips of files, in the order of their loading. */
const loaded = async (segue) => (await segue("clips")).filter((clip) => clip.sha256);

// Fails when the drop does not reach the app, when a clip gets another slot, and when the result is
// not made of the dropped clips.
onOneBackend("dropped files become A, then B, and play", async ({ open }) => {
  const { segue, dropFile } = await open("lab=blend&play=off", SMALL);
  await dropFile("slow.bvh", striding({ hertz: 0.8, swing: 20 }));
  const [slow] = await until("the first file is in the library", async () => (await loaded(segue)).length === 1 && loaded(segue));
  assert.deepEqual([slow.format, slow.joints, slow.frames, Math.round(slow.fps)], ["bvh", 31, 180, 60]);
  assert.equal((await segue("params")).a, slow.id);

  await dropFile("fast.bvh", striding({ hertz: 1.5, swing: 45, frames: 150 }));
  const fast = await until("the second file is in the library", async () => (await loaded(segue)).find((clip) => clip.id !== slow.id));
  const params = await until("both are in their slots", async () => {
    const params = await segue("params");
    return params.b === fast.id && params;
  });
  assert.equal(params.a, slow.id);
  assert.notEqual(fast.sha256, slow.sha256);

  await until("the result is of these two", async () => {
    const pose = await segue("pose", "result", 0.2).catch(() => undefined);
    return pose && apart(pose, await segue("pose", slow.id, 0.2)) < 1e-3;
  });
  assert.ok(apart(await segue("pose", "result", 0.2), await segue("pose", "result", 0.6)) > 0.05, "it moves");
  await segue("play");
  const before = await segue("time");
  await until("the playhead moves", async () => (await segue("time")) !== before);
});

const SHARED = [process.env.SEGUE_SHARED, fileURLToPath(new URL("../../../shared/data", import.meta.url)), fileURLToPath(new URL("../../../../shared/data", import.meta.url))]
  .find((folder) => folder && existsSync(`${folder}/cmu/run.bvh`));

onOneBackend("dropped takes of two studios are blended", async ({ open, t }) => {
  if (!SHARED) return t.skip("the takes are not here");
  const { segue, dropFile } = await open("lab=blend&play=off", SMALL);
  for (const [index, path] of ["cmu/run.bvh", "games105/walkF.bvh"].entries()) {
    await dropFile(path.split("/")[1], readFileSync(`${SHARED}/${path}`));
    await until(`${path} is in the library`, async () => (await loaded(segue)).length === index + 1);
  }
  const clips = await loaded(segue);
  for (const { name, height } of clips) assert.ok(height > 1.2 && height < 2.2, `${name} is ${height} m tall`);
  const params = await segue("params");
  assert.deepEqual([params.a, params.b], clips.map((clip) => clip.id));
  await until("there is a result", async () => segue("pose", "result", 0).then(() => true, () => false));
});

// Fails when a broken file changes the state, when its refusal has no position, and when the app
// stops.
onOneBackend("broken file is refused with its position, and changes nothing", async ({ open }) => {
  const { segue, load } = await open("lab=blend&play=off", SMALL);
  await segue("set", {}); // resolves when the clips that Segue makes itself are made
  const before = await segue("clips");
  const good = striding({ frames: 4 }).toString();
  const random = Buffer.from(Array.from({ length: 4096 }, (_, index) => (index * 7919 + (index >> 3) * 104_729) % 256));
  const broken = [
    ["cut.bvh", good.slice(0, 300), /cut\.bvh:\d+:\d+: found .+, expected /],
    ["word.bvh", good.replace("OFFSET 9 -4 0", "OFFSET 9 banana 0"), /word\.bvh:\d+:\d+: found .*banana.*, expected /],
    ["random.bvh", random, /random\.bvh:\d+:\d+: found .+, expected /],
    ["empty.bvh", "", /empty\.bvh:\d+:\d+: found .+, expected /],
    ["picture.png", random, /picture\.png/],
  ];
  for (const [name, content, reason] of broken) {
    await assert.rejects(load(name, Buffer.from(content)), reason, name);
    assert.deepEqual(await segue("clips"), before, `${name} changes nothing`);
  }
  const { clips } = await load("good.bvh", Buffer.from(good));
  assert.equal(clips[0].frames, 4);
  assert.equal((await segue("clips")).length, before.length + 1, "the app goes on");
  // A header that states too much reserves no memory. The existing frames are read, and a warning
  // names the missing ones.
  const endless = await load("endless.bvh", Buffer.from(good.replace("Frames: 4", "Frames: 4000000000")));
  assert.equal(endless.clips[0].frames, 4);
  assert.match(endless.warnings.join(), /4000000000/);
  assert.ok((await segue("stats")).wasm_bytes < 200e6);
});

onOneBackend("dropped broken file is reported", async ({ open }) => {
  const { page, segue, dropFile } = await open("lab=blend&play=off", SMALL);
  await page.evaluate(() => {
    window.errors = [];
    window.segue.on("error", ({ message }) => window.errors.push(message));
  });
  await segue("set", {});
  const before = await segue("clips");
  await dropFile("torn.bvh", Buffer.from("HIERARCHY\nROOT Hips\n{\n  OFFSET a b c\n"));
  const [message] = await until("an error is reported", () => page.evaluate(() => window.errors.length && window.errors));
  assert.match(message, /torn\.bvh:4:\d+: found .*a.*, expected /);
  assert.deepEqual(await segue("clips"), before);
});

/** Returns a zip of empty files. */
function emptyFiles(count) {
  const [parts, directory] = [[], []];
  let at = 0;
  for (let index = 0; index < count; index++) {
    const name = Buffer.from(`n${String(index).padStart(5, "0")}.bvh`);
    const local = Buffer.alloc(30);
    local.write("PK\x03\x04", "latin1");
    local.writeUInt16LE(20, 4);
    local.writeUInt16LE(name.length, 26);
    const central = Buffer.alloc(46);
    central.write("PK\x01\x02", "latin1");
    central.writeUInt16LE(20, 6);
    central.writeUInt16LE(name.length, 28);
    central.writeUInt32LE(at, 42);
    parts.push(local, name);
    directory.push(central, name);
    at += local.length + name.length;
  }
  const list = Buffer.concat(directory);
  const end = Buffer.alloc(22);
  end.write("PK\x05\x06", "latin1");
  end.writeUInt16LE(count, 8);
  end.writeUInt16LE(count, 10);
  end.writeUInt32LE(list.length, 12);
  end.writeUInt32LE(at, 16);
  return Buffer.concat([...parts, list, end]);
}

// Fails when an archive may contain any number of files, and when each broken one is reported
// before they are counted: the page then computed for 70 s.
onOneBackend("zip of 60,000 empty files does not stop the frames, and its refusal names the limit", async ({ open, t }) => {
  const { page, segue, load } = await open("lab=view&play=off", SMALL);
  await segue("set", {});
  const before = await segue("clips");
  const computed = await computingTime(page);
  const { clips, warnings } = await load("many_names.zip", emptyFiles(60_000));
  assert.deepEqual(clips, []);
  assert.ok(warnings.some((warning) => warning.includes("58000 motion files of the archive left out: the first 2000 are read")), warnings.slice(0, 3).join("\n"));
  assert.match(warnings.join("\n"), /n00000\.bvh:1:1: found an empty file/);
  const { frames } = await segue("stats");
  await until("it draws", async () => (await segue("stats")).frames > frames);
  const secs = await computed();
  t.diagnostic(`the page's thread computed for ${secs.toFixed(2)} s`);
  assert.ok(secs > 0 && secs < 2, `${secs} s of computing on the page's thread`);
  assert.deepEqual(await segue("clips"), before);
});

// Fails when the library, the parameters or the bytes of the files are not restored from storage.
onOneBackend("reload restores the work", async ({ open }) => {
  const { page, segue, load, ready } = await open("", SMALL);
  const { clips } = await load("mine.bvh", striding({ frames: 90 }));
  await segue("set", { lab: "blend", compare: "", a: clips[0].id, blend_window: 17, weight_law: "linear", play: false, t: 0.4 });
  await segue("set", {});
  const [params, library, pose] = [await segue("params"), await segue("clips"), await segue("pose", "result", 0.4)];
  await until("the work is stored", async () => {
    const { query, files } = await stored(page);
    return files.length === 1 && query.includes("blend_window=17");
  });
  // Without the link, so that everything is restored from storage.
  await page.goto(new URL(page.url()).origin, { waitUntil: "commit" });
  await ready();
  await segue("set", {});
  // A slow storage answers after the first frame.
  await until("the library is back", async () => (await segue("clips")).length === library.length);
  assert.deepEqual(await segue("clips"), library);
  assert.deepEqual(await segue("params"), params);
  await until("the result is back", () => segue("pose", "result", 0.4).then(() => true, () => false));
  assert.ok(apart(await segue("pose", "result", 0.4), pose) < 1e-6, "the same result as before");
});

// Fails when the work of a late storage is lost, or replaced by a clip that was dropped meanwhile.
onOneBackend("late stored work joins a clip that was dropped meanwhile", async ({ open }) => {
  const { page, segue, load, dropFile, ready } = await open("", SMALL);
  const mine = (await load("mine.bvh", striding({ frames: 90 }))).clips[0];
  await until("the work is stored", async () => (await stored(page)).files.length === 1);
  await page.addInitScript(holdStorage);
  await page.goto(new URL(page.url()).origin, { waitUntil: "commit" });
  await ready();
  assert.deepEqual(await loaded(segue), [], "it is not here yet");
  await dropFile("new.bvh", striding({ frames: 60 }));
  const [dropped] = await until("the dropped file is in the library", async () => (await loaded(segue)).length === 1 && loaded(segue));
  await page.waitForTimeout(1500); // longer than work is quiet before it is stored
  await page.evaluate(() => window.letIn());
  await until("both are in the library", async () => (await loaded(segue)).length === 2);
  assert.deepEqual((await loaded(segue)).map(({ id }) => id).sort(), [mine.id, dropped.id].sort());
  assert.equal((await segue("params")).a, dropped.id, "what was dropped keeps its place");
  await until("both are stored", async () => {
    const { ids, files } = await stored(page);
    return files.length === 2 && ids.includes(mine.id) && ids.includes(dropped.id);
  });
});

/** Runs in the page. Delays the opening of the database until `letIn()` is called. */
function holdStorage() {
  const { open } = IDBFactory.prototype;
  const { set } = Object.getOwnPropertyDescriptor(IDBRequest.prototype, "onsuccess");
  const free = new Promise((resolve) => { window.letIn = resolve; });
  IDBFactory.prototype.open = function (...args) {
    const request = open.apply(this, args);
    Object.defineProperty(request, "onsuccess", { set: (callback) => set.call(request, (event) => { free.then(() => callback?.call(request, event)); }) });
    return request;
  };
}

// Fails when one tab overwrites the clips that another has stored, and when it deletes their files.
onOneBackend("two tabs keep the clips of both", async ({ open }) => {
  const { page, segue, load, ready } = await open("play=off", SMALL);
  const other = await page.context().newPage();
  await other.goto(page.url(), { waitUntil: "commit" });
  await other.waitForFunction(() => "segueReady" in window);
  await other.evaluate(async () => (await window.segueReady).set({}));

  await page.bringToFront();
  const mine = (await load("mine.bvh", striding({ frames: 90 }))).clips[0];
  await until("the first tab's file is stored", async () => (await stored(page)).ids.includes(mine.id));
  await other.bringToFront();
  const theirs = await other.evaluate(async (text) => (await (await window.segueReady).load("theirs.bvh", new TextEncoder().encode(text))).clips[0], striding({ frames: 60 }).toString());
  await until("the second tab's file is stored", async () => (await stored(page)).ids.includes(theirs.id));
  assert.deepEqual((await stored(page)).files.sort(), [mine.sha256, theirs.sha256].sort());

  await page.bringToFront();
  await segue("set", { blend_window: 19 });
  await until("the first tab has stored again", async () => (await stored(page)).query.includes("blend_window=19"));
  assert.deepEqual((await stored(page)).files.sort(), [mine.sha256, theirs.sha256].sort());
  await page.goto(new URL(page.url()).origin, { waitUntil: "commit" });
  await ready();
  await segue("set", {});
  assert.deepEqual((await loaded(segue)).map(({ id }) => id).sort(), [mine.id, theirs.id].sort());
});
