// A measurement without bounds: the time until a page is ready (start.mjs measures its first frame,
// too), the duration of frames while three panes play, and the time until a change is complete, in
// Blend and Path for clips of 3,000 frames, in Register for two of 1,500, all of 31 joints. On both
// backends.
//
//   node tests/browser/measure.mjs [--size 1440x900] [--seconds 60]
//
// stats() has the last 240 frames, which is a minute of drawing in software. The start does not
// count there; it has a row of its own.

import process from "node:process";
import { parseArgs } from "node:util";
import { striding } from "./help.mjs";
import { BACKENDS, close, openSegue } from "./segue.mjs";

const { values } = parseArgs({ options: { size: { type: "string", default: "1440x900" }, seconds: { type: "string", default: "60" } } });
const viewport = values.size.split("x").map(Number);
const millis = (number) => Number(number.toFixed(1));
/** Two paths that differ in one of their twelve points by half a step. */
const ROADS = ["AAwCAQHgAwDEBwCkCwCkCwCkCwqmCwmkCwCkCwCkCwDEBwDgAw", "AAwCAQHgAwDEBwCkCwCkCwCkC1CmC0-kCwCkCwCkCwDEBwDgAw"];
const rows = {};

try {
  for (const backend of BACKENDS) rows[backend] = await measure(backend);
} finally {
  await close();
}
console.table(rows);
process.exit();

async function measure(backend) {
  const cold = await openSegue(backend, "compare=blend_window:30,15,10", { viewport, prepare: noteReady });
  const firstMs = await cold.page.evaluate(() => window.readyMs);
  const warm = await reopened(cold);
  const start = await cold.segue("stats");
  await cold.page.waitForTimeout(1000 * Number(values.seconds));
  const playing = await cold.segue("stats");
  await cold.page.context().close();

  const long = await openSegue(backend, "lab=blend&play=off", { viewport });
  const [a, b] = [await long.load("a.bvh", striding({ frames: 3000, hertz: 0.9 })), await long.load("b.bvh", striding({ frames: 3000, hertz: 1.6, swing: 40 }))];
  await long.segue("set", { a: a.clips[0].id, b: b.clips[0].id, leave_a: 20, enter_b: 5 });
  // The work of a drag: one value after the other, each awaited, without the slow drawing in
  // software.
  const set = await changes(long, range(40, (i) => ({ blend_window: 10 + 5 * i })));
  await long.segue("set", { leave_a: "auto", enter_b: "auto" });
  const search = await changes(long, [{ blend_window: 61 }]);
  await long.segue("set", { lab: "path" });
  const path = await changes(long, range(40, (i) => ({ path: ROADS[i % 2] })));
  await long.page.context().close();

  const pair = await openSegue(backend, "lab=register&play=off", { viewport });
  const [c, d] = [await pair.load("c.bvh", striding({ frames: 1500, hertz: 0.9 })), await pair.load("d.bvh", striding({ frames: 1500, hertz: 1.1, swing: 40 }))];
  // In software, the start takes seconds; it is measured above.
  await pair.page.waitForTimeout(5000);
  const [first, again] = [[c, d], [d, c]].map(([from, to]) => ({ a: from.clips[0].id, b: to.clips[0].id }));
  const register = [...await changes(pair, [first]), ...await changes(pair, [again])];
  const windows = await changes(pair, range(20, (i) => ({ registration_window: 7 + 2 * i })));
  const slopes = [];
  for (const window of [9, 11, 13, 15]) {
    await changes(pair, [{ registration_window: window, slope_limit: 2 }]);
    slopes.push(...await changes(pair, [3, 4, 5].map((slope_limit) => ({ slope_limit }))));
  }
  await pair.page.context().close();
  return {
    "ready ms": millis(firstMs),
    "again ms": millis(warm),
    "frames/s, 3 panes": millis((playing.frames - start.frames) / Number(values.seconds)),
    "p50 ms": millis(playing.frame_ms.p50),
    "p95 ms": millis(playing.frame_ms.p95),
    "drawing p95 ms": millis(playing.draw_ms.p95),
    "wasm MB": millis(playing.wasm_bytes / 1e6),
    "set p50, max ms": middleAndMost(set),
    "match anew ms": millis(search[0]),
    "road p50, max ms": middleAndMost(path),
    "register, again ms": register.map(millis).join(", "),
    "window p50, max ms": middleAndMost(windows),
    "slope p50, max ms": middleAndMost(slopes),
  };
}

/** Returns the time of each change until its work is complete, milliseconds. */
function changes({ page }, values) {
  return page.evaluate(async (values) => {
    const segue = await window.segueReady;
    const took = [];
    for (const value of values) {
      const start = performance.now();
      await segue.set(value);
      while ((await segue.stats()).jobs.length) await new Promise((done) => setTimeout(done, 1));
      took.push(performance.now() - start);
    }
    return took;
  }, values);
}

function range(count, value) {
  return Array.from({ length: count }, (_, i) => value(i));
}

function middleAndMost(took) {
  const sorted = took.toSorted((x, y) => x - y);
  return `${millis(sorted[sorted.length >> 1])}, ${millis(sorted.at(-1))}`;
}

/** Opens the page again in the same browser, with its files in the cache. */
async function reopened({ page, ready }) {
  await page.reload({ waitUntil: "commit" });
  await ready();
  return page.evaluate(() => window.readyMs);
}

/**
 * Notes the time until `segueReady` settles. The clock of the page begins with the navigation.
 */
function noteReady(page) {
  return page.addInitScript(() => document.addEventListener("DOMContentLoaded", () => {
    window.segueReady?.then(() => { window.readyMs = performance.now(); });
  }));
}
