// Tests of exported files with other programs: three.js, and the validator of Khronos.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { onOneBackend } from "./harness.mjs";
import { striding, until } from "./help.mjs";
import { AS_GOOD_AS_SAME, byIndex, complaints, farthest, fromBvh, fromCsv, fromGlb } from "./read_back.mjs";

/** The units of `striding` and of Segue's own clips. */
const METRES_PER_UNIT = 0.01;

// Fails when the formats have different motions, and when a GLB is invalid or shows nothing.
onOneBackend("exported motion is the same in three.js", async ({ open }) => {
  const { segue, load } = await open("lab=blend&play=off", { viewport: [960, 640] });
  await segue("set", {});
  const { clips: [clip] } = await load("strides.bvh", striding({ frames: 40 }));
  for (const which of ["result", clip.id]) {
    const [bvh, glb, csv] = [await segue("export", which, "bvh"), await segue("export", which, "glb"), await segue("export", which, "csv")];
    const expected = fromCsv(csv.toString());
    assert.ok(expected.frames.length > 10 && expected.joints.length > 10, which);
    assert.ok(farthest(expected, fromBvh(bvh.toString(), METRES_PER_UNIT)) < AS_GOOD_AS_SAME, `${which} as BVH`);
    const found = await fromGlb(glb);
    assert.ok(farthest(expected, found, byIndex) < AS_GOOD_AS_SAME, `${which} as GLB`);
    assert.ok(found.skin.geometry.getAttribute("position").count >= 24 * expected.joints.length / 2, `${which} has a body`);
    assert.deepEqual(await complaints(glb), [], which);
  }
});

onOneBackend("exported GLB can be loaded", async ({ open }) => {
  const { segue, load } = await open("lab=blend&play=off", { viewport: [960, 640] });
  const { clips: [clip] } = await load("strides.bvh", striding({ frames: 40 }));
  const { clips: [back], warnings } = await load("back.glb", await segue("export", clip.id, "glb"));
  assert.deepEqual(warnings, []);
  assert.deepEqual([back.frames, back.joints, Math.round(back.fps)], [clip.frames, clip.joints, 60]);
});

// Fails when files are not converted by the worker, when what converts is fetched before it is
// needed, and when it cannot be fetched and nothing says so, or there is no second try.
onOneBackend("dropped files are converted into an archive, also at the second try", async ({ open }) => {
  const fetched = [];
  let isThere = false;
  const prepare = (page) => page.context().route("**/convert/*", (route) => {
    fetched.push(route.request().url().split("/").at(-1));
    return isThere ? route.continue() : route.abort();
  });
  const { page, segue, load, dropFiles } = await open("lab=view&play=off", { viewport: [960, 640], prepare });
  await load("read.bvh", striding({ frames: 12 }));
  assert.deepEqual(fetched, [], "reading needs nothing of it");
  const press = (role, name) => page.getByRole(role, { name, exact: true }).evaluate((element) => element.click());
  await press("button", "More ways to share");
  await until("the menu is open", async () => (await page.getByRole("menuitem", { name: "Convert many files…" }).count()) === 1);
  await press("menuitem", "Convert many files…");
  const dialog = page.getByRole("dialog", { name: "Convert many files" });
  const says = (what) => until(`it says "${what}"`, async () => (await dialog.count()) === 1 && (await dialog.textContent()).includes(what));
  await says("Drop files");
  const convert = async () => {
    await dropFiles([["one.bvh", striding({ frames: 20 })], ["two.bvh", striding({ frames: 30, swing: 20 })]]);
    await says("2 files");
    await press("button", "Convert");
  };
  const downloads = [];
  page.on("download", (download) => downloads.push(download));
  await convert();
  await says("2 failed");
  assert.match(await dialog.textContent(), /check the network and try again/);
  isThere = true;
  await convert();
  await says("2 saved");
  // The first try has saved its table alone.
  const saved = await until("the archive is saved", async () => {
    const archives = await Promise.all(downloads.map(async (download) => (await readFile(await download.path())).toString("latin1")));
    return archives.find((archive) => archive.includes("one.bvh"));
  });
  for (const name of ["two.bvh", "conversion.csv"]) assert.ok(saved.includes(name), name);
  assert.ok(fetched.includes("converter_bg.wasm"));
  assert.equal((await segue("clips")).filter(({ sha256 }) => sha256).length, 1, "the library is as before");
});

// Fails when a long clip of the library is not converted by the worker, when the page does not
// convert it where the worker cannot, and when the two archives differ.
onOneBackend("long clip of the library is converted by the worker, or by the page where that cannot", async ({ open }) => {
  const archives = [];
  for (const isThere of [true, false]) {
    const prepare = async (page) => {
      await page.context().route("**/convert/*", (route) => (isThere ? route.continue() : route.abort()));
      await page.addInitScript(() => {
        window.written = 0;
        window.Worker = class extends Worker {
          constructor(...args) {
            super(...args);
            this.addEventListener("message", ({ data }) => (window.written += data.end && data.bytes ? 1 : 0));
          }
        };
      });
    };
    const { page, load } = await open("lab=view&play=off", { viewport: [1280, 800], prepare });
    await load("read.bvh", striding({ frames: 6000 }));
    const row = page.getByRole("button", { name: /^read/ }).first();
    await until("the clip is listed", async () => (await row.count()) === 1);
    const { x, y, width, height } = await row.boundingBox();
    await page.keyboard.down("Control");
    await page.mouse.click(x + width / 2, y + height / 2);
    await page.keyboard.up("Control");
    const press = (name) => page.getByRole("button", { name, exact: true }).evaluate((element) => element.click());
    await until("it is chosen", async () => (await page.getByRole("button", { name: "Convert…", exact: true }).count()) === 1);
    await press("Convert…");
    const dialog = page.getByRole("dialog", { name: "Convert many files" });
    await until("the dialog is open", async () => (await dialog.count()) === 1);
    const writtenBefore = await page.evaluate(() => window.written);
    const download = page.waitForEvent("download");
    await press("Convert");
    await until("it is saved", async () => (await dialog.textContent()).includes("1 saved"));
    assert.equal(await page.evaluate(() => window.written) - writtenBefore, isThere ? 1 : 0);
    archives.push(await readFile(await (await download).path()));
  }
  assert.ok(archives[0].equals(archives[1]), `${archives.map(({ length }) => length)} bytes`);
});
