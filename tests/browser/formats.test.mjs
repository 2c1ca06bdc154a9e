// Tests of the formats that the page's worker reads, and of those that it writes.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { onBothBackends, onOneBackend } from "./harness.mjs";
import { apart, stored, until } from "./help.mjs";
import { boxModel } from "./model.mjs";
import { complaints } from "./read_back.mjs";

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
  const { segue, load } = await open("lab=view&play=off", { scale: 1, ...SMALL });
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

// Fails when the files of a model are read one by one, so that its arrays or its image are missing,
// when they are not stored together, when the image is not drawn between the corners of the box,
// whose own colours would mix, and when a saved file does not have it.
onBothBackends("textured model is dropped with its arrays and its image", async ({ open }) => {
  const { page, segue, load, dropFiles, ready, snapshot } = await open("lab=view&play=off", { scale: 1, ...SMALL });
  await segue("set", {});
  const files = boxModel("box", [[230, 0, 0], [0, 0, 230]]);
  await dropFiles([["notes.txt", Buffer.from("no motion")], ...files]);
  const isRed = (red, green, blue) => red > 90 && red > 4 * green && red > 4 * blue;
  const isBlue = (red, green, blue) => blue > 90 && blue > 4 * green && blue > 4 * red;
  const shown = async () => {
    const picture = await snapshot();
    const [red, blue] = [isRed, isBlue].map((is) => {
      let pixels = 0;
      for (let y = 0; y < picture.height; y++) for (let x = 0; x < picture.width; x++) pixels += is(...picture.at(x, y));
      return pixels / (picture.width * picture.height);
    });
    return red > 0.002 && blue > 0.01;
  };
  const clips = async () => (await segue("clips")).filter(({ sha256 }) => sha256).map(({ name, joints }) => [name, joints]);
  await until("the box is in the library", async () => (await clips()).length > 0);
  assert.deepEqual(await clips(), [["box", 2]]);
  await until("the box is red and blue", shown);
  await until("it is stored", async () => (await stored(page)).ids.some((id) => id.startsWith("box")));
  const [box] = (await segue("clips")).filter(({ sha256 }) => sha256);
  const saved = await segue("export", box.id, "glb");
  assert.deepEqual(await complaints(saved), []);
  assert.ok(Buffer.from(saved).includes(files[2][1]), "the image is in the file, byte by byte");
  await page.reload();
  await ready();
  await until("the box is there again", async () => (await clips()).length > 0);
  await until("it is red and blue again", shown);
  const [again] = (await load("saved.glb", saved)).clips;
  await segue("set", { a: again.id });
  await until("the saved one is red and blue", shown);
});
