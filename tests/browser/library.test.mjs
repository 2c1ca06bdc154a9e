// Tests of a library of many files: it is listed in the order of the drop, whole after a reload
// before any motion is read, and a clip that is used is read again.

import assert from "node:assert/strict";
import { onOneBackend } from "./harness.mjs";
import { dropFolder, stored, striding, until } from "./help.mjs";

const FILES = 150;
const SMALL = { viewport: [960, 640] };

/** Returns files of a folder, each of another motion. */
const takes = (folder, count) => Array.from({ length: count }, (_, index) => [
  `/${folder}/${String(index).padStart(3, "0")}.bvh`, striding({ frames: 10 + (index % 7), swing: 10 + 0.1 * index }).toString(),
]);

/** Has the page count the files that are handed to workers. */
const counting = (page) => page.addInitScript(() => {
  window.readTasks = [];
  const post = Worker.prototype.postMessage;
  Worker.prototype.postMessage = function (message, ...rest) {
    if (message?.setup !== undefined) window.readTasks.push(message.name);
    return post.call(this, message, ...rest);
  };
});

const own = async (segue) => (await segue("clips")).filter((clip) => clip.sha256);
const tasks = (page) => page.evaluate(() => window.readTasks);

/** Returns what the page's API says of a clip: its numbers in the View lab, a pose, and a file of it. */
async function measured(segue, id) {
  await segue("set", { lab: "view", a: id });
  const { positions } = await segue("pose", id, 0.05);
  return { metrics: await segue("metrics"), positions, file: (await segue("export", id, "bvh")).toString("base64") };
}

// Fails when files are listed out of order, when a reload reads what nobody has asked for, when a
// list without motions lacks something, and when a clip that is read again is another one.
onOneBackend("library of many files is whole after a reload, and a clip that is used is read again", async ({ open }) => {
  const { page, segue, ready } = await open("lab=view&a=walk&play=off", { ...SMALL, prepare: counting });
  await segue("set", {});
  await dropFolder(page, takes("takes", FILES));
  const clips = await until("all files are in the library", async () => {
    const clips = await own(segue);
    return clips.length === FILES && clips;
  });
  assert.deepEqual(clips.map(({ name }) => name), takes("takes", FILES).map(([path]) => path.slice(7, 10)));
  assert.ok(clips.every(({ frames, joints, height }, index) => frames === 10 + (index % 7) && joints === 31 && height > 1));
  assert.equal((await tasks(page)).length, FILES, "each is read once");
  const [one, other] = [clips[140].id, clips[33].id];
  const before = [await measured(segue, one), await measured(segue, other)];
  await segue("set", { lab: "view", a: one });
  await until("all is stored", async () => {
    const { query, ids, files } = await stored(page);
    return files.length === FILES && query.includes(encodeURIComponent(one)) && ids.length > FILES;
  });
  // It goes before what is stored.
  await until("the address follows", () => page.url().includes(encodeURIComponent(one)));

  await page.reload({ waitUntil: "commit" });
  await ready();
  await until("the list is whole", async () => (await own(segue)).length === FILES);
  assert.deepEqual(await own(segue), clips);
  await segue("set", {});
  assert.deepEqual(await tasks(page), ["takes/140.bvh"], "only the clip on the stage is read");
  assert.deepEqual(await measured(segue, one), before[0]);
  // A pose and a file are waited for, whether or not the clip is shown.
  assert.deepEqual((await segue("pose", other, 0.05)).positions, before[1].positions);
  assert.deepEqual(await measured(segue, other), before[1]);
  assert.deepEqual(await tasks(page), ["takes/140.bvh", "takes/033.bvh"]);
});

// Fails when a clip that was removed after a reload is not there after undo, and when its file is
// deleted meanwhile.
onOneBackend("undo brings back a removed clip whose motion was never read", async ({ open }) => {
  const { page, segue, load, ready } = await open("lab=view&a=walk&play=off", SMALL);
  await segue("set", {});
  const { clips: [mine] } = await load("mine.bvh", striding({ frames: 12 }));
  await load("other.bvh", striding({ frames: 13 }));
  await segue("set", { a: "walk" });
  await until("it is stored", async () => (await stored(page)).ids.includes(mine.id));
  await page.reload({ waitUntil: "commit" });
  await ready();
  await until("it is here", async () => (await own(segue)).length === 2);
  await page.keyboard.press("Escape");
  await page.locator("[aria-label^='mine']").first().focus();
  await page.keyboard.press("Delete");
  await until("it is gone, and the work is stored", async () => !(await stored(page)).ids.includes(mine.id));
  await page.keyboard.press("Control+z");
  await until("it is back", async () => (await own(segue)).some(({ id }) => id === mine.id));
  assert.equal((await segue("pose", mine.id, 0)).joints.length, 31);
});

// Fails when a drop of many files cannot be stopped, and when it has no single job.
onOneBackend("drop of many files is one job that stops", async ({ open }) => {
  const { page, segue } = await open("lab=view&a=walk&play=off", SMALL);
  await segue("set", {});
  await page.evaluate(() => {
    window.stoppedAt = new Promise((resolve) => {
      window.segue.on("progress", ({ name, progress }) => {
        if (name !== "files" || !(progress > 0)) return;
        const jobs = window.segue.stats().jobs.filter((job) => job.name === "files" || job.name.endsWith(".bvh"));
        try {
          window.segue.stop("files");
          resolve(jobs);
        } catch {
          // It has ended meanwhile.
        }
      });
    });
  });
  await dropFolder(page, takes("many", 400));
  const jobs = await page.evaluate(() => window.stoppedAt);
  assert.equal(jobs.length, 1);
  await until("nothing is read any more", async () => !(await segue("stats")).jobs.some(({ name }) => name === "files"));
  const there = (await own(segue)).length;
  assert.ok(there < 400, `${there} of 400 files`);
  await page.waitForTimeout(500);
  assert.equal((await own(segue)).length, there, "none comes later");
});
