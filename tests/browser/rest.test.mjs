// Tests of the module in two parts: the first frames need the first alone, input waits for the
// rest, and what needs the rest sooner gets it.

import assert from "node:assert/strict";
import { onBothBackends, onOneBackend } from "./harness.mjs";
import { until } from "./help.mjs";

const SMALL = { viewport: [960, 640], wait: false };
const isRest = (url) => url.pathname.endsWith("_rest.wasm");

/**
 * Returns a function that prepares a page whose rest waits until `release()`, and a list of the
 * ways in which it was asked for: "fetch", or "xhr" by a call in the middle of the program, which
 * is answered at once.
 */
function held() {
  const asked = [];
  let release;
  const released = new Promise((resolve) => { release = resolve; });
  const prepare = (page) => page.route(isRest, async (route) => {
    const way = route.request().resourceType();
    asked.push(way);
    if (way === "fetch") await released;
    await route.continue();
  });
  return { prepare, asked, release: () => release() };
}

/** Waits for the first frame of a page whose API is not there yet. */
const firstFrame = (page) => page.waitForFunction(() => document.readyState !== "loading" && !document.getElementById("loading"));
/** Fails where a page draws before its rest is there. */
async function startsWithAll({ page, ready }, { asked, release }) {
  await until("the rest is asked for", async () => asked.length > 0);
  await page.waitForTimeout(1000);
  assert.ok(await page.locator("#loading").count(), "no frame yet");
  release();
  await ready();
  assert.deepEqual(asked, ["fetch"]);
}

/** Returns whether two pictures of the stage differ. */
const differ = (one, other) => one.data.some((value, i) => value !== other.data[i]);

// Fails when the first frames call a function that web/rest.txt names, when a key press is lost that
// comes before the rest, and when leaving such a page asks for it.
onBothBackends("first frames move without the rest, and input waits for it", async ({ open }) => {
  const { prepare, asked, release } = held();
  const { page, log, ready, segue, pixels } = await open("", { ...SMALL, prepare });
  await firstFrame(page);
  const before = await pixels();
  await until("the motion plays", async () => differ(before, await pixels()));
  await page.mouse.move(480, 300);
  await page.mouse.wheel(0, 50);
  await page.keyboard.press("Space");
  await page.evaluate(() => dispatchEvent(new PageTransitionEvent("pagehide")));
  const pressed = await pixels();
  await until("it goes on", async () => differ(pressed, await pixels()));
  assert.ok(await page.evaluate(() => !window.segue.clips), "the API waits");
  release();
  await ready();
  await until("the key stops playback", async () => (await segue("params")).play === false);
  assert.deepEqual(asked, ["fetch"], log.join("\n"));
});

// Fails like the one above, for other users: in Chinese, on a phone, with a pause at the start.
onBothBackends("first frames of others do without the rest, too", async ({ open }) => {
  const others = [["", { viewport: [390, 844], scale: 2, theme: "light" }], ["lang=zh-Hant", { motion: "reduce", viewport: [1920, 1200] }]];
  for (const [query, options] of others) {
    const { prepare, asked, release } = held();
    const { page, log, ready } = await open(query, { ...SMALL, ...options, prepare });
    await firstFrame(page);
    // Work is stored a second after a change.
    await page.waitForTimeout(3000);
    release();
    await ready();
    assert.deepEqual(asked, ["fetch"], log.join("\n"));
  }
});

// Fails when a link's first frame is drawn before the whole program is there.
onOneBackend("link waits for the rest", async ({ open }) => {
  const rest = held();
  const opened = await open("lab=graph&play=off", { ...SMALL, prepare: rest.prepare });
  await startsWithAll(opened, rest);
});

// Fails when the first frame of a later visit is drawn before its work can be read.
onOneBackend("visit with stored work waits for the rest", async ({ open }) => {
  const opened = await open("", SMALL);
  await opened.ready();
  const rest = held();
  await rest.prepare(opened.page);
  await opened.page.goto(opened.page.url().replace(/\?.*/, ""), { waitUntil: "commit" });
  await startsWithAll(opened, rest);
});

// Fails when a call that needs the rest before it is there goes wrong.
onOneBackend("call that needs the rest at once gets it", async ({ open }) => {
  const { prepare, asked, release } = held();
  const { page, ready, segue } = await open("", { ...SMALL, prepare });
  await firstFrame(page);
  // As the browser's "back" does, which is no input of the window.
  await page.evaluate(() => {
    history.replaceState(null, "", "?lab=graph&play=off");
    dispatchEvent(new PopStateEvent("popstate"));
  });
  await until("the rest is asked for", async () => asked.includes("xhr"));
  release();
  await ready();
  assert.equal((await segue("params")).lab, "graph");
  assert.deepEqual(asked, ["fetch", "xhr"]);
});

// Fails when a page waits for ever for a rest that cannot be had.
onOneBackend("rest that cannot be downloaded is shown", async ({ open }) => {
  const prepare = (page) => page.route(isRest, (route) => route.fulfill({ status: 503, body: "" }));
  const { page, ready } = await open("", { ...SMALL, prepare });
  await assert.rejects(ready(), /could not be downloaded: .*503/);
  assert.match(await page.locator(".veil .panel").innerText(), /could not be downloaded/);
});
