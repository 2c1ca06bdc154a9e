// A measurement without bounds: the cost of the elements for screen readers. Pages with and without
// them take turns and play three panes. "In the page" is the time of web/js/outline.js, with the
// layout that it causes; the other cost is the difference between the frames of both pages. "All"
// is what the page's thread computes for a frame by its own clock: the app, the elements, and the
// browser. A page of another build, served at an address of its own, takes turns with them.
//
//   node tests/browser/outline.mjs [--size 1280x800] [--frames 240] [--rounds 3] [--other ADDRESS]

import process from "node:process";
import { parseArgs } from "node:util";
import { computingTime } from "./help.mjs";
import { BACKENDS, close, openSegue } from "./segue.mjs";

const { values } = parseArgs({
  options: { size: { type: "string", default: "1280x800" }, frames: { type: "string", default: "240" }, rounds: { type: "string", default: "3" }, other: { type: "string" } },
});
const viewport = values.size.split("x").map(Number);
const [frames, rounds] = [values.frames, values.rounds].map(Number);
/** The kinds of pages: whether they have the elements, and their address where they are not of this build. */
const PAGES = { with: { has: true }, without: { has: false }, ...(values.other && { other: { has: true, base: values.other } }) };
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
  const computed = await computingTime(page);
  const found = await drawn(page, segue, frames);
  const all = (1000 * (await computed())) / found;
  const playing = await segue("stats");
  const inPage = await page.evaluate(() => (window.outlineTimes ?? []).slice(-240));
  await page.context().close();
  const row = { "all, mean ms": all, "p50 ms": playing.frame_ms.p50, "p95 ms": playing.frame_ms.p95 };
  for (const [name, share] of [["in the page p50", 0.5], ["in the page p95", 0.95]]) row[name] = part(inPage, share);
  return Object.fromEntries([...Object.entries(row).map(([name, number]) => [name, Number(number.toFixed(2))]), ["updates", inPage.length], ["frames", found]]);
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
