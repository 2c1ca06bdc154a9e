// A measurement without bounds: a long clip in one lab after the other. "Result" is the time until
// the result is there, at most the limit; "longest" are the longest tasks of the page's thread, and
// "all" is what it computes in all, by its own clock. The clip is Segue's walk again and again. A
// page of another build, served at an address of its own, is measured beside it.
//
//   node tests/browser/long.mjs [--frames 67200] [--backend webgpu] [--limit 25] [--other ADDRESS]

import process from "node:process";
import { parseArgs } from "node:util";
import { tracedTasks, until } from "./help.mjs";
import { close, dropPrepared, endBrowser, openSegue } from "./segue.mjs";

const { values } = parseArgs({
  options: { frames: { type: "string", default: "67200" }, backend: { type: "string", default: "webgpu" }, limit: { type: "string", default: "25" }, other: { type: "string" } },
});

/** What is measured, and the parameters that are set for it; `long` is the long clip. */
const STEPS = {
  "feet held": { lab: "view", a: "long", foot_lock: true },
  "feet held otherwise": { lock_blend: 0.4 },
  "contacts read anew": { foot_lock: false, contact_height: 6 },
  loop: { lab: "loop", a: "long" },
  clean: { lab: "clean", a: "long" },
  match: { lab: "match", match_clips: "long" },
  register: { lab: "register", a: "long", b: "walk" },
  speed: { lab: "speed", a: "long", b: "run" },
  in_place: { lab: "in_place", a: "long" },
  edit: { lab: "edit", a: "long" },
  path: { lab: "path", a: "long" },
  blend: { lab: "blend", a: "long", b: "walk" },
  transition: { lab: "transition", a: "long", b: "walk" },
  layers: { lab: "layers", a: "long", b: "walk" },
};

const rows = {};
try {
  for (const [name, base] of Object.entries({ here: undefined, ...(values.other && { other: values.other }) })) {
    let opened = await open(base);
    rows[`${name}: load`] = opened.row;
    for (const [step, parameters] of Object.entries(STEPS)) {
      rows[`${name}: ${step}`] = await measured(opened.page, () => set(opened.page, parameters, opened.id));
      // A page that does not answer is left behind.
      if (rows[`${name}: ${step}`].result === "–") {
        await endBrowser(values.backend).catch((reason) => console.log(reason.message));
        opened = await open(base);
      }
    }
    await opened.page.context().close();
  }
} finally {
  console.table(rows);
  await close();
}
process.exit();

/** Opens a page, and loads the long clip into it. */
async function open(base) {
  const { page, segue } = await openSegue(values.backend, "lab=view&play=off", { viewport: [640, 480], scale: 0.5, base });
  const once = (await segue("export", "walk", "bvh")).toString();
  await page.evaluate(([once, frames]) => {
    const [, head, time, rows] = /^([^]*)Frames: .*\n(.*)\n([^]*)$/.exec(once);
    const times = Math.ceil(frames / rows.trim().split("\n").length);
    const all = times * rows.trim().split("\n").length;
    window.toDrop = [new File([`${head}Frames: ${all}\n${time}\n${rows.repeat(times)}`], "long.bvh")];
  }, [once, Number(values.frames)]);
  let id;
  const row = await measured(page, async () => {
    await dropPrepared(page);
    id = await until("the long clip is there", async () => (await segue("clips")).find(({ name }) => name === "long")?.id);
  });
  return { page, id, row };
}

/** Sets parameters, and waits for the result. */
function set(page, parameters, id) {
  const own = Object.entries(parameters).map(([key, value]) => [key, value === "long" ? id : value]);
  return page.evaluate((own) => window.segue.set(own), Object.fromEntries(own)).catch((reason) => console.log(reason.message));
}

async function measured(page, body) {
  const ended = await tracedTasks(page);
  const began = Date.now();
  const limit = new Promise((resolve) => setTimeout(() => resolve(true), Number(values.limit) * 1000));
  const isLate = await Promise.race([body().then(() => false), limit]);
  const result = (Date.now() - began) / 1000;
  await page.waitForTimeout(1500);
  const times = await ended();
  const [longest, second] = times.map((ms) => Number(ms.toFixed(1)));
  return { result: isLate ? "–" : result.toFixed(2), longest, second, "over 16 ms": times.filter((ms) => ms > 16).length, all: Math.round(times.reduce((sum, ms) => sum + ms, 0)) };
}
