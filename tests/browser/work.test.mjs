// Tests of work between frames. Without a graphics card, frames are far apart, and a hidden page
// has none.

import assert from "node:assert/strict";
import { striding, until } from "./help.mjs";
import { onOneBackend } from "./harness.mjs";

// Fails when work waits for frames, also where the answer of a worker comes after the last one, and
// when every slice of it opens a channel, which browsers keep in memory.
onOneBackend("work without frames ends, through one channel", async ({ open }) => {
  const { page, segue, load } = await open("lab=view&play=off", { prepare: countAndHold });
  const [a, b] = [await load("a.bvh", striding({ frames: 1200, hertz: 0.9 })), await load("b.bvh", striding({ frames: 1200, hertz: 1.1, swing: 40 }))];
  const before = await page.evaluate(() => window.channels);
  await page.evaluate((link) => {
    // One frame reads the address, one begins the work.
    window.framesLeft = 2;
    history.pushState(null, "", link);
    dispatchEvent(new PopStateEvent("popstate"));
  }, `?lab=register&a=${a.clips[0].id}&b=${b.clips[0].id}&play=off`);
  await until("the frames are used up", () => page.evaluate(() => window.framesLeft === 0 && window.held.length > 0));
  assert.equal((await segue("params")).lab, "register");
  await until("the clips are registered", async () => (await segue("stats")).jobs.length === 0);
  assert.equal(await page.evaluate(() => window.framesLeft), 0);
  assert.ok(await page.evaluate(() => window.channels) - before <= 1, "more than one channel");
  await page.evaluate(() => {
    window.framesLeft = Infinity;
    for (const callback of window.held.splice(0)) requestAnimationFrame(callback);
  });
  await segue("set", {});
  assert.ok(Object.keys(await segue("metrics")).length > 0);
});

function countAndHold(page) {
  return page.addInitScript(() => {
    window.channels = 0;
    window.MessageChannel = class extends MessageChannel {
      constructor() {
        super();
        window.channels += 1;
      }
    };
    window.framesLeft = Infinity;
    window.held = [];
    const real = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (callback) => {
      if (window.framesLeft <= 0) return -window.held.push(callback);
      window.framesLeft -= 1;
      return real(callback);
    };
    // While frames are counted, workers answer after the last one.
    const framesEnd = async () => {
      while (window.framesLeft < Infinity && window.held.length === 0) await new Promise((resolve) => setTimeout(resolve, 10));
    };
    window.Worker = class extends Worker {
      addEventListener(type, listener, ...options) {
        super.addEventListener(type, (event) => framesEnd().then(() => listener(event)), ...options);
      }
    };
  });
}
