// A measurement without bounds: the speed of reading BVH text by Segue and by three.js' BVHLoader,
// in the same page. "Reading" compares the parsers, from bytes or text to a clip. In the first run,
// the browser has not optimised the code yet. "Into the library" is the whole wait of a user:
// transfer to the worker, reading, hashing, transfer back, and analysis.
//
// With a file, the same of that file, of any format, without three.js. "Memory" is that of the
// reader's WebAssembly at its end, which has grown to the most that it needed, with its own copy of
// the file.
//
//   node tests/browser/speed.mjs [--frames 9600,60000]      frames of a body of 31 joints, some 730 bytes each
//   node tests/browser/speed.mjs --file FILE

import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import process from "node:process";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { striding } from "./help.mjs";
import { close, openSegue } from "./segue.mjs";

const { values } = parseArgs({ options: { frames: { type: "string", default: "9600,60000" }, file: { type: "string" } } });
const three = (path) => readFileSync(fileURLToPath(new URL(`node_modules/three/${path}`, import.meta.url)), "utf8");
const SCRIPTS = {
  "three.module.js": () => three("build/three.module.js"),
  "three.core.js": () => three("build/three.core.js"),
  "BVHLoader.js": () => three("examples/jsm/loaders/BVHLoader.js").replace(/from 'three'/, "from './three.module.js'"),
};

const rows = {};
try {
  const { page } = await openSegue("webgl2", "lab=view&play=off", { viewport: [640, 480], prepare: (page) => page.route("**/three/*", serve) });
  if (values.file) rows[basename(values.file)] = await chosen(page, values.file, readOne);
  else for (const frames of values.frames.split(",").map(Number)) {
    const bytes = striding({ frames });
    rows[`${(bytes.length / 1e6).toFixed(1)} MB`] = await measure(page, bytes);
  }
} finally {
  await close();
}
console.table(rows);
process.exit();

async function measure(page, bytes) {
  const folder = mkdtempSync(join(tmpdir(), "segue-speed-"));
  const file = join(folder, "speed.bvh");
  writeFileSync(file, bytes);
  try {
    return await chosen(page, file, compare);
  } finally {
    rmSync(folder, { recursive: true });
  }
}

/** Runs `read` with a file in the page's input, so that no file of this size travels as JSON. */
async function chosen(page, file, read) {
  await page.evaluate(() => document.body.append(Object.assign(document.createElement("input"), { type: "file", id: "speed", hidden: true })));
  await page.setInputFiles("#speed", file);
  return read(page);
}

function readOne(page) {
  return page.evaluate(async () => {
    const { files: [file] } = document.getElementById("speed");
    const buffer = await file.arrayBuffer();
    const setup = JSON.stringify({ options: { metres_per_unit: null, up: null, fps: null, max_bytes: 512 << 20, drop_t_pose: true }, roles: {}, skeleton_files: [] });
    const { default: init, readFile } = await import(new URL("./read/reader.js", document.querySelector("link[rel=modulepreload][href$='boot.js']").href));
    const { memory } = await init();
    const seconds = async (run) => {
      const start = performance.now();
      await run();
      return Number(((performance.now() - start) / 1e3).toFixed(2));
    };
    const reading = await seconds(() => readFile({ progress() {}, head() {}, piece() {} }, file.name, new Uint8Array(buffer), setup, "0".repeat(64)));
    const whole = await seconds(() => window.segue.load(file.name, new Uint8Array(buffer)));
    return {
      "MB": Number((file.size / 1e6).toFixed(1)),
      "reading s": reading,
      "memory MB": Number((memory.buffer.byteLength / 1e6).toFixed(1)),
      "memory, times the file": Number((memory.buffer.byteLength / file.size).toFixed(2)),
      "into the library s": whole,
    };
  });
}

function compare(page) {
  return page.evaluate(async () => {
    const input = document.getElementById("speed");
    const buffer = await input.files[0].arrayBuffer();
    input.remove();
    const { BVHLoader } = await import("./three/BVHLoader.js");
    const megabytes = buffer.byteLength / 1e6;
    const best = async (times, run) => {
      let least = Infinity;
      for (let time = 0; time < times; time++) {
        const start = performance.now();
        await run(time);
        least = Math.min(least, performance.now() - start);
      }
      return megabytes / (least / 1e3);
    };
    const text = new TextDecoder().decode(buffer);
    const theirs = await best(1, () => new BVHLoader().parse(text));
    // The worker's program (web/js/reader.js).
    const setup = JSON.stringify({ options: { metres_per_unit: null, up: null, fps: null, max_bytes: 512 << 20, drop_t_pose: true }, roles: {}, skeleton_files: [] });
    const { default: init, readFile } = await import(new URL("./read/reader.js", document.querySelector("link[rel=modulepreload][href$='boot.js']").href));
    await init();
    const bytes = new Uint8Array(buffer);
    const receiver = { progress() {}, head() {}, piece() {} };
    const ours = () => readFile(receiver, "speed.bvh", bytes, setup, "0".repeat(64));
    const first = await best(1, ours);
    const warm = await best(4, ours);
    const whole = await best(3, (time) => window.segue.load(`speed${time}.bvh`, new Uint8Array(buffer)));
    return {
      "three.js MB/s": Number(theirs.toFixed(1)),
      "first reading MB/s": Number(first.toFixed(1)),
      "reading MB/s": Number(warm.toFixed(1)),
      "reading, times": `${(first / theirs).toFixed(1)} to ${(warm / theirs).toFixed(1)}`,
      "into the library MB/s": Number(whole.toFixed(1)),
      "library, times": Number((whole / theirs).toFixed(1)),
    };
  });
}

function serve(route) {
  const name = new URL(route.request().url()).pathname.split("/").at(-1);
  const script = SCRIPTS[name];
  return script ? route.fulfill({ contentType: "text/javascript", body: script() }) : route.abort();
}
