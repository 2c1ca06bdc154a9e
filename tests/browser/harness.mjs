// Segue in a real Chromium, on both graphics backends. A test is a few lines:
//
//   import { onBothBackends } from "./harness.mjs";
//   onBothBackends("dropped file appears in the library", async ({ open }) => {
//     const { page, segue, dropFile } = await open("lab=blend");
//     await dropFile("walk.bvh", bytes);
//     assert.equal((await segue("clips")).length, 1);
//   });
//
// `cargo xtask test browser` runs all tests. `node --test` here, or `node --test one.test.mjs`,
// works as well, and serves dist/ itself.

import process from "node:process";
import test, { after } from "node:test";
import { BACKENDS, close, endBrowser, hasGraphics, openSegue, setBrowserFlags, withTimeout } from "./segue.mjs";

// A page of a test lives for seconds: what the browser would compile again, to run faster later, is
// a fifth of what it takes to open one. Ten times as much has to run before it does.
setBrowserFlags(["--js-flags=--wasm-tiering-budget=130000000"]);

/** The tests that passed only in their second run, with what the first one reported. */
const unstable = [];

after(async () => {
  await close();
  for (const each of unstable) console.log(`PASSED IN A SECOND RUN: ${each}`);
});

/**
 * The time limit of one run of a test, so that a browser that hangs fails its test and not all
 * others. The longest test takes 45 s on an idle machine.
 */
const RUN_TIMEOUT_MS = 300_000;
/** The time limit for the pages of a test to close. */
const CLOSE_TIMEOUT_MS = 30_000;

/**
 * Device pixels per CSS pixel. A test takes most of its time to draw in software, and a quarter of
 * the pixels is enough for all that look at none: those that do ask for `scale: 1`.
 */
const SCALE = 0.5;

/**
 * Registers a test once per backend. `body` gets `{ backend, open, t }`. The pages that it opens
 * are closed at its end.
 */
export function onBothBackends(name, body) {
  for (const backend of BACKENDS) onBackend(backend, name, body);
}

/**
 * Registers a test whose result does not depend on the graphics, for the backend that starts
 * sooner.
 */
export function onOneBackend(name, body) {
  onBackend("webgpu", name, body);
}

/**
 * Registers a test for one backend, where only that one has the feature.
 *
 * A test that failed runs once more in a new browser where the graphics of the old one no longer
 * answer. In CI it also does where a wait ran out: a browser that draws in software hangs at times.
 * A wrong value or an error of the page is a failure at once. What passes in the second run is
 * listed at the end, with what it reported first, to be looked into.
 */
export function onBackend(backend, name, body) {
  test(`${name} [${backend}]`, async (t) => {
    try {
      await run(backend, body, t);
    } catch (error) {
      const isSilent = !(await hasGraphics(backend));
      const ranOut = process.env.CI && error.name === "TimeoutError";
      if (!isSilent && !ranOut) throw error;
      const reason = isSilent ? "the browser's graphics do not answer" : "a wait ran out";
      t.diagnostic(`run again in a new browser, because ${reason}: ${error.message}`);
      await endBrowser(backend).catch((late) => t.diagnostic(late.message));
      await run(backend, body, t);
      unstable.push(`${name} [${backend}]: ${error.stack}`);
    }
  });
}

async function run(backend, body, t) {
  const opened = [];
  const open = async (query = "", options = {}) => {
    const segue = await openSegue(backend, query, { scale: SCALE, ...options });
    opened.push(segue);
    return segue;
  };
  try {
    await withTimeout(body({ backend, open, t }), RUN_TIMEOUT_MS, () => `the test does not end; its pages: ${opened.map(({ page }) => page.url()).join(", ")}`);
    // A page whose WebGPU device dies at the start draws with WebGL 2.
    const drawn = await opened.at(-1)?.page.evaluate(() => window.segue?.stats?.().backend).catch(() => undefined);
    if (drawn && drawn !== backend) t.diagnostic(`drawn by ${drawn}`);
    for (const { problems, log, refuses } of opened) {
      // Violations of the page's policy are errors, except in a test that provokes them
      // (`refuses`).
      if (!refuses) problems.push(...log.filter((line) => line.includes("Content Security Policy")));
      if (problems.length) throw new Error(`the page reported:\n${problems.join("\n")}`);
    }
  } catch (error) {
    for (const { log } of opened) for (const line of log) t.diagnostic(line);
    for (const { page } of opened) error.message += `\n${await shownBy(page)}`;
    throw error;
  } finally {
    const closed = Promise.all(opened.map(({ page }) => page.context().close()));
    await withTimeout(closed, CLOSE_TIMEOUT_MS, () => "a page does not close").catch((reason) => t.diagnostic(reason.message));
  }
}

/** Returns what a page shows, for the report of a failed test. */
async function shownBy(page) {
  const asked = page.evaluate(() => {
    const texts = [...document.querySelectorAll("[role=alert], [role=status]")].map(({ textContent }) => textContent.trim()).filter(Boolean);
    const api = window.segue;
    const clips = api?.clips().map(({ id }) => id).join(", ");
    return [`${api?.url() ?? location.href} (${document.visibilityState}); clips: ${clips}`, ...texts, JSON.stringify(api?.stats())].join("\n");
  });
  return withTimeout(asked, CLOSE_TIMEOUT_MS, () => "the page does not answer").catch((reason) => `${page.url()}: ${reason.message}`);
}
