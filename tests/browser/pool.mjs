// A measurement without bounds: long work in the page alone and by two workers, interleaved, and the
// longest gap of the main thread meanwhile. The smallest of several times counts, since other
// programs take time, too.
//
//   node tests/browser/pool.mjs [--frames 6000] [--pairs 16] [--rounds 3] [--workers 2]

import process from "node:process";
import { parseArgs } from "node:util";
import { striding } from "./help.mjs";
import { close, openSegue } from "./segue.mjs";

const { values } = parseArgs({
  options: {
    frames: { type: "string", default: "6000" }, pairs: { type: "string", default: "16" },
    rounds: { type: "string", default: "3" }, workers: { type: "string", default: "2" },
  },
});
const [frames, pairs, rounds] = [values.frames, values.pairs, values.rounds].map(Number);
const VARIANTS = { "in the page": "off", [`${values.workers} workers`]: values.workers };
const times = {};

try {
  const pages = {};
  for (const [name, pool] of Object.entries(VARIANTS)) pages[name] = await prepared(pool);
  for (let round = 0; round < rounds; round++) {
    for (const [name, { opened, clips }] of Object.entries(pages)) {
      const note = (what, { seconds, gap }) => {
        const found = ((times[what] ??= {})[name] ??= { seconds: [], gap: [] });
        found.seconds.push(seconds);
        found.gap.push(gap);
      };
      await timed(opened, { lab: "view" });
      // In another order each time, so that nothing is known.
      const turned = [...clips.slice(round % clips.length), ...clips.slice(0, round % clips.length)];
      note(`matrix of ${frames} frames`, await timed(opened, { lab: "graph", clips: turned.join(","), walk_seconds: 10, blend_window: 30 }));
      note("a new window", await timed(opened, { blend_window: 28 - round }));
      note("a new threshold", await timed(opened, { edge_threshold: 20 + round }));
    }
  }
  for (let round = 0; round < rounds; round++) {
    for (const [name, { opened, longs }] of Object.entries(pages)) {
      const found = ((times[`${pairs} registrations of 1,500²`] ??= {})[name] ??= { seconds: [], gap: [] });
      let [seconds, gap] = [0, 0];
      // As many as fit are registered at once.
      for (let from = 0; from < pairs; from += 4) {
        const b = longs[1 + ((from / 4 + round) % (longs.length - 1))];
        const also = longs.filter((id) => id !== b && id !== longs[0]).slice(0, 3).map((id) => `0.2:${id}`).join(",");
        await timed(opened, { lab: "view" });
        const made = await timed(opened, { lab: "register", a: longs[0], b, warp_also: also, registration_window: 5 + 2 * (from / 4) + round });
        [seconds, gap] = [seconds + made.seconds, Math.max(gap, made.gap)];
      }
      found.seconds.push(seconds);
      found.gap.push(gap);
    }
  }
} finally {
  await close();
}
const [alone, shared] = Object.keys(VARIANTS);
const least = (list) => Math.min(...list);
console.table(Object.fromEntries(Object.entries(times).map(([what, of]) => [what, {
  [`${alone}, s`]: Number(least(of[alone].seconds).toFixed(2)),
  [`${shared}, s`]: Number(least(of[shared].seconds).toFixed(2)),
  times: Number((least(of[alone].seconds) / least(of[shared].seconds)).toFixed(2)),
  [`gap ${alone}, ms`]: Number(least(of[alone].gap).toFixed(1)),
  [`gap ${shared}, ms`]: Number(least(of[shared].gap).toFixed(1)),
}])));
process.exit();

/** Opens a page with the clips of both measurements. */
async function prepared(pool) {
  const opened = await openSegue("webgl2", `lab=view&play=off&pool=${pool}`, { viewport: [640, 480] });
  const [clips, longs] = [[], []];
  for (let i = 0; i < 6; i++) clips.push((await opened.load(`clip${i}.bvh`, striding({ frames: frames / 6, hertz: 0.8 + 0.1 * i, swing: 25 + 3 * i }))).clips[0].id);
  for (let i = 0; i < 5; i++) longs.push((await opened.load(`long${i}.bvh`, striding({ frames: 1500, hertz: 0.9 + 0.1 * i, swing: 30 + 2 * i }))).clips[0].id);
  await opened.page.waitForTimeout(2000);
  return { opened, clips, longs };
}

/**
 * Returns the time of a change until its work is complete, seconds, and the longest gap between two
 * turns of the page, milliseconds.
 */
function timed({ page }, change) {
  return page.evaluate(async (change) => {
    const pause = (ms) => new Promise((done) => setTimeout(done, ms));
    let [gap, last] = [0, performance.now()];
    const watch = setInterval(() => {
      const now = performance.now();
      gap = Math.max(gap, now - last - 4);
      last = now;
    }, 4);
    const start = performance.now();
    await window.segue.set(change);
    while ((await window.segue.stats()).jobs.length) await pause(2);
    const seconds = (performance.now() - start) / 1e3;
    clearInterval(watch);
    return { seconds, gap };
  }, change);
}
