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
 * Returns the page with calls that wait for a page that is loaded again, and are made again there:
 * after two lost WebGPU devices, with WebGL 2.
 */
function surviving(opened) {
  const again = (call) => async (...args) => {
    for (;;) {
      try {
        await opened.ready();
        return await call(...args);
      } catch (reason) {
        if (!String(reason).includes("Execution context was destroyed")) throw reason;
      }
    }
  };
  return { ...opened, segue: again(opened.segue), load: again(opened.load), evaluate: again((...args) => opened.page.evaluate(...args)) };
}

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
  assert.ok(ids.length > 0);
  // A page that was loaded again lists them as it restores them.
  await until(`all ${ids.length} files are there`, async () => {
    const there = (await segue("clips")).map(({ id }) => id);
    return ids.every((id) => there.includes(id));
  });
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
    const opened = surviving(await open("lab=blend", { ...SMALL, prepare }));
    const { page, segue, evaluate } = opened;
    assert.equal((await segue("stats")).backend, "webgpu");
    const next = random(100 + index);
    const ids = await whileBusy(opened, async () => {
      for (let loss = 0; loss < 2; loss++) {
        await until("there is a device", () => evaluate(() => window.device !== window.dead));
        await page.waitForTimeout(1500 * next());
        await evaluate(() => {
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
  const { page, segue, load, evaluate } = surviving(await open("lab=blend", { ...SMALL, prepare }));
  const { clips: [own] } = await load("own.bvh", striding({ frames: 40 }));
  await segue("set", { a: own.id, blend_window: 23 });
  let [losses, drawn] = [0, 0];
  await until("WebGL 2 draws", async () => {
    const { backend, frames } = await segue("stats");
    if (backend === "webgl2") return true;
    const isFresh = await evaluate(() => window.device !== window.dead);
    if (!isFresh) drawn = frames; // frames may still be counted on the device that is gone
    else if (losses < 2 && frames > drawn + 1) {
      losses += 1;
      await evaluate(() => {
        window.dead = window.device;
        window.lose("webgpu");
      });
    }
    return false;
  });
  assert.equal(losses, 2);
  assert.equal(await page.locator(".veil").count(), 0);
  await until("it is said", async () => (await evaluate(() => document.body.textContent)).includes("so Segue draws with WebGL 2 now"));
  const { a, blend_window } = await segue("params");
  assert.deepEqual({ a, blend_window }, { a: own.id, blend_window: 23 });
  assert.doesNotMatch(page.url(), /backend=/, "the next visit tries WebGPU again");
});

// Fails when the page waits for ever for a device that does not come.
onBackend("both", "WebGL 2 draws where a lost WebGPU device has no successor", async ({ open }) => {
  const { page, segue, load } = surviving(await open("lab=blend", { ...SMALL, prepare: (page) => Promise.all([prepare(page), page.clock.install()]) }));
  const { clips: [own] } = await load("own.bvh", striding({ frames: 40 }));
  await segue("set", { a: own.id, blend_window: 23 });
  await page.evaluate(() => {
    GPUAdapter.prototype.requestDevice = () => {
      window.isAsked = true;
      return new Promise(() => {});
    };
    window.lose("webgpu");
  });
  await page.waitForFunction(() => window.isAsked);
  await page.clock.fastForward(30_000);
  await until("WebGL 2 draws", async () => (await segue("stats")).backend === "webgl2");
  const { a, blend_window } = await segue("params");
  assert.deepEqual({ a, blend_window }, { a: own.id, blend_window: 23 });
});

// Fails when a start waits for ever for graphics that never answer.
for (const what of ["requestAdapter", "requestDevice"]) {
  onBackend("both", `WebGL 2 draws where ${what} never answers`, async ({ open }) => {
    const hang = (page) => page.addInitScript((what) => {
      (what === "requestAdapter" ? GPU : GPUAdapter).prototype[what] = () => {
        window.asked = (window.asked ?? 0) + 1;
        return new Promise(() => {});
      };
    }, what);
    const { page, segue, ready } = await open("lab=blend&blend_window=23", { ...SMALL, wait: false, prepare: (page) => Promise.all([hang(page), page.clock.install()]) });
    await page.waitForFunction(() => window.asked === 1);
    if (what === "requestAdapter") {
      // The module with WebGL 2 starts meanwhile, and asks again.
      await page.clock.fastForward(100);
      await page.waitForFunction(() => window.asked === 2);
    }
    await page.clock.fastForward(30_000);
    await page.waitForFunction(() => !window.asked); // the page that follows
    await ready();
    assert.equal((await segue("stats")).backend, "webgl2");
    assert.equal((await segue("params")).blend_window, 23);
    assert.equal(await page.locator(".veil").count(), 0);
  });
}

onBackend("both", "embedded page without WebGPU offers to go on with WebGL 2", async ({ open }) => {
  const { page, segue, ready } = await open("lab=blend&embed=1&blend_window=23", { ...SMALL, prepare });
  for (let loss = 0; loss < 2; loss++) {
    const { frames } = await segue("stats");
    await until("a device draws", async () => (await page.evaluate(() => window.device !== window.dead)) && (await segue("stats")).frames > frames + 1);
    await page.evaluate(() => {
      window.dead = window.device;
      window.lose("webgpu");
    });
  }
  await page.getByRole("button", { name: "Reload with this state" }).click();
  await page.waitForFunction(() => !document.querySelector(".veil"));
  await ready();
  assert.equal((await segue("stats")).backend, "webgl2");
  assert.equal((await segue("params")).blend_window, 23);
});
