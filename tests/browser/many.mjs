// Measures the page with a large library: `node tests/browser/many.mjs FOLDER [BACKEND]`, with a
// folder that `cargo xtask make-corpus` has written. It is dropped as a folder, and the page is
// loaded again. Prints seconds, the memory of the app, the longest gaps and tasks of the main
// thread, and the processor time of the longest task, which other programs do not lengthen.

import { readdirSync } from "node:fs";
import path from "node:path";
import process from "node:process";
import { close, openSegue } from "./segue.mjs";
import { stored, tracedTasks, until } from "./help.mjs";

const [folder, backend = "webgl2"] = process.argv.slice(2);
if (!folder) throw new Error("expected the folder of a corpus");
const WAIT_MS = 900_000;

/** Returns the files below a folder by their paths. */
const filesBelow = (at) => readdirSync(at, { withFileTypes: true, recursive: true })
  .filter((entry) => entry.isFile())
  .map((entry) => path.join(entry.parentPath, entry.name))
  .sort();

/**
 * Has the page note the longest time between two turns of its main thread, and the longest task as
 * the browser reports it.
 */
const watched = (page) => page.addInitScript(() => {
  window.gaps = { turn: 0, task: 0, long: 0 };
  let last = performance.now();
  const channel = new MessageChannel();
  channel.port1.onmessage = () => {
    const now = performance.now();
    window.gaps.turn = Math.max(window.gaps.turn, now - last);
    last = now;
    setTimeout(() => channel.port2.postMessage(null), 4);
  };
  channel.port2.postMessage(null);
  new PerformanceObserver((list) => {
    for (const { duration } of list.getEntries()) {
      window.gaps.task = Math.max(window.gaps.task, duration);
      window.gaps.long += duration > 100;
    }
  }).observe({ type: "longtask", buffered: true });
});

const gapsOf = (page) => page.evaluate(() => {
  const gaps = { ...window.gaps };
  Object.assign(window.gaps, { turn: 0, task: 0, long: 0 });
  return gaps;
});

const row = (what, seconds, { turn, task, long }, bytes) => ({
  what, "s": seconds.toFixed(2), "wasm MB": Math.round(bytes / 1e6), "longest gap ms": Math.round(turn), "longest task ms": Math.round(task), "tasks over 100 ms": long,
});

/** Drops the chosen files of an input as one folder. */
const dropChosen = (page, name) => page.evaluate(async (name) => {
  const files = [...document.getElementById("corpus").files].map((file) => ({
    isFile: true, isDirectory: false, name: file.name, fullPath: `/${name}/${file.name}`, file: (resolve) => resolve(file),
  }));
  const parts = [files, []];
  const whole = { isFile: false, isDirectory: true, name, fullPath: `/${name}`, createReader: () => ({ readEntries: (resolve) => resolve(parts.shift()) }) };
  DataTransferItem.prototype.webkitGetAsEntry = () => whole;
  const dataTransfer = new DataTransfer();
  dataTransfer.items.add(new File([], name));
  const canvas = document.getElementById("segue");
  for (const type of ["dragenter", "dragover", "dragover", "drop"]) {
    canvas.dispatchEvent(new DragEvent(type, { bubbles: true, cancelable: true, composed: true, clientX: 400, clientY: 300, dataTransfer }));
    await new Promise((resolve) => requestAnimationFrame(resolve));
  }
}, name);

const rows = [];
try {
  const files = filesBelow(folder);
  const { page, segue, ready } = await openSegue(backend, "lab=view&a=walk&play=off", { prepare: watched });
  await segue("set", {});
  await page.evaluate(() => document.body.append(Object.assign(document.createElement("input"), { type: "file", multiple: true, id: "corpus", hidden: true })));
  await page.setInputFiles("#corpus", files);
  await gapsOf(page);
  const ended = await tracedTasks(page);
  let began = Date.now();
  await dropChosen(page, path.basename(folder));
  const isReading = async () => (await segue("stats")).jobs.some(({ name }) => name === "files");
  await until("the files are being read", isReading, WAIT_MS);
  await until("all files are read", async () => !(await isReading()), WAIT_MS);
  const seconds = (Date.now() - began) / 1000;
  const gaps = await gapsOf(page);
  rows.push(row(`${files.length} files dropped`, seconds, gaps, (await segue("stats")).wasm_bytes));
  const own = async () => (await segue("clips")).filter(({ sha256 }) => sha256).length;
  const listed = await own();
  console.log(`${listed} clips of ${files.length} files`);
  await gapsOf(page);
  await until("all is stored", async () => (await stored(page)).files.length === files.length, WAIT_MS);
  rows.push(row("… and stored", (Date.now() - began) / 1000, await gapsOf(page), (await segue("stats")).wasm_bytes));
  const times = await ended();
  const top = times.slice(0, 8).map((ms) => ms.toFixed(0)).join(", ");
  const all = times.reduce((sum, ms) => sum + ms, 0) / 1000;
  console.log(`main thread: ${all.toFixed(1)} s of processor time, the longest tasks ${top} ms, ${times.filter((ms) => ms > 50).length} over 50 ms`);

  began = Date.now();
  await page.reload({ waitUntil: "commit" });
  await ready();
  const whole = await page.evaluate(async (listed) => {
    const segue = await window.segueReady;
    const shown = performance.now();
    while (segue.clips().filter(({ sha256 }) => sha256).length < listed) await new Promise((resolve) => setTimeout(resolve, 20));
    return { shown: shown / 1000, listed: performance.now() / 1000 };
  }, listed);
  rows.push(row(`reload: page ready after ${whole.shown.toFixed(2)} s, list whole`, whole.listed, await gapsOf(page), (await segue("stats")).wasm_bytes));
  const [last] = (await segue("clips")).filter(({ sha256 }) => sha256).slice(-1);
  began = Date.now();
  await segue("set", { a: last.id });
  await segue("metrics");
  rows.push(row("a clip is used and read", (Date.now() - began) / 1000, await gapsOf(page), (await segue("stats")).wasm_bytes));
} finally {
  console.table(rows);
  await close();
}
