// Tests of graphics devices that are lost, one after the other, while the page plays, a slider is
// dragged and files are loaded.

import assert from "node:assert/strict";
import { onBackend } from "./harness.mjs";
import { random, striding, until } from "./help.mjs";

const SMALL = { viewport: [960, 640] };
const LOSSES = 20;
const BURSTS = 5;
/** The number of WebGPU losses. After two within 10 s, the page draws with WebGL 2. */
const WEBGPU_PAGES = 10;

/** Runs in the page. Defines `lose()`, which destroys the present graphics device. */
const prepare = (page) => page.addInitScript(() => {
  if (window.GPUAdapter) {
    const request = GPUAdapter.prototype.requestDevice;
    GPUAdapter.prototype.requestDevice = async function (...args) {
      return (window.device = await request.apply(this, args));
    };
  }
  window.lose = (backend) => {
    if (backend === "webgpu") return window.device.destroy();
    // Like a real loss, it may come before the app has drawn on a new canvas.
    document.getElementById("segue").getContext("webgl2", { antialias: false })?.getExtension("WEBGL_lose_context")?.loseContext();
  };
});

/**
 * Plays, drags the blend window and loads files while `body` runs. Returns the ids of the files.
 */
async function whileBusy({ page, segue, load }, body) {
  const ids = [];
  let done = false;
  const load_all = async () => {
    for (let index = 0; !done; index++) {
      const { clips } = await load(`${index}.bvh`, striding({ frames: 12, swing: 10 + (index % 60) }));
      ids.push(clips[0].id);
      await page.waitForTimeout(200);
    }
  };
  const drag_all = async () => {
    for (let step = 0; !done; step++) {
      await page.mouse.move(820 + (step % 20), 300);
      await (step % 2 ? page.mouse.up() : page.mouse.down());
      await segue("set", { blend_window: 10 + (step % 40) });
    }
    await page.mouse.up();
  };
  await segue("set", { play: true });
  await Promise.all([body().finally(() => { done = true; }), load_all(), drag_all()]);
  return [...new Set(ids)];
}

async function isAlive({ page, segue }, ids) {
  const { frames } = await segue("stats");
  await until("it draws", async () => (await segue("stats")).frames > frames + 3);
  assert.equal(await page.locator(".veil").count(), 0, "nothing has stopped");
  const there = (await segue("clips")).map(({ id }) => id);
  assert.ok(ids.length > 0 && ids.every((id) => there.includes(id)), `${ids.length} files`);
}

onBackend("webgl2", `${LOSSES} lost WebGL contexts at any moment`, async ({ open }) => {
  const opened = await open("lab=blend", { ...SMALL, prepare });
  const next = random(22);
  const ids = await whileBusy(opened, async () => {
    for (let loss = 0; loss < LOSSES; loss++) {
      await opened.page.waitForTimeout(50 + 1500 * next());
      await opened.page.evaluate(() => window.lose("webgl2"));
    }
  });
  await isAlive(opened, ids);
});

// Fails when a context that is lost before it draws is handed to wgpu, and when a loss during a
// restart is ignored.
onBackend("webgl2", `${BURSTS} bursts of lost WebGL contexts`, async ({ open }) => {
  const opened = await open("lab=blend", { ...SMALL, prepare });
  const next = random(23);
  const ids = await whileBusy(opened, async () => {
    for (let burst = 0; burst < BURSTS; burst++) {
      await opened.page.waitForTimeout(2000 * next());
      await opened.page.evaluate(async () => {
        const times = [0, 5, 50, 150, 400];
        await Promise.all(times.map((time) => new Promise((resolve) => setTimeout(() => resolve(window.lose("webgl2")), time))));
      });
    }
  });
  await isAlive(opened, ids);
});

for (let index = 1; index <= WEBGPU_PAGES; index++) {
  onBackend("both", `two WebGPU devices destroyed at any moment, page ${index} of ${WEBGPU_PAGES}`, async ({ open }) => {
    const opened = await open("lab=blend", { ...SMALL, prepare });
    const { page, segue } = opened;
    assert.equal((await segue("stats")).backend, "webgpu");
    const next = random(100 + index);
    const ids = await whileBusy(opened, async () => {
      for (let loss = 0; loss < 2; loss++) {
        await until("there is a device", () => page.evaluate(() => window.device !== window.dead));
        await page.waitForTimeout(1500 * next());
        await page.evaluate(() => {
          window.dead = window.device;
          window.lose("webgpu");
        });
      }
    });
    await isAlive(opened, ids);
  });
}

onBackend("both", "WebGL 2 draws after two lost WebGPU devices within 10 s", async ({ open }) => {
  // The page plays, so that every device keeps drawing. A still page may end after one frame.
  const opened = await open("lab=blend", { ...SMALL, prepare });
  const { page, segue } = opened;
  await page.evaluate(() => {
    window.errors = [];
    window.segue.on("error", ({ message }) => window.errors.push(message));
  });
  let [losses, drawn] = [0, 0];
  await until("WebGL 2 draws", async () => {
    const { backend, frames } = await segue("stats");
    if (backend === "webgl2") return true;
    const isFresh = await page.evaluate(() => window.device !== window.dead);
    if (!isFresh) drawn = frames; // frames may still be counted on the device that is gone
    else if (losses < 2 && frames > drawn + 1) {
      losses += 1;
      await page.evaluate(() => {
        window.dead = window.device;
        window.lose("webgpu");
      });
    }
    return false;
  });
  assert.equal(losses, 2);
  assert.equal(await page.locator(".veil").count(), 0);
  await until("it is said", () => page.evaluate(() => window.errors.some((message) => message.includes("WebGL 2"))));
});
