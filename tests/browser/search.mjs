// A measurement without bounds: the time of a search of motion matching in Chromium by each method,
// the median and the 99th percentile. `cargo xtask match-speed` does the same outside the browser.
//
//   node tests/browser/search.mjs [--frames 5000,50000,500000]

import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import process from "node:process";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { close, launch } from "./segue.mjs";

const { values } = parseArgs({ options: { frames: { type: "string", default: "5000,50000,500000" } } });
const root = fileURLToPath(new URL("../..", import.meta.url));
/** The number of queries for slow methods. */
const FEW = 200;

const folder = mkdtempSync(join(tmpdir(), "segue-search-"));
const rows = {};
try {
  build();
  const page = await (await launch("webgl2")).newPage();
  // In an isolated page, the resolution of the clock is 5 microseconds instead of 100.
  const headers = { "Cross-Origin-Opener-Policy": "same-origin", "Cross-Origin-Embedder-Policy": "require-corp" };
  await page.route("**/*", (route) => {
    const name = new URL(route.request().url()).pathname.slice(1);
    if (name === "") return route.fulfill({ contentType: "text/html", headers, body: "<!doctype html>" });
    const contentType = name.endsWith(".wasm") ? "application/wasm" : "text/javascript";
    return route.fulfill({ contentType, headers, body: readFileSync(join(folder, name)) });
  });
  await page.goto("http://127.0.0.1/");
  for (const frames of values.frames.split(",").map(Number)) Object.assign(rows, await page.evaluate(measure, { frames, FEW }));
} finally {
  await close();
  rmSync(folder, { recursive: true });
}
console.table(rows);
process.exit();

function build() {
  const target = "wasm32-unknown-unknown";
  const run = (program, args) => {
    const { status, stdout } = spawnSync(program, args, { cwd: root, stdio: ["ignore", "pipe", "inherit"], maxBuffer: 1 << 28, encoding: "utf8" });
    if (status !== 0) throw new Error(`${program} failed`);
    return stdout;
  };
  const output = run("cargo", ["build", "--release", "--locked", "--target", target, "--package", "segue-tools", "--bin", "match_speed", "--message-format", "json-render-diagnostics"]);
  const messages = output.trim().split("\n").map((line) => JSON.parse(line));
  const made = messages.filter((message) => message.target?.name === "match_speed").flatMap((message) => message.filenames ?? []);
  run("cargo", ["run", "--quiet", "--locked", "--package", "segue-bindgen", made.find((name) => name.endsWith(".wasm")), folder]);
}

async function measure({ frames, FEW }) {
  const { default: start, SearchTrial } = await import("/match_speed.js");
  await start();
  const trial = new SearchTrial(frames);
  const rows = {};
  trial.kinds().forEach((kind, at) => {
    rows[`${trial.frames()}, ${kind}`] = Object.fromEntries(trial.methods().map((method, number) => {
      const all = trial.queries(at);
      const times = Array(number === 0 ? all : Math.min(all, FEW)).fill(Infinity);
      for (let pass = 0; pass < 3; pass++) {
        for (let query = 0; query < times.length; query++) {
          const begun = performance.now();
          trial.search(number, at, query);
          times[query] = Math.min(times[query], performance.now() - begun);
        }
      }
      times.sort((a, b) => a - b);
      const share = (share) => Math.round(1e3 * times[Math.floor((times.length - 1) * share)]);
      return [`${method} µs`, `${share(0.5)}, ${share(0.99)}`];
    }));
  });
  trial.free();
  return rows;
}
