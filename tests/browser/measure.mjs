// Measures, and judges nothing: how soon the page shows its first frame, how long frames take while three panes play,
// and how long they take while a slider is dragged over two clips of 3,000 frames and 31 joints. On both backends.
//   node tests/browser/measure.mjs [--size 1440x900] [--seconds 5]

import process from "node:process";
import { parseArgs } from "node:util";
import { striding } from "./help.mjs";
import { BACKENDS, close, openSegue } from "./segue.mjs";

const { values } = parseArgs({ options: { size: { type: "string", default: "1440x900" }, seconds: { type: "string", default: "5" } } });
const viewport = values.size.split("x").map(Number);
const millis = (number) => Number(number.toFixed(1));
const rows = {};

try {
  for (const backend of BACKENDS) rows[backend] = await measure(backend);
} finally {
  await close();
}
console.table(rows);
process.exit();

async function measure(backend) {
  const cold = await openSegue(backend, "compare=blend_window:30,15,10", { viewport, prepare: noteFirstFrame });
  const firstFrame = await cold.page.evaluate(() => window.firstFrame);
  const warm = await reopened(cold);
  const start = await cold.segue("stats");
  await cold.page.waitForTimeout(1000 * Number(values.seconds));
  const playing = await cold.segue("stats");
  await cold.page.context().close();

  const long = await openSegue(backend, "lab=blend&play=off", { viewport });
  const [a, b] = [await long.load("a.bvh", striding({ frames: 3000, hertz: 0.9 })), await long.load("b.bvh", striding({ frames: 3000, hertz: 1.6, swing: 40 }))];
  await long.segue("set", { a: a.clips[0].id, b: b.clips[0].id, leave_a: 20, enter_b: 5 });
  // The same work that a drag causes: one value after the other, each awaited, without the drawing that software rendering makes slow.
  const set = await long.page.evaluate(async () => {
    const took = [];
    for (let frames = 10; frames < 210; frames += 5) {
      const start = performance.now();
      await window.segue.set({ blend_window: frames });
      took.push(performance.now() - start);
    }
    return took.toSorted((x, y) => x - y);
  });
  await long.segue("set", { leave_a: "auto", enter_b: "auto" });
  const search = await long.page.evaluate(async () => {
    const start = performance.now();
    await window.segue.set({ blend_window: 61 });
    return performance.now() - start;
  });
  await long.page.context().close();
  return {
    "first frame ms": millis(firstFrame),
    "again ms": millis(warm),
    "frames/s, 3 panes": millis((playing.frames - start.frames) / Number(values.seconds)),
    "p50 ms": millis(playing.frame_ms.p50),
    "p95 ms": millis(playing.frame_ms.p95),
    "drawing p95 ms": millis(playing.draw_ms.p95),
    "wasm MB": millis(playing.wasm_bytes / 1e6),
    "set p50 ms": millis(set[set.length >> 1]),
    "set max ms": millis(set.at(-1)),
    "match anew ms": millis(search),
  };
}

/** The same page again in the same browser, its files in the cache. */
async function reopened({ page, ready }) {
  await page.reload({ waitUntil: "commit" });
  await ready();
  return page.evaluate(() => window.firstFrame);
}

/** `segueReady` settles with the first frame, and the clock of the page begins with the navigation. */
function noteFirstFrame(page) {
  return page.addInitScript(() => document.addEventListener("DOMContentLoaded", () => {
    window.segueReady?.then(() => { window.firstFrame = performance.now(); });
  }));
}
