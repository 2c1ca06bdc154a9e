// Tests of the formats that the page's worker reads, and of those that it writes.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { onOneBackend } from "./harness.mjs";
import { apart } from "./help.mjs";

const SMALL = { viewport: [960, 640] };
/** Files of the tests of the readers, and of the fuzzer, with their joints and frames. */
const CASES = [
  ["c3d/ezc3d.c3d", 6, 7],
  ["../../../../fuzz/corpus-seeds/fbx/binary.fbx", 3, 2],
  ["../../../../fuzz/corpus-seeds/fbx/text.fbx", 3, 2],
  ["numpy/amass.npz", 52, 8],
  ["numpy/joints22.npy", 22, null],
  ["robot_csv/named.csv", 30, 12],
  ["vrm/one.vrm", 23, 1],
];

// Fails when a reader is missing from the worker, and when a file is taken for another format.
onOneBackend("files of every format open", async ({ open }) => {
  const { segue, load } = await open("lab=view&play=off", SMALL);
  for (const [path, joints, frames] of CASES) {
    const bytes = await readFile(new URL(`../../crates/formats/tests/cases/${path}`, import.meta.url));
    const [clip] = (await load(path.split("/").at(-1), bytes)).clips;
    assert.equal(clip.joints, joints, path);
    if (frames !== null) assert.equal(clip.frames, frames, path);
    await segue("set", { a: clip.id });
    const { positions } = await segue("pose", "result", 0);
    assert.ok(positions.length > 0 && positions.every(Number.isFinite), path);
  }
});

// Fails when a file that the page writes is not read again as the same motion.
onOneBackend("written files are read again", async ({ open }) => {
  const { segue, load } = await open("lab=view&a=walk&play=off", SMALL);
  for (const format of ["bvh", "fbx", "npz"]) {
    const [clip] = (await load(`again.${format}`, await segue("export", "result", format))).clips;
    for (const secs of [0, 0.7, 1.9]) {
      const far = apart(await segue("pose", "walk", secs), await segue("pose", clip.id, secs));
      assert.ok(far < 1e-3, `${format}: ${far} m at ${secs} s`);
    }
  }
});
