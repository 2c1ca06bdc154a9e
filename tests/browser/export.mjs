// A measurement without bounds: saving a long clip in each format, and on a character of another
// rig. "Longest" is the longest time in which the page does nothing else, while a worker writes the
// file; "all" is the time until the file is there. A page of another build, served at an address of
// its own, is measured beside it.
//
//   node tests/browser/export.mjs [--frames 30000] [--rounds 2] [--other ADDRESS]

import process from "node:process";
import { parseArgs } from "node:util";
import { striding } from "./help.mjs";
import { close, openSegue } from "./segue.mjs";

const { values } = parseArgs({ options: { frames: { type: "string", default: "30000" }, rounds: { type: "string", default: "2" }, other: { type: "string" } } });
const bytes = striding({ frames: Number(values.frames), swing: 33 });
const rows = {};

try {
  for (const [name, base] of Object.entries({ here: undefined, ...(values.other && { other: values.other }) })) {
    const { page, segue, load } = await openSegue("webgl2", "lab=view&play=off", { viewport: [640, 480], base });
    const { clips: [clip] } = await load("long.bvh", bytes);
    // The picture is drawn finely once nothing changes.
    await page.waitForTimeout(5000);
    for (let round = 1; round <= Number(values.rounds); round++) {
      for (const format of ["bvh", "csv", "fbx", "glb"]) rows[`${name} ${format} ${round}`] = await measure(page, clip.id, format);
    }
    const { clips: [figure] } = await load("figure.glb", otherBody(await segue("export", "walk", "glb")));
    await segue("set", { character: figure.id });
    // For the stage, the motion is retargeted in slices.
    await page.waitForTimeout(20_000);
    for (let round = 1; round <= Number(values.rounds); round++) rows[`${name} character ${round}`] = await measure(page, clip.id, "glb");
    await page.context().close();
  }
} finally {
  await close();
}
console.table(rows);
process.exit();

/** Returns a GLB of Segue as one of another program: the body of Segue's own is left out. */
function otherBody(bytes) {
  bytes.write("Other", bytes.indexOf("Segue "), "latin1");
  return bytes;
}

/** Exports a clip, and returns the times in milliseconds and the size in megabytes. */
async function measure(page, id, format) {
  const found = await page.evaluate(async ([id, format]) => {
    const { port1, port2 } = new MessageChannel();
    let [longest, last, goesOn] = [0, performance.now(), true];
    port1.onmessage = () => {
      const now = performance.now();
      [longest, last] = [Math.max(longest, now - last), now];
      if (goesOn) port2.postMessage(0);
    };
    port2.postMessage(0);
    await new Promise((resolve) => setTimeout(resolve, 100));
    const began = performance.now();
    [longest, last] = [0, began];
    const file = await window.segue.export(id, format);
    const all = performance.now() - began;
    await new Promise((resolve) => setTimeout(resolve, 50));
    goesOn = false;
    return { longest, all, megabytes: file.length / 1e6 };
  }, [id, format]);
  return Object.fromEntries(Object.entries(found).map(([name, number]) => [name, Number(number.toFixed(1))]));
}
