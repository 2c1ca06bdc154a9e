// Tests of the app in a real browser: the page's API, files, the link, storage, and lost graphics
// devices.

import assert from "node:assert/strict";
import { Buffer } from "node:buffer";
import { onBothBackends, onBackend, onOneBackend } from "./harness.mjs";
import { elsewhere, linkStored, stored, until } from "./help.mjs";

/** A small motion file: a hip with one bone that turns. */
function bvh(frames = 60, bone = "Spine") {
  const rows = Array.from({ length: frames }, (_, i) => `${i * 0.01} 1 0 0 ${i} 0 0 0 0`);
  return Buffer.from([
    "HIERARCHY", "ROOT Hips", "{", "OFFSET 0 0 0", "CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation",
    `JOINT ${bone}`, "{", "OFFSET 0 0.5 0", "CHANNELS 3 Zrotation Yrotation Xrotation", "End Site", "{", "OFFSET 0 0.5 0", "}", "}", "}",
    "MOTION", `Frames: ${frames}`, "Frame Time: 0.0166667", ...rows, "",
  ].join("\n"));
}

const brought = (clips) => clips.filter((clip) => clip.sha256).map((clip) => clip.name);

onOneBackend("the API answers, and set() is all or nothing", async ({ open, backend }) => {
  const { segue } = await open("blend_window=24&play=off");
  assert.equal((await segue("stats")).backend, backend);
  const keys = await segue("keys");
  const params = await segue("params");
  assert.deepEqual(keys.map(({ key }) => key).sort(), Object.keys(params).sort());
  assert.equal(params.blend_window, 24);

  await segue("set", { blend_window: 12, align: false });
  assert.equal((await segue("params")).blend_window, 12);
  assert.match(await segue("url"), /\?blend_window=12&align=off&play=off$/);
  const before = await segue("params");
  await assert.rejects(segue("set", { align: true, colour: "red" }), /`colour` is not a parameter/);
  await assert.rejects(segue("set", { align: true, blend_window: 500 }), /blend_window: found 500, expected 1 to 240 frames/);
  await assert.rejects(segue("set", { a: "nobody" }), /no clip `nobody`/);
  await assert.rejects(segue("set", "blend_window=3"), /expected an object/);
  assert.deepEqual(await segue("params"), before);

  const pose = await segue("pose", "result", 0.5);
  assert.equal(pose.positions.length, 3 * pose.joints.length);
  assert.equal(pose.rotations.length, 4 * pose.joints.length);
  await assert.rejects(segue("pose", "result:7", 0), /found `result:7`/);
  await assert.rejects(segue("export", "result", "max"), /export: found `max`, expected one of bvh/);
  assert.match((await segue("export", "result", "csv")).toString(), /^time_s,/);
  assert.match((await segue("export", "result", "bvh")).toString(), /^HIERARCHY\n/);
});

onOneBackend("metrics() has one number per pane", async ({ open }) => {
  const { segue } = await open("compare=blend_window:30,15,10&play=off");
  const metrics = Object.entries(await segue("metrics"));
  assert.ok(metrics.length > 3);
  for (const [name, { value, unit, panes }] of metrics) {
    assert.equal(panes.length, 3, name);
    assert.equal(panes[0], value, name);
    assert.equal(typeof unit, "string", name);
  }
});

onBothBackends("time runs, stops and is set, and a still page draws nothing", async ({ open }) => {
  const { page, segue } = await open("play=off&t=0.5&follow=off");
  assert.equal(await segue("time"), 0.5);
  await segue("seek", 0.25);
  assert.equal(await segue("time"), 0.25);
  // Before the page is still, cameras settle, presets are made, the address is written, and the
  // work is stored.
  const frames = async () => (await segue("stats")).frames;
  let [before, quiet] = [-1, 0];
  await until("nothing moves, and no frame is drawn for two seconds", async () => {
    await page.waitForTimeout(1000);
    const now = await frames();
    quiet = now === before ? quiet + 1 : 0;
    before = now;
    return quiet === 2;
  });
  await segue("play");
  await until("time runs", async () => (await segue("time")) !== 0.25);
  await segue("pause");
  const stopped = await segue("time");
  await page.waitForTimeout(500);
  assert.equal(await segue("time"), stopped);
});

onOneBackend("files are loaded by drop and by call, and bad ones change nothing", async ({ open }) => {
  const { page, segue, load, dropFile } = await open("lab=view&play=off");
  await page.evaluate(() => {
    window.heard = [];
    window.segue.on("error", ({ message }) => window.heard.push(message));
  });
  const { clips, warnings } = await load("turn.bvh", bvh());
  assert.equal(clips.length, 1);
  assert.equal(clips[0].frames, 60);
  assert.ok(Array.isArray(warnings));
  assert.equal((await segue("params")).a, clips[0].id);

  await assert.rejects(load("broken.bvh", Buffer.from("HIERARCHY\nROOT Hips\nnonsense")), /broken\.bvh:3:\d+: found .*expected/);
  await dropFile("other.bvh", bvh(30, "Chest"));
  await until("the dropped file is in the library", async () => brought(await segue("clips")).length === 2);
  await dropFile("notes.txt", Buffer.from("hello"));
  await page.waitForFunction(() => window.heard.some((message) => message.includes("notes.txt")));
  assert.equal(brought(await segue("clips")).length, 2);
});

onOneBackend("several files in one drop arrive in order", async ({ open }) => {
  const { page, segue } = await open("play=off");
  await page.evaluate((texts) => {
    const dataTransfer = new DataTransfer();
    for (const [name, text] of texts) dataTransfer.items.add(new File([text], name));
    document.getElementById("segue").dispatchEvent(new DragEvent("drop", { bubbles: true, cancelable: true, dataTransfer }));
  }, [["one.bvh", bvh(240).toString()], ["two.bvh", bvh(30, "Chest").toString()]]);
  await until("both are in the library", async () => brought(await segue("clips")).length === 2);
  const { a, b } = await segue("params");
  assert.match(a, /^one~/);
  assert.match(b, /^two~/);
});

onBackend("webgl2", "address follows the state and restores it", async ({ open }) => {
  const opened = await open("blend_window=24&play=off&backend=webgl2");
  const { page, segue } = opened;
  await segue("set", { blend_window: 48 });
  await page.waitForFunction(() => location.search.includes("blend_window=48"));
  assert.match(page.url(), /&backend=webgl2$/, "what belongs to the page stays");
  assert.doesNotMatch(await segue("url"), /backend/);
  const before = await segue("params");
  await page.reload();
  await opened.ready();
  assert.deepEqual(await segue("params"), before);

  await page.evaluate(() => {
    history.pushState(null, "", "?blend_window=7&play=off");
    history.pushState(null, "", "?blend_window=9&play=off");
    history.back();
  });
  await until("going back opens that link", async () => (await segue("params")).blend_window === 7);
});

onOneBackend("work after a reload is restored, with the files of the library alone", async ({ open }) => {
  const opened = await open("");
  const { page, segue, load } = opened;
  await load("kept.bvh", bvh());
  await load("also.bvh", bvh(30, "Chest"));
  await segue("set", { blend_window: 33, play: false });
  const hashes = (await segue("clips")).map((clip) => clip.sha256).filter(Boolean).sort();
  await linkStored(page, "blend_window=33");
  await until("both files are stored", async () => (await stored(page)).files.length === 2);
  assert.deepEqual((await stored(page)).files.sort(), hashes);

  // Without a query, everything is restored from storage.
  await page.goto(page.url().split("?")[0]);
  await opened.ready();
  await until("both clips are restored", async () => brought(await segue("clips")).length === 2);
  assert.deepEqual(brought(await segue("clips")).sort(), ["also", "kept"]);
  assert.equal((await segue("params")).blend_window, 33);
  assert.match((await segue("params")).a, /^kept~/);

  // A link overrides the stored parameters, and the library is restored.
  await page.goto(`${page.url().split("?")[0]}?blend_window=5`);
  await opened.ready();
  assert.equal((await segue("params")).blend_window, 5);
  await until("both clips are restored again", async () => brought(await segue("clips")).length === 2);

  // A framed page neither shows nor overwrites the stored work.
  await page.goto(`${page.url().split("?")[0]}?embed=1&blend_window=6`);
  await opened.ready();
  assert.equal(brought(await segue("clips")).length, 0);
  await segue("set", { blend_window: 7 });
  await page.waitForTimeout(1500);
  assert.match((await stored(page)).query, /blend_window=33/, "a link that was only looked at is not stored, nor is a frame");
});

onOneBackend("files are fetched in the order of the link, and refusals are explained", async ({ open }) => {
  const answers = {
    "/slow.bvh": { text: bvh(90), after: 800 },
    "/fast.bvh": { text: bvh(30, "Chest") },
    "/page.html": { text: "<!doctype html>", type: "text/html" },
    "/closed.bvh": { text: bvh(), cors: false },
    "/shut.bvh": { status: 403 },
  };
  await elsewhere(answers, async (far) => {
    const { page, segue } = await open(`src=${far}/slow.bvh%20${far}/fast.bvh&play=off`);
    await until("both files are in the library", async () => brought(await segue("clips")).length === 2);
    const { a, b } = await segue("params");
    assert.match(a, /^slow~/);
    assert.match(b, /^fast~/);

    await page.evaluate(() => {
      window.heard = [];
      window.segue.on("error", ({ message }) => window.heard.push(message));
    });
    for (const [address, reason] of [
      [`${far}/gone.bvh`, /^There is no file at .*gone\.bvh \(status 404\)/],
      [`${far}/shut.bvh`, /^127\.0\.0\.1:\d+ does not allow everyone to load shut\.bvh/],
      [`${far}/page.html`, /is a web page, not a motion file/],
      [`${far}/closed.bvh`, /^127\.0\.0\.1:\d+ does not allow other pages to read its files \(CORS\)\. Download the file and drop it here\./],
      ["http://127.0.0.1:1/nobody.bvh", /^127\.0\.0\.1:1 cannot be reached/],
      ["ftp://somewhere/x.bvh", /expected an address that starts with https/],
    ]) {
      await segue("set", { src: address }); // resolves once the file is there, or refused
      await until(`an error like ${reason}`, async () => (await page.evaluate(() => window.heard)).some((message) => reason.test(message)));
    }
    assert.equal(brought(await segue("clips")).length, 2);
  });
});

onBothBackends("a lost graphics device is replaced and the state stays", async ({ open, backend }) => {
  const prepare = (page) => page.addInitScript(() => {
    // The handle by which the test destroys the device.
    if (window.GPUAdapter) {
      const request = GPUAdapter.prototype.requestDevice;
      GPUAdapter.prototype.requestDevice = async function (...args) {
        return (window.device = await request.apply(this, args));
      };
    }
  });
  const { page, segue, pixels } = await open("blend_window=24&play=off", { scale: 1, prepare });
  await page.evaluate(() => { window.firstCanvas = document.getElementById("segue"); });
  await segue("set", { blend_window: 31 });
  for (let time = 0; time < 2; time++) {
    // After two losses within 10 s, the page would give up WebGPU; see lost.test.mjs.
    if (time > 0 && backend === "webgpu") await page.waitForTimeout(10_500);
    await page.evaluate((backend) => {
      const canvas = document.getElementById("segue");
      window.lost = window.device;
      if (backend === "webgpu") window.device.destroy();
      else canvas.getContext("webgl2").getExtension("WEBGL_lose_context").loseContext();
    }, backend);
    await page.waitForFunction(() => document.getElementById("segue") !== window.firstCanvas);
    // Frames before the loss do not count, and neither does the lost device. The new one may have
    // drawn all there is to draw by now: it gets something new.
    if (backend === "webgpu") await page.waitForFunction(() => window.device !== window.lost);
    const { frames } = await segue("stats");
    await segue("set", { blend_window: 32 + time });
    await until("it draws again", async () => (await segue("stats")).frames > frames);
    await page.evaluate(() => { window.firstCanvas = document.getElementById("segue"); });
  }
  assert.equal(await page.locator(".veil").count(), 0);
  assert.equal((await segue("params")).blend_window, 33);
  // Only on WebGL 2: SwiftShader's WebGPU sometimes hangs when the canvas of a replaced device is
  // read, by the browser or by the page. Frames on the new device are checked above.
  if (backend === "webgl2") assert.ok((await pixels()).colours() > 50);
});

onOneBackend("listeners get changes, and may call the API at once", async ({ open }) => {
  const { page, segue } = await open("play=off");
  await page.evaluate(() => {
    window.queries = [];
    window.segue.on("change", ({ query }) => {
      window.queries.push(query);
      if (query.includes("blend_window=9")) window.segue.set({ blend_window: 8 });
    });
  });
  await segue("set", { blend_window: 9 });
  await page.waitForFunction(() => window.queries.some((query) => query.includes("blend_window=8")));
  assert.equal((await segue("params")).blend_window, 8);
});

onOneBackend("bundled take is in the library once set() has resolved", async ({ open }) => {
  const { segue } = await open("lab=view&play=off");
  await segue("set", { a: "cmu_jump" });
  const take = (await segue("clips")).find(({ id }) => id === "cmu_jump");
  assert.ok(take.frames > 100 && take.height > 1.4 && take.height < 2.1, JSON.stringify(take));
  assert.equal((await segue("pose", "result", 0)).joints.length, take.joints);
});

onBackend("webgl2", "WebGL 2 draws where WebGPU has an adapter and no device", async ({ open }) => {
  const prepare = (page) => page.addInitScript(() => {
    // An adapter that is found, and gives no device: neither to the page nor to the app.
    let asked = 0;
    GPU.prototype.requestAdapter = async () => (asked++ < 2 ? {} : null);
  });
  const { page, segue, pixels } = await open("play=off", { scale: 1, prepare });
  assert.equal((await segue("stats")).backend, "webgl2");
  assert.ok((await pixels()).colours() > 50);

  // The app has replaced the page's canvas, and a lost context is still noticed.
  await page.evaluate(() => {
    window.firstCanvas = document.getElementById("segue");
    window.firstCanvas.getContext("webgl2").getExtension("WEBGL_lose_context").loseContext();
  });
  await page.waitForFunction(() => document.getElementById("segue") !== window.firstCanvas);
  await until("the new canvas shows the character", async () => (await pixels()).colours() > 50);
});

onOneBackend("copying puts the link into the clipboard, and then confirms it", async ({ open }) => {
  const { page, segue } = await open("blend_window=24&play=off");
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  await page.locator("#segue").focus();
  await page.keyboard.press("Control+c");
  const url = await segue("url");
  await until("the link is in the clipboard", async () => (await page.evaluate(() => navigator.clipboard.readText())) === url);
});

onBothBackends("panic in a frame is shown, and a reload restores the work", async ({ open }) => {
  const { page, segue, load, problems } = await open("lab=blend&play=off");
  const { clips } = await load("turn.bvh", bvh());
  await segue("set", { blend_window: 24 });
  await linkStored(page, "blend_window=24");
  await segue("play");
  // Without a clock, the next frame of the app panics, as by an error of its own.
  await page.evaluate(() => void Object.defineProperty(window, "performance", { configurable: true, value: undefined }));
  const panel = page.getByRole("alertdialog");
  await panel.waitFor();
  assert.match(await panel.innerText(), /\npanicked at eframe-[^]*\nshould have a Performance/);
  await assert.rejects(segue("params"), /has stopped: [^]*should have a Performance/);

  await page.getByRole("button", { name: "Reload with this state" }).click();
  await page.waitForFunction(() => window.segue?.clips && window.performance);
  // Until then, what has stopped may trap again.
  problems.length = 0;
  await until("the file is there again", async () => brought(await segue("clips")).includes(clips[0].name));
  const { a, blend_window } = await segue("params");
  assert.deepEqual({ a, blend_window }, { a: clips[0].id, blend_window: 24 });
});
