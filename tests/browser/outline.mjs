// A measurement without bounds: the cost of the elements for screen readers, and of a frame. Pages
// with and without them take turns and play three panes: then panels stand still (src/ui/still.rs),
// and the page is told of its elements once in 61 frames. "In the page" is the time of web/js/outline.js, with the
// layout that it causes; the other cost is the difference between the frames of both pages.
// "Frame" is what the page's thread computes in its callback for a frame, the elements among it,
// and "all" everything that it computes for a frame, that of the browser too: both by the thread's
// own clock, which stands still while others have the processor. A page of another build, served
// at an address of its own, takes turns with them.
//
//   node tests/browser/outline.mjs [--size 1280x800] [--frames 240] [--rounds 3] [--other ADDRESS]

import process from "node:process";
import { parseArgs } from "node:util";
import { computingTime } from "./help.mjs";
import { BACKENDS, close, launch, openSegue } from "./segue.mjs";

const { values } = parseArgs({
  options: { size: { type: "string", default: "1280x800" }, frames: { type: "string", default: "240" }, rounds: { type: "string", default: "3" }, other: { type: "string" } },
});
const viewport = values.size.split("x").map(Number);
const [frames, rounds] = [values.frames, values.rounds].map(Number);
/** The kinds of pages: whether they have the elements, and their address where they are not of this build. */
const PAGES = { with: { has: true }, without: { has: false }, ...(values.other && { other: { has: true, base: values.other } }) };
/** Callbacks that take less time have drawn nothing, milliseconds. */
const LEAST_MS = 0.8;
const UPDATE = "this.#update(JSON.parse(text))";
const rows = {};

try {
  for (const backend of BACKENDS) {
    for (let round = 1; round <= rounds; round++) {
      for (const [name, kind] of Object.entries(PAGES)) rows[`${backend} ${name} ${round}`] = await measure(backend, kind);
    }
  }
} finally {
  await close();
}
console.table(rows);
process.exit();

async function measure(backend, { has, base }) {
  const prepare = base ? undefined : (page) => page.route("**/outline*.js", async (route) => {
    if (!has) return route.abort();
    const response = await route.fetch();
    const source = await response.text();
    if (!source.includes(UPDATE)) throw new Error(`outline.js has no ${UPDATE}`);
    const timed = `{ const began = performance.now(); ${UPDATE}; this.#root.getBoundingClientRect(); (window.outlineTimes ??= []).push(performance.now() - began); }`;
    return route.fulfill({ response, body: source.replace(UPDATE, timed) });
  });
  const { page, segue } = await openSegue(backend, "compare=blend_window:30,15,10", { viewport, prepare, base });
  await drawn(page, segue, 30); // those of the start
  const [computed, callbacks] = [await computingTime(page), await frameCallbacks(backend)];
  const found = await drawn(page, segue, frames);
  const [all, inFrame] = [(1000 * (await computed())) / found, await callbacks()];
  const inPage = await page.evaluate(() => (window.outlineTimes ?? []).slice(-240));
  await page.context().close();
  const row = { "all, mean ms": all };
  for (const [name, times] of [["frame", inFrame], ["in the page", inPage]]) {
    for (const percent of [50, 95]) row[`${name} p${percent}`] = part(times, percent / 100);
  }
  return Object.fromEntries([...Object.entries(row).map(([name, number]) => [name, Number(number.toFixed(2))]), ["updates", inPage.length], ["frames", found]]);
}

/**
 * Starts to measure the callbacks for frames in all pages of a browser. Returns a function that
 * ends it and returns the time of each that has drawn, in milliseconds of its thread's own clock.
 */
async function frameCallbacks(backend) {
  const session = await (await launch(backend)).newBrowserCDPSession();
  const events = [];
  session.on("Tracing.dataCollected", ({ value }) => events.push(...value));
  const complete = new Promise((resolve) => session.once("Tracing.tracingComplete", resolve));
  await session.send("Tracing.start", { transferMode: "ReportEvents", traceConfig: { includedCategories: ["devtools.timeline"], excludedCategories: ["*"] } });
  return async () => {
    await session.send("Tracing.end");
    await complete;
    await session.detach();
    const callbacks = events.filter(({ name, ph }) => name === "FireAnimationFrame" && ph === "X");
    return callbacks.map(({ tdur }) => tdur / 1000).filter((ms) => ms > LEAST_MS);
  };
}

/** Waits until as many more frames are drawn, and returns how many were. */
async function drawn(page, segue, count) {
  const start = (await segue("stats")).frames;
  for (;;) {
    await page.waitForTimeout(1000);
    const now = (await segue("stats")).frames - start;
    if (now >= count) return now;
  }
}

function part(times, share) {
  const sorted = [...times].sort((a, b) => a - b);
  return sorted.length === 0 ? NaN : sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
}
