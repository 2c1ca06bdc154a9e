// Tests of the page on screens of other pixels.

import assert from "node:assert/strict";
import { onOneBackend } from "./harness.mjs";
import { until } from "./help.mjs";

/** Rounding to whole pixels of the screen moves an edge by one pixel of the page at most, its other edge as well. */
const ROUNDING = 2;

/** Returns the role, the name and the place of every element, once they no longer change. */
async function places(page) {
  let before = "";
  return until("the elements rest", async () => {
    const now = await page.evaluate(() => [...document.querySelectorAll("#outline [data-number]")].map((element) => {
      const { left, top, width, height } = element.style;
      return { what: `${element.role ?? element.localName} ${element.ariaLabel ?? element.textContent}`, place: [left, top, width, height].map(parseFloat) };
    }));
    const text = JSON.stringify(now);
    const rests = now.length > 20 && text === before && !text.includes("Saving…");
    before = text;
    if (!rests) await page.waitForTimeout(300);
    return rests && now;
  });
}

const canvas = (page) => page.evaluate(() => {
  const { width, height, clientWidth, clientHeight } = document.getElementById("segue");
  return { pixels: [width, height], css: [clientWidth, clientHeight], ratio: devicePixelRatio };
});

// Fails when the canvas has not as many pixels as the screen has for it, or the page is laid out
// otherwise on a screen of more pixels, also on one that a browser emulates.
for (const [viewport, scales] of [[[390, 844], [1, 1.5, 2, 3, 4]], [[1280, 800], [1, 1.5, 2]]]) {
  onOneBackend(`page of ${viewport[0]} by ${viewport[1]} has the same layout at every pixel ratio`, async ({ open }) => {
    let first;
    for (const scale of scales) {
      const { page } = await open("lab=blend&compare=blend_window:30,15,10&play=off", { viewport, scale });
      const { pixels, css, ratio } = await canvas(page);
      assert.equal(ratio, scale);
      assert.deepEqual(css, viewport);
      for (const axis of [0, 1]) assert.ok(Math.abs(pixels[axis] - css[axis] * scale) <= ROUNDING, `${scale}: ${pixels}`);
      const found = await places(page);
      first ??= found;
      assert.deepEqual(found.map(({ what }) => what), first.map(({ what }) => what), `at ${scale}`);
      for (const [index, { what, place }] of found.entries()) {
        const apart = Math.max(...place.map((at, axis) => Math.abs(at - first[index].place[axis])));
        assert.ok(apart <= ROUNDING, `at ${scale}, ${what}: ${place}, at 1: ${first[index].place}`);
      }
      await page.context().close();
    }
  });
}
