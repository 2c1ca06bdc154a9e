// Measures the panel of a large corpus: `node tests/browser/corpus.mjs FOLDER [BACKEND]`, with a
// folder that `cargo xtask make-large-corpus 100000 FOLDER` has written, on a server that answers after
// `--after` milliseconds. Prints seconds and bytes, and the longest task of the page's thread. It
// fails where the table takes more than 2 s, a search more than 0.5 s (both without the time of
// requests), or what is read for them is more than 3 MB.

import process from "node:process";
import { parseArgs } from "node:util";
import { corpusServer } from "./corpus_server.mjs";
import { close, openSegue } from "./segue.mjs";
import { until } from "./help.mjs";

const { values, positionals } = parseArgs({ allowPositionals: true, options: { after: { type: "string", default: "0" }, backend: { type: "string", default: "webgpu" } } });
const [folder] = positionals;
if (!folder) throw new Error("expected the folder of a corpus");
const LIMITS = { table: 2, search: 0.5, bytes: 3e6 };

/** Has the page note the long tasks of its thread, and how many times the map was drawn. */
const watched = (page) => page.addInitScript(() => {
  [window.tasks, window.lastTask, window.mapsDrawn] = [[], 0, 0];
  new PerformanceObserver((list) => {
    window.tasks.push(...list.getEntries().map(({ duration }) => duration));
    window.lastTask = performance.now();
  }).observe({ type: "longtask", buffered: true });
  // Reading the pixels back would take longer than to draw them.
  const { putImageData } = CanvasRenderingContext2D.prototype;
  CanvasRenderingContext2D.prototype.putImageData = function (...args) {
    putImageData.apply(this, args);
    if (this.canvas.closest("#corpus .map")) window.mapsDrawn++;
  };
});

const rows = [];
const note = (what, seconds, more = {}) => rows.push({ what, s: Number(seconds.toFixed(3)), ...more });

await corpusServer(folder, { after: Number(values.after) }, async (address, asked) => {
  const { page, segue, log, problems } = await openSegue(values.backend, "lab=view&play=off", { viewport: [1440, 900], prepare: watched });
  await segue("loaded");
  /** Waits until nothing has been asked for, and no task was long, for a second. */
  const rest = async () => {
    let [before, since] = [asked.length, Date.now()];
    await until("the page rests", async () => {
      if (asked.length !== before) [before, since] = [asked.length, Date.now()];
      return Date.now() - since > 1000 && (await page.evaluate(() => performance.now() - window.lastTask > 1000));
    });
  };
  // In software, the start takes seconds.
  await rest();
  const filled = () => [...document.querySelectorAll("#corpus .row b")].filter((title) => title.textContent).length > 5;
  /** Returns the seconds from an action until a condition holds, by the page's own clock. */
  const timed = (act, test) => page.evaluate(`(async () => {
    window.tasks = [];
    const start = performance.now();
    ${act};
    while (!(${test})) await new Promise((resolve) => setTimeout(resolve, 2));
    const seconds = (performance.now() - start) / 1e3;
    // The browser lays out and paints after the condition holds, and reports long tasks later.
    await new Promise((resolve) => setTimeout(resolve, 200));
    return seconds;
  })()`);
  const longest = () => page.evaluate(() => Math.round(Math.max(0, ...window.tasks)));
  const bytesOf = (requests) => requests.reduce((sum, { bytes }) => sum + bytes, 0);

  // The files that the table and a search need; each is requested once.
  const needed = () => asked.filter(({ name }) => !/^(thumbnails|poses)/.test(name));
  const table = await timed(`window.segue.set({ corpus: ${JSON.stringify(address)} })`, `(${filled})()`);
  note("table, modules not loaded yet", table, { bytes: bytesOf(needed().filter(({ name }) => !name.startsWith("index"))), "longest task ms": await longest() });
  // The index comes after the table.
  await until("the index is asked for", () => asked.some(({ name }) => name.startsWith("index")));
  await rest();
  await page.evaluate(() => window.segue.set({ corpus: "" }));
  await until("it is closed", () => page.evaluate(() => !document.getElementById("corpus")));

  const hits = `document.querySelector("#corpus .count b") && (${filled})()`;
  note("table again, worker kept", await timed(`window.segue.set({ corpus: ${JSON.stringify(address)} })`, `(${filled})()`));
  const press = `[...document.querySelectorAll("#corpus .dock .actions button")][0].click()`;
  const first = await timed(press, hits);
  const bytes = bytesOf(needed());
  note("first search, from the stage", first, { bytes: bytesOf(needed().filter(({ name }) => name.startsWith("index"))), "longest task ms": await longest() });
  const goBack = async () => {
    await page.evaluate(() => document.querySelector("#corpus .count .back").click());
    await until("all clips are there", () => page.evaluate(`!document.querySelector("#corpus .count b") && (${filled})()`));
  };
  for (const at of [0.4, 0.8]) {
    await goBack();
    await page.evaluate((at) => window.segue.seek(at), at);
    note(`search at ${at} s`, await timed(press, hits), { "longest task ms": await longest() });
  }
  await goBack();
  const count = () => page.evaluate(() => document.querySelector("#corpus .grid").ariaRowCount);
  const all = await count();
  const type = (text) => `{ const field = document.querySelector("#corpus input[type=search]"); field.value = ${JSON.stringify(text)}; field.dispatchEvent(new Event("input")); }`;
  note("search for a name", await timed(type("walk 01"), `document.querySelector("#corpus .grid").ariaRowCount !== ${JSON.stringify(all)}`));
  await timed(type(""), `document.querySelector("#corpus .grid").ariaRowCount === ${JSON.stringify(all)}`);
  const drawn = `[...document.querySelectorAll("#corpus .chip small")].some((each) => each.textContent)`;
  note("filters with all histograms", await timed(`document.querySelector("#corpus .tools button").click()`, drawn), { "longest task ms": await longest() });
  note("map", await timed(`[...document.querySelectorAll("#corpus header [role=radio]")][1].click()`, "window.mapsDrawn"), { "longest task ms": await longest() });
  await page.evaluate(() => [...document.querySelectorAll("#corpus header [role=radio]")][0].click());
  await until("the table is there again", () => page.evaluate(filled));
  const clips = JSON.stringify((await segue("clips")).length);
  note("click until the clip is on the stage", await timed(`document.querySelector("#corpus .row").click()`, `window.segue.clips().length > ${clips} && document.querySelector("#corpus .row[aria-current]")`));
  console.table(rows);
  console.log(`${all - 1} clips; corpus.json, columns, centroids and the lists of one search: ${(bytes / 1e6).toFixed(2)} MB`);
  for (const line of [...problems, ...log.filter((line) => line.startsWith("error"))]) console.error(line);
  const isWithin = table <= LIMITS.table && first <= LIMITS.search && bytes <= LIMITS.bytes;
  if (!isWithin) process.exitCode = 1;
});
await close();
process.exit();
