// Tests of the labs: each has a result, its numbers are those of its motion, and the result can be
// kept and used in another lab.

import assert from "node:assert/strict";
import { Buffer } from "node:buffer";
import { readFileSync } from "node:fs";
import { onBothBackends, onOneBackend } from "./harness.mjs";
import { apart, striding, until } from "./help.mjs";

const DESK = { viewport: [1000, 700] };

/** Returns the values of one metric, pane by pane. */
const panes = async (segue, name) => (await segue("metrics"))[name].panes;

// Fails when the speed is not that of the motion.
onOneBackend("speed lab has the speed of the parameter", async ({ open }) => {
  const { segue } = await open("lab=speed&speed=1.5", DESK);
  await segue("set", {});
  for (const speed of [1.5, 2.3, 3.4]) {
    await segue("set", { speed });
    const [measured] = await panes(segue, "speed_mps");
    assert.ok(Math.abs(measured - speed) < 0.02 * speed, `asked for ${speed} m/s, measured ${measured}`);
  }
  assert.ok((await segue("time")) >= 0);
});

// Fails when a cycle has a seam, and when the classic methods have none.
onOneBackend("exact loop has no seam, and one spring alone has one", async ({ open }) => {
  const { segue } = await open("lab=loop&a=walk_left&loop_from=0.3&loop_to=1.2&compare=loop_method:exact,linear&play=off", DESK);
  await segue("set", {});
  const [exact, linear] = await panes(segue, "loop_seam_dps");
  assert.ok(exact < 1, `the exact one: ${exact} °/s`);
  assert.ok(linear > 5 * Math.max(exact, 0.1), `the linear one: ${linear} °/s`);
});

// Fails when the rebuilt root motion is not that of the clip it was removed from.
onOneBackend("removed root motion is rebuilt from the feet", async ({ open }) => {
  const { segue } = await open("lab=in_place&a=walk&compare=root_way:take_out,put_back&play=off", DESK);
  await segue("set", {});
  const [removed, rebuilt] = await panes(segue, "root_way_m");
  assert.ok(removed > 1, `removed ${removed} m`);
  assert.ok(Math.abs(rebuilt - removed) < 0.02 * removed, `rebuilt ${rebuilt} m of ${removed} m`);
  const [start, end] = await Promise.all([0, 1].map((time) => segue("pose", "result", time)));
  assert.ok(apart(start, end) > 0.01, "its body moves");
});

// Fails when faults that were put in are not found, or stay after the mends.
onOneBackend("faults of a take are found and mended", async ({ open }) => {
  const { segue } = await open("lab=clean&a=walk&clean_faults=4&clean_seed=7&compare=clean_mend:on,off&play=off", DESK);
  await segue("set", {});
  const [mended, recorded] = await panes(segue, "faults_left");
  assert.equal(mended, 0);
  assert.ok(recorded >= 4, `${recorded} found`);
  const [smooth, rough] = await panes(segue, "pose_jump_deg");
  assert.ok(rough > 20 && smooth < 0.1 * rough, `${rough}° and ${smooth}°`);
});

// Fails when an edit of the link is not made, or a kept edit is not made again from its recipe.
onOneBackend("clip is trimmed, mirrored and kept as its recipe", async ({ open }) => {
  const { segue } = await open("lab=edit&a=walk_left&edit_from=0.5&edit_to=1.5&scale=2&compare=mirror:off,on&play=off", DESK);
  await segue("set", {});
  assert.deepEqual(await panes(segue, "clip_s"), [1, 1]);
  const [recorded, mirrored] = await panes(segue, "root_way_mps");
  assert.ok(recorded > 2 && Math.abs(recorded - mirrored) < 0.01, `${recorded} and ${mirrored} m/s`);
  const id = await segue("keep", "result:1");
  assert.equal(id, "edit(a:walk_left,edit_from:0.5,edit_to:1.5,mirror:on,scale:2)");
  const kept = await segue("pose", id, 0.5);
  assert.ok(apart(await segue("pose", "result:1", 0.5), kept) < 1e-6, "it is the result");
  const other = await open(`lab=view&a=${id}&play=off`, DESK);
  await other.segue("set", {});
  assert.ok(apart(await other.segue("pose", "result", 0.5), kept) < 1e-6, "its link alone makes it");
});

// Fails when the layer moves the legs, or does not move the arms.
onOneBackend("layer moves the joints of its mask, and no others", async ({ open }) => {
  const { segue } = await open("lab=layers&mask=arms&feather=0&play=off", DESK);
  await segue("set", {});
  const [arms] = await panes(segue, "off_arms_deg");
  const [legs] = await panes(segue, "off_legs_deg");
  assert.ok(arms > 5 && legs < 0.01, `arms ${arms}°, legs ${legs}°`);
  await segue("set", { layer_weight: 0 });
  assert.ok(apart(await segue("pose", "result", 1), await segue("pose", "walk", 1)) < 1e-4, "without weight it is A");
});

// Fails when a chosen mistake has no effect, or one occurs where none is chosen.
onOneBackend("classic mistake is shown beside the right method", async ({ open }) => {
  const { segue } = await open("lab=transition&compare=mistake:none,degrees,atan&play=off", DESK);
  await segue("set", {});
  const seams = await panes(segue, "velocity_jump_dps");
  assert.ok(seams[1] > 10 * seams[0], `seams: ${seams}`);
  const spins = await panes(segue, "spin_deg");
  assert.ok(spins[2] > 60 && spins[0] < 5, `spins: ${spins}`);
});

// Fails when the character does not follow its path, and when the path is not part of the link.
onOneBackend("character follows the path of the link, beside others", async ({ open }) => {
  const { segue } = await open("lab=path&a=walk&play=off", DESK);
  await segue("set", {});
  const half = async (which) => (await segue("pose", which, 1.6)).positions.slice(0, 3);
  const before = await half("result");
  assert.ok(apart(await segue("pose", "result", 1), await segue("pose", "walk", 1)) < 1e-3, "the path is not edited");
  await segue("set", { path: "AAUAAADIAfAByAF3yAF3rAI", others: "run,walk_left" });
  const [x] = await half("result");
  assert.ok(x - before[0] > 0.3, `the hips are ${x - before[0]} m to the left`);
  assert.ok((await panes(segue, "path_m"))[0] > (await panes(segue, "path_original_m"))[0]);
  const url = new URL(await segue("url"));
  const other = await open(url.search.slice(1), DESK);
  await other.segue("set", {});
  assert.ok(apart(await other.segue("pose", "result", 1.6), await segue("pose", "result", 1.6)) < 1e-6);
  const id = await segue("keep", "result");
  assert.match(id, /^path\(a:walk,path:[\w-]+\)$/);
});

// Fails when the graph has no walk, when the same seed gives another one, when the walk does not
// continue, and when a classic mistake does not spin.
onOneBackend("graph lab walks by its seed, and the mistake spins", async ({ open }) => {
  const { segue } = await open("lab=graph&clips=walk,walk_left,walk_right&walk_seconds=20&compare=atan:atan2,atan&play=off", DESK);
  await segue("set", {});
  const spins = await panes(segue, "spins");
  assert.ok(spins[0] === 0 && spins[1] > 0, `spins: ${spins}`);
  const [seams] = await panes(segue, "seams_per_min");
  assert.ok(seams > 5, `${seams} transitions a minute`);
  const before = await segue("pose", "result", 15);
  await segue("set", { seed: 8 });
  assert.ok(apart(await segue("pose", "result", 15), before) > 0.01, "another seed, another walk");
  await segue("set", { seed: 7, t: 45 });
  assert.ok(apart(await segue("pose", "result", 15), before) < 1e-6, "the same seed, the same walk");
  await until("the walk is longer than what is measured", async () => (await segue("time")) === 45);
});

/**
 * Returns the rotation of every joint relative to its parent, which does not depend on the place of
 * the clip. The root has the identity.
 */
function bends({ parents, rotations }) {
  const of = (joint) => rotations.slice(4 * joint, 4 * joint + 4);
  return parents.map((parent, joint) => {
    if (parent < 0) return [0, 0, 0, 1];
    const [[px, py, pz, pw], [x, y, z, w]] = [of(parent), of(joint)];
    return [
      pw * x - px * w - py * z + pz * y,
      pw * y - py * w - pz * x + px * z,
      pw * z - pz * w - px * y + py * x,
      pw * w + px * x + py * y + pz * z,
    ];
  });
}

/**
 * Returns the greatest difference between the relative rotations of two poses, as a difference of
 * quaternions.
 */
function bentApart(one, other) {
  const [a, b] = [bends(one), bends(other)];
  const dots = a.map((q, joint) => Math.abs(q.reduce((sum, value, axis) => sum + value * b[joint][axis], 0)));
  return Math.sqrt(Math.max(0, 2 - 2 * Math.min(...dots)));
}

// Fails when a walk leaves or enters a clip at another frame than the recorded native walk.
// Rounding would then have decided.
onBothBackends("built-in walk is the same in every browser and natively", async ({ open }) => {
  const golden = JSON.parse(readFileSync(new URL("../../crates/session/tests/golden/walk.json", import.meta.url), "utf8"));
  const { segue } = await open(golden.link, DESK);
  await segue("set", {});
  let [compared, distinct] = [0, 0];
  for (const { clip, from, to, start } of golden.stays) {
    // After its transition and before the next one, a stretch is its clip, frame by frame. A short
    // one has no such frame.
    const frames = [golden.window, to - from - 1].filter((frame) => frame >= golden.window && frame < to - from && (start + frame) / golden.fps < 60);
    for (const frame of frames) {
      const shown = await segue("pose", "result", (start + frame) / golden.fps);
      const off = bentApart(shown, await segue("pose", clip, (from + frame) / golden.fps));
      assert.ok(off < 2e-3, `${clip} ${from} to ${to}, at ${start}: ${off} off in frame ${frame}`);
      compared += 1;
      // The test is only meaningful where the next frame differs, which it does not in a character
      // at rest.
      if (bentApart(shown, await segue("pose", clip, (from + frame + 1) / golden.fps)) > 4e-3) distinct += 1;
    }
  }
  assert.ok(compared > golden.stays.length, `${compared} frames were compared`);
  assert.ok(2 * distinct > compared, `of ${compared} frames ${distinct} differ from the next one`);
});

// Fails when a scenario does not turn the character, when weights need a reload, and when the
// scenario is not in the link.
onOneBackend("character is driven through a scenario", async ({ open }) => {
  const { segue } = await open("lab=match&scenario=spin&play=off", DESK);
  await segue("set", {});
  const [turn] = await panes(segue, "match_turn");
  assert.ok(turn > 0.2 && turn < 2, `turned in ${turn} s`);
  const before = await segue("pose", "result", 3);
  await segue("set", { weight_feet: 3, weight_path: 0.2 });
  assert.ok(apart(await segue("pose", "result", 3), before) > 0.01, "other weights, other frames");
  const id = await segue("keep", "result");
  assert.match(id, /^match\(scenario:spin,weight_path:0.2,weight_feet:3\)$/);
});

// Fails when a kept result is not a clip like any other, when its link needs data, and when it is
// lost with the page.
onOneBackend("kept result can be used, linked and restored", async ({ open }) => {
  const { page, segue, ready } = await open("lab=transition&half_life=0.3&play=off", DESK);
  await segue("set", {});
  const id = await segue("keep", "result");
  assert.match(id, /^transition\(a:walk,b:run,half_life:0.3,mix_frame_a:\d+,mix_frame_b:\d+\)$/);
  const made = await segue("pose", "result", 2.5);
  await segue("set", { lab: "blend", a: id, b: "jump" });
  assert.ok(apart(await segue("pose", id, 2.5), made) < 1e-6, "the clip is the result");
  await assert.rejects(segue("keep", "walk"), /found `walk`/);
  const url = new URL(await segue("url"));

  const other = await open(url.search.slice(1), DESK);
  await other.segue("set", {});
  assert.ok(apart(await other.segue("pose", id, 2.5), made) < 1e-6, "made again from the link alone");

  await page.evaluate(() => document.dispatchEvent(new Event("visibilitychange")));
  await page.reload();
  await ready();
  await until("it is in the library", async () => (await segue("clips")).some((clip) => clip.id === id));
});

// Fails when a long curve stays as it is first drawn, from every n-th frame.
onOneBackend("spike of one frame is drawn in the curve of a long clip", async ({ open }) => {
  const { segue, load, pixels } = await open("lab=view&play=off&theme=dark&curve=height&joint=hips", { viewport: [1440, 900], scale: 1 });
  const lines = striding({ frames: 3000 }).toString().split("\n");
  const spike = lines.findIndex((line) => line.startsWith("Frame Time")) + 1 + 1501;
  lines[spike] = lines[spike].trim().split(/\s+/).map((number, channel) => (channel === 1 ? Number(number) + 60 : number)).join(" ");
  const { clips: [clip] } = await load("spike.bvh", Buffer.from(lines.join("\n")));
  await segue("set", { a: clip.id });
  /** The number of rows of the plot in which the curve is drawn near a place. */
  const height = (picture, x) => {
    const isCurve = ([red, green, blue]) => green > 140 && green > red + 50 && blue > red;
    const columns = Array.from({ length: 24 }, (_, at) => x - 12 + at);
    return Array.from({ length: 90 }, (_, at) => 780 + at).filter((y) => columns.some((column) => isCurve(picture.at(column, y)))).length;
  };
  await until("the spike, in the middle, is higher than the steps beside it", async () => {
    const picture = await pixels();
    const [middle, beside] = [777, 677].map((x) => height(picture, x));
    return beside > 0 && middle > beside + 15;
  });
});
