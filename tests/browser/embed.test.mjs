// Tests of the page in a frame of another one, and after the loss of its graphics context.

import assert from "node:assert/strict";
import { onBothBackends, onOneBackend } from "./harness.mjs";
import { apart, count, isClay, stageOf, striding, until } from "./help.mjs";

const SMALL = { viewport: [960, 640] };

// Fails when a call is not answered, a refusal arrives as a result, or the frame stores or shows
// the user's own work.
onBothBackends("frame answers the page around it", async ({ open }) => {
  const { page } = await open("", {
    ...SMALL,
    wait: false,
    prepare: (page) => page.route(({ pathname, search }) => pathname === "/" && search === "", (route) => route.fulfill({ contentType: "text/html", body: "<!doctype html><title>A course</title>" })),
  });
  const answers = await page.evaluate(async () => {
    const frame = document.createElement("iframe");
    Object.assign(frame, { src: "/?lab=blend&blend_window=12&play=off&embed=1", width: 800, height: 500 });
    const events = [];
    const waiting = new Map();
    const ready = new Promise((resolve) => {
      window.addEventListener("message", ({ data, source }) => {
        if (source !== frame.contentWindow || data?.segue !== 1) return;
        if (data.event) events.push(data.event);
        if (data.event === "ready") resolve(data.detail);
        waiting.get(data.id)?.(data);
      });
    });
    let id = 0;
    const ask = (call, ...args) => new Promise((resolve) => {
      waiting.set(++id, ({ result, error }) => resolve(error ? { error } : result));
      frame.contentWindow.postMessage({ segue: 1, id, call, args }, "*");
    });
    document.body.append(frame);
    const { version } = await ready;
    const answers = { version, asked: await ask("version"), params: await ask("params"), before: await ask("pose", "result", 2.4) };
    answers.set = await ask("set", { blend_window: 60 });
    Object.assign(answers, { after: await ask("pose", "result", 2.4), window: (await ask("params")).blend_window, url: await ask("url") });
    Object.assign(answers, { refused: await ask("set", { blend_window: 0 }), unknown: await ask("destroy"), bytes: (await ask("export", "result", "bvh")).length });
    answers.frames = (await ask("stats")).frames;
    answers.events = [...new Set(events)];
    answers.databases = (await indexedDB.databases()).map(({ name }) => name);
    return answers;
  });
  assert.equal(answers.asked, answers.version);
  assert.deepEqual([answers.params.blend_window, answers.params.embed], [12, true]);
  assert.equal(answers.set, undefined);
  assert.equal(answers.window, 60);
  assert.ok(apart(answers.before, answers.after) > 1e-3);
  assert.match(answers.refused.error, /blend_window: found 0/);
  assert.match(answers.unknown.error, /no call "destroy"/);
  assert.ok(answers.bytes > 10_000 && answers.frames > 0);
  assert.ok(answers.events.includes("change"));
  assert.deepEqual(answers.databases, [], "a frame stores nothing");
});

// Fails when a frame with the app's own link does not answer.
onOneBackend("frame with the link of an embedded state answers", async ({ open }) => {
  const { segue } = await open("lab=blend&play=off&embed=1", SMALL);
  const search = new URL(await segue("url")).search;
  const { page } = await open("", {
    ...SMALL,
    wait: false,
    prepare: (page) => page.route(({ pathname, search }) => pathname === "/" && search === "", (route) => route.fulfill({ contentType: "text/html", body: "<!doctype html><title>A course</title>" })),
  });
  const reported = await page.evaluate((search) => new Promise((resolve) => {
    window.addEventListener("message", ({ data }) => { if (data?.event === "ready") resolve("ready"); });
    const frame = document.createElement("iframe");
    frame.src = `/${search}`;
    document.body.append(frame);
  }), search);
  assert.equal(reported, "ready");
});

// Fails when the app and the page's modules parse a link differently. A frame that answers must
// have no storage.
onOneBackend("frame that answers stores nothing, by any spelling of its link", async ({ open }) => {
  const { page } = await open("", {
    ...SMALL,
    wait: false,
    prepare: (page) => page.route(({ pathname, search }) => pathname === "/" && search === "", (route) => route.fulfill({ contentType: "text/html", body: "<!doctype html><title>A course</title>" })),
  });
  const ask = (query, answers) => page.evaluate(async ([query, answers]) => {
    const frame = document.createElement("iframe");
    frame.src = `/?lab=view&play=off&${query}`;
    let answered = false;
    const listen = ({ data, source }) => { answered ||= source === frame.contentWindow && data?.segue === 1; };
    window.addEventListener("message", listen);
    document.body.append(frame);
    await new Promise((resolve) => { frame.onload = resolve; });
    const api = await frame.contentWindow.segueReady;
    frame.contentWindow.postMessage({ segue: 1, id: 7, call: "version" }, "*");
    await api.set({ play: true }); // whatever would answer has had its turn by then
    do await new Promise((resolve) => setTimeout(resolve, 200)); while (answers && !answered);
    window.removeEventListener("message", listen);
    frame.remove();
    return { answered, stores: (await indexedDB.databases()).length > 0 };
  }, [query, answers]);
  for (const query of ["embed=1", "embed=0&embed=1", "%65mbed=%31"]) assert.deepEqual(await ask(query, true), { answered: true, stores: false }, query);
  for (const query of ["embed=On", "embed=1%20", "embed", "?embed=1"]) assert.equal((await ask(query, false)).answered, false, query);
});

/** Records the WebGPU devices that the page makes, so that a test can destroy them. */
const watchDevices = (page) => page.addInitScript(() => {
  window.devices = [];
  if (!window.GPUAdapter) return;
  const request = GPUAdapter.prototype.requestDevice;
  GPUAdapter.prototype.requestDevice = async function (...args) {
    const device = await request.apply(this, args);
    window.devices.push(device);
    return device;
  };
});

// Fails when the page stays on the lost canvas, when a part of the document is lost, and when
// nothing is drawn afterwards.
onBothBackends("lost graphics context leaves the work", async ({ open, backend }) => {
  const { page, segue, load, pixels } = await open("lab=blend&play=off", { scale: 1, ...SMALL, prepare: watchDevices });
  const { clips: [clip] } = await load("mine.bvh", striding({ frames: 90 }));
  await segue("set", { a: "walk", blend_window: 21 });
  const before = { clips: await segue("clips"), params: await segue("params"), pose: await segue("pose", "result", 1) };
  await page.evaluate((backend) => {
    window.oldCanvas = document.getElementById("segue");
    if (backend === "webgpu") window.devices.at(-1).destroy();
    else window.oldCanvas.getContext("webgl2").getExtension("WEBGL_lose_context").loseContext();
  }, backend);
  await until("the app is on a fresh canvas", () => page.evaluate(() => document.getElementById("segue") !== window.oldCanvas && !window.oldCanvas.isConnected));
  await until("the character is drawn again", async () => {
    const picture = await pixels();
    return count(picture, stageOf(picture), isClay) > 1500;
  });
  assert.equal((await segue("stats")).backend, backend);
  assert.deepEqual(await segue("clips"), before.clips);
  assert.deepEqual(await segue("params"), before.params);
  assert.ok(apart(await segue("pose", "result", 1), before.pose) < 1e-6);
  await segue("set", { a: clip.id });
  assert.equal((await segue("params")).a, clip.id, "the API works on");
  assert.equal(await page.locator(".veil").count(), 0);
});
