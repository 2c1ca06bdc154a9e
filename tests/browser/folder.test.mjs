// Tests of dropped folders: their motion files are read once each, in the order of their paths.

import assert from "node:assert/strict";
import { onOneBackend } from "./harness.mjs";
import { dropFolder, striding, until } from "./help.mjs";

const isAccent = (red, green, blue) => green > 150 && green - red > 60 && green - blue > 20;

// Fails when a folder is read as a file, when a file is read twice or out of order, and when the
// drop zone stays open.
onOneBackend("motion files of a dropped folder are read in order", async ({ open }) => {
  const { page, segue, pixels } = await open("lab=blend&play=off", { scale: 1, viewport: [960, 640] });
  await segue("set", {});
  await dropFolder(page, [
    ["/takes/z.bvh", striding({ frames: 30 }).toString()],
    ["/takes/notes.txt", "no motion"],
    ["/takes/day 1/b.bvh", striding({ frames: 20 }).toString()],
    ["/takes/day 1/._b.bvh", "what a Mac adds"],
    ["/takes/day 1/a.bvh", striding({ frames: 10 }).toString()],
  ]);
  const loaded = await until("three files are in the library", async () => {
    const clips = (await segue("clips")).filter((clip) => clip.sha256);
    return clips.length >= 3 && clips;
  });
  assert.deepEqual(loaded.map(({ name, frames }) => [name, frames]), [["a", 10], ["b", 20], ["z", 30]]);
  const { a, b } = await segue("params");
  assert.deepEqual([a, b], [loaded[0].id, loaded[1].id]);
  await until("the field for drops is gone", async () => {
    const picture = await pixels();
    return ![10, 11, 12, 13, 14].some((x) => isAccent(...picture.at(x, 320)));
  });
});

onOneBackend("folder without motion files is reported", async ({ open }) => {
  const { page, segue } = await open("lab=blend&play=off", { viewport: [960, 640] });
  await page.evaluate(() => {
    window.errors = [];
    window.segue.on("error", ({ message }) => window.errors.push(message));
  });
  await segue("set", {});
  await dropFolder(page, [["/papers/notes.txt", "no motion"]]);
  const [message] = await until("it is reported", () => page.evaluate(() => window.errors.length && window.errors));
  assert.match(message, /^papers has no motion files \(\.bvh/);
});
