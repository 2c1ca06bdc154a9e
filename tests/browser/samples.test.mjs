// Tests of bundled takes, which are fetched on demand, alone or as a set, and cached.

import assert from "node:assert/strict";
import { onOneBackend } from "./harness.mjs";
import { until } from "./help.mjs";

const DESK = { viewport: [1280, 800] };
const NINE = [
  "cmu16_walk", "cmu16_run", "cmu16_fast_walk", "cmu16_veer_left", "cmu16_veer_right", "cmu16_turn_left", "cmu16_turn_right", "cmu16_stop", "cmu16_run_stop",
];

/** Records the takes that the page requests. */
function watch(asked) {
  return (page) => page.on("request", (request) => {
    const [, file] = new URL(request.url()).pathname.split("/samples/");
    if (file) asked.push(file);
  });
}

// Fails when a first visit or another clip fetches takes, when a link fetches more than it names,
// and when a fetched take cannot be played.
onOneBackend("link to a take fetches that take alone", async ({ open }) => {
  const asked = [];
  const { segue } = await open("lab=loop&a=cmu16_walk&play=off", { ...DESK, prepare: watch(asked) });
  await segue("set", {});
  assert.deepEqual(asked, ["16_15.bvh.gz"]);
  const walk = (await segue("clips")).find(({ id }) => id === "cmu16_walk");
  assert.deepEqual([walk.format, walk.frames, Math.round(walk.fps)], ["bvh", 235, 60]);
  assert.ok((await segue("pose", "result", 0.5)).joints.includes("lfemur"));
});

// Fails when the clips of the graph are not replaced, when one of the nine is not loaded, and when
// the walk is not made of them.
onOneBackend("graph and match labs load all nine takes of a link", async ({ open }) => {
  const asked = [];
  const { segue } = await open("lab=graph&play=off", { ...DESK, prepare: watch(asked) });
  await segue("set", {});
  assert.deepEqual(asked, [], "none was requested");
  await segue("set", { clips: NINE.join(","), edge_threshold: 16 });
  await until("all have come", async () => (await segue("clips")).filter(({ id, frames }) => NINE.includes(id) && frames > 0).length === NINE.length);
  await segue("set", {});
  assert.equal(asked.length, NINE.length);
  assert.ok((await segue("pose", "result", 1)).joints.includes("lfemur"));
  await segue("set", { lab: "match", scenario: "straight", match_clips: NINE.join(",") });
  await segue("set", {});
  assert.equal(asked.length, NINE.length, "what is here is not fetched again");
  assert.ok((await segue("pose", "result", 1)).joints.includes("lfemur"));
});

// Fails when a take is not cached with the page, and when the library loses a loaded take.
onOneBackend("loaded take needs no network", async ({ open }) => {
  const { page, ready, segue } = await open("lab=loop&a=cmu16_run&play=off", { ...DESK, keeps: true });
  await until("the page is kept", () => page.evaluate(() => Boolean(navigator.serviceWorker.controller)));
  await segue("set", { a: "cmu16_walk" });
  // The first take was loaded before the page was cached, so only the second one is available on
  // the next visit.
  await until("the address names it", () => page.url().includes("cmu16_walk"));
  await page.evaluate(() => document.dispatchEvent(new Event("visibilitychange")));
  await page.context().setOffline(true);
  await page.reload();
  await ready();
  await segue("set", {});
  assert.ok((await segue("pose", "result", 0.5)).joints.includes("lfemur"));
});
