// Tests of recordings of the page by the API.

import assert from "node:assert/strict";
import { setTimeout as pause } from "node:timers/promises";
import { onBothBackends } from "./harness.mjs";
import { until } from "./help.mjs";

/**
 * Records a video that can be played and is not empty. Returns undefined where the machine drew
 * nothing in that time.
 */
async function film(page, segue) {
  await segue("record");
  await assert.rejects(segue("record"), /a recording is under way/);
  const { frames } = await segue("stats");
  await until("frames are drawn", async () => (await segue("stats")).frames > frames + 5);
  await pause(1500);
  return page.evaluate(async () => {
    let blob;
    try {
      blob = await window.segue.stopRecording();
    } catch (error) {
      if (/nothing was drawn/.test(error.message)) return undefined;
      throw error;
    }
    const video = Object.assign(document.createElement("video"), { muted: true, src: URL.createObjectURL(blob) });
    await new Promise((resolve, reject) => Object.assign(video, { onloadeddata: resolve, onerror: () => reject(new Error(video.error.message)) }));
    return { type: blob.type, size: blob.size, width: video.videoWidth, height: video.videoHeight };
  });
}

// Fails when nothing is recorded, when the result is no video, and when an ended recording goes on.
onBothBackends("recording is a video of the page", async ({ open }) => {
  const { page, segue } = await open("lab=blend&play=on", { scale: 1, viewport: [640, 480] });
  await segue("set", {});
  await assert.rejects(segue("stopRecording"), /no recording is under way/);
  const made = await until("there is a video", () => film(page, segue));
  assert.match(made.type, /^video\/(webm|mp4)/);
  assert.ok(made.size > 2000, `${made.size} bytes`);
  assert.deepEqual([made.width, made.height], [640, 480]);
  await assert.rejects(segue("stopRecording"), /no recording is under way/);
});
