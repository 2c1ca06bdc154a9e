// Segue in a real Chromium, on both graphics backends. A test is a few lines:
//
//   import { onBothBackends } from "./harness.mjs";
//   onBothBackends("a dropped file appears in the library", async ({ open }) => {
//     const { page, segue, dropFile } = await open("lab=blend");
//     await dropFile("walk.bvh", bytes);
//     assert.equal((await segue("clips")).length, 1);
//   });
//
// `cargo xtask test browser` runs them all; `node --test` here, or `node --test one.test.mjs`, works too and serves dist/ itself.

import test, { after } from "node:test";
import { BACKENDS, close, openSegue } from "./segue.mjs";

after(close);

/** A browser that stops for good fails its test, and the others go on. */
const TEST_TIMEOUT_MS = 900_000;

/** Registers the test once per backend. `body` is given `{ backend, open, t }`; what it opens is closed behind it. */
export function onBothBackends(name, body) {
  for (const backend of BACKENDS) onBackend(backend, name, body);
}

/** Registers the test for one backend: for what does not depend on it, or exists on one only. */
export function onBackend(backend, name, body) {
  test(`${name} [${backend}]`, { timeout: TEST_TIMEOUT_MS }, async (t) => {
    const opened = [];
    const open = async (query = "", options = {}) => {
      const segue = await openSegue(backend, query, options);
      opened.push(segue);
      return segue;
    };
    try {
      await body({ backend, open, t });
      for (const { problems, log, refuses } of opened) {
        // What the page's own policy forbids it to do is a mistake, but where a test tries to break it (`refuses`).
        if (!refuses) problems.push(...log.filter((line) => line.includes("Content Security Policy")));
        if (problems.length) throw new Error(`the page reported:\n${problems.join("\n")}`);
      }
    } catch (error) {
      for (const { log } of opened) for (const line of log) t.diagnostic(line);
      throw error;
    } finally {
      for (const { page } of opened) await page.context().close();
    }
  });
}
