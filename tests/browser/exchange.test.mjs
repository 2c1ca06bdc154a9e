// Tests of exported files with other programs: three.js, and the validator of Khronos.

import assert from "node:assert/strict";
import { onOneBackend } from "./harness.mjs";
import { striding } from "./help.mjs";
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
