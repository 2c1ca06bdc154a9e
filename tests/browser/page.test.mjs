// Tests of the page around the app, in success and in failure. A stub replaces the app, because
// most failures cannot be provoked in the real one.

import assert from "node:assert/strict";
import { onBackend } from "./harness.mjs";

const STAND_IN = `
  export default async function init({ module_or_path }) { await module_or_path; return { memory: window.memory }; }
  export class SegueHandle {
    static async start(canvas) {
      if (window.startFails) throw "no graphics for you";
      window.app = new SegueHandle();
      window.app.canvases = [canvas];
      return window.app;
    }
    async firstFrame() {}
    setComplete() { window.isComplete = true; }
    async restart(canvas) { this.canvases.push(canvas); }
    version() { return "9.9.9"; }
    setListener(listener) { this.tell = listener; }
    setOutline() {}
    hasPanicked() { return Boolean(window.panic); }
    panicSummary() { return window.panic; }
    isEmbedded() { return new URLSearchParams(window.location.search).has("embed"); }
    stats() { return { backend: "webgl2" }; }
    clips() { return [{ id: "walk" }]; }
    async set(values) { if (values.wrong) throw "wrong: no such key"; window.lastSet = values; }
    async load(name, bytes) { return { clips: [{ name, bytes: bytes.length }], warnings: [] }; }
    exportClip() { return new Uint8Array([1, 2, 3]); }
  }`;

/** The smallest WebAssembly module, which the page compiles and hands to the bindings. */
const EMPTY_MODULE = Buffer.from([0x00, 0x61, 0x73, 0x6d, 0x01, 0x00, 0x00, 0x00]);
const fulfillWasm = (route) => route.fulfill({ contentType: "application/wasm", body: EMPTY_MODULE });

const isBundle = (url) => /\/segue-[^/]*\.js$/.test(url.pathname);
const isWasm = (url) => url.pathname.endsWith(".wasm");

async function standIn(page) {
  await page.route(isBundle, (route) => route.fulfill({ contentType: "text/javascript", body: STAND_IN }));
  await page.route(isWasm, fulfillWasm);
}

const panelOf = (page) => page.locator(".veil .panel");

onBackend("webgl2", "segueReady resolves with the API", async ({ open }) => {
  const { page, segue, load } = await open("", { prepare: standIn });
  assert.equal(await segue("version"), "9.9.9");
  assert.deepEqual(await segue("clips"), [{ id: "walk" }]);
  assert.deepEqual(await load("a.bvh", Buffer.from("xyz")), { clips: [{ name: "a.bvh", bytes: 3 }], warnings: [] });
  assert.deepEqual([...(await segue("export", "walk", "bvh"))], [1, 2, 3]);
  await assert.rejects(segue("set", { wrong: 1 }), /Error: wrong: no such key/);
  assert.equal(await page.locator("#loading").count(), 0);

  const heard = await page.evaluate(() => {
    const heard = [];
    const stop = window.segue.on("change", (detail) => heard.push(detail));
    window.app.tell("change", 1);
    stop();
    window.app.tell("change", 2);
    return heard;
  });
  assert.deepEqual(heard, [1]);
  await assert.rejects(page.evaluate(() => window.segue.on("nothing", () => {})), /on: event: found `nothing`, expected one of change, error, progress/);
});

onBackend("webgl2", "failed download is shown and can be tried again", async ({ open }) => {
  const { page, ready } = await open("", {
    wait: false,
    prepare: async (page) => {
      await standIn(page);
      await page.route(isWasm, (route) => route.fulfill({ status: 503, body: "" }));
    },
  });
  await assert.rejects(ready(), /could not be downloaded: .*503/);
  assert.match(await panelOf(page).innerText(), /could not be downloaded/);
  await page.unroute(isWasm);
  await page.route(isWasm, fulfillWasm);
  await page.getByRole("button", { name: "Try again" }).click();
  await page.waitForFunction(() => window.segue?.version === "9.9.9");
});

onBackend("webgl2", "browser without graphics shows a sentence", async ({ open }) => {
  const { page, ready } = await open("", {
    wait: false,
    prepare: (page) => page.addInitScript(() => {
      delete window.WebGL2RenderingContext;
      Object.defineProperty(navigator, "gpu", { value: undefined });
    }),
  });
  await assert.rejects(ready(), /Neither WebGPU nor WebGL2/);
  assert.match(await panelOf(page).innerText(), /neither WebGPU nor WebGL2/);
});

onBackend("webgl2", "failed start shows its reason", async ({ open }) => {
  const { page, ready } = await open("", {
    wait: false,
    prepare: async (page) => {
      await standIn(page);
      await page.addInitScript(() => { window.startFails = true; });
    },
  });
  await assert.rejects(ready(), /could not start: no graphics for you/);
  assert.match(await panelOf(page).innerText(), /no graphics for you/);
});

onBackend("webgl2", "panic shows its text, a report to copy, and a button to reload", async ({ open }) => {
  const { page, segue } = await open("lab=blend", { prepare: standIn });
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  await page.evaluate(() => { window.panic = "the knee bent backwards"; });
  await panelOf(page).waitFor();
  assert.match(await panelOf(page).innerText(), /the knee bent backwards/);
  await assert.rejects(segue("clips"), /has stopped: the knee bent backwards/);

  await page.getByRole("button", { name: "Copy a report" }).click();
  await page.getByRole("button", { name: "Copied" }).waitFor();
  const report = await page.evaluate(() => navigator.clipboard.readText());
  for (const part of ["Segue 9.9.9", "the knee bent backwards", "backend: webgl2", "lab=blend"]) assert.ok(report.includes(part), `${part} in\n${report}`);

  await page.getByRole("button", { name: "Reload with this state" }).click();
  await page.waitForFunction(() => window.segue && !window.panic);
  assert.match(page.url(), /\?lab=blend$/);
});

onBackend("webgl2", "trap outside of any call counts as a panic", async ({ open }) => {
  const opened = await open("", { prepare: standIn });
  await opened.page.evaluate(() => void setTimeout(() => { throw new WebAssembly.RuntimeError("unreachable"); }));
  await panelOf(opened.page).waitFor();
  assert.match(await panelOf(opened.page).innerText(), /unreachable/);
  opened.problems.length = 0;
});

// Fails when a trap by a failed allocation is shown as an error of Segue, and when another trap is
// not.
onBackend("webgl2", "trap by a failed allocation names the memory", async ({ open }) => {
  const prepare = async (page) => {
    await standIn(page);
    await page.addInitScript(() => { window.memory = { buffer: { byteLength: 3.9e9 } }; });
  };
  const opened = await open("", { prepare });
  await opened.page.evaluate(() => void setTimeout(() => { throw new WebAssembly.RuntimeError("unreachable"); }));
  await panelOf(opened.page).waitFor();
  const text = await panelOf(opened.page).innerText();
  assert.match(text, /not enough memory[^]*3900 MB[^]*remove clips/);
  assert.doesNotMatch(text, /error in Segue/);
  opened.problems.length = 0;

  const panicked = await open("", { prepare });
  await panicked.page.evaluate(() => { window.panic = "the knee bent backwards"; });
  await panelOf(panicked.page).waitFor();
  assert.match(await panelOf(panicked.page).innerText(), /error in Segue/);
});

onBackend("webgl2", "lost graphics context moves the app to a new canvas", async ({ open }) => {
  const { page } = await open("", { prepare: standIn });
  const moved = await page.evaluate(async () => {
    const old = document.getElementById("segue");
    const event = new Event("webglcontextlost", { cancelable: true });
    old.dispatchEvent(event);
    await new Promise((resolve) => setTimeout(resolve));
    window.app.tell("lost"); // as a lost WebGPU device is told
    await new Promise((resolve) => setTimeout(resolve));
    const now = document.getElementById("segue");
    const { canvases } = window.app;
    return [event.defaultPrevented, canvases.length, new Set(canvases).size, canvases.at(-1) === now, old.isConnected];
  });
  assert.deepEqual(moved, [true, 3, 3, true, false]);
});

onBackend("webgl2", "framed page answers its parent", async ({ open }) => {
  // The framing page is another one, because the policy of this page allows no frames in it.
  const course = (route) => route.fulfill({ contentType: "text/html", body: "<!doctype html><title>A course</title>" });
  const { page } = await open("", {
    wait: false,
    prepare: async (page) => {
      await standIn(page);
      await page.route(({ pathname, search }) => pathname === "/" && search === "", course);
    },
  });
  const heard = await page.evaluate(async () => {
    const heard = [];
    const waiting = new Map();
    const frame = document.createElement("iframe");
    window.addEventListener("message", ({ data }) => {
      if (data.event) heard.push(data);
      else waiting.get(data.id)(data);
    });
    const ask = (id, call, args) => new Promise((resolve) => {
      waiting.set(id, resolve);
      frame.contentWindow.postMessage({ segue: 1, id, call, args }, "*");
    });
    frame.src = "?lab=blend&embed=1";
    document.body.append(frame);
    await new Promise((resolve) => { frame.onload = resolve; });
    const answers = [await ask(1, "version"), await ask(2, "clips"), await ask(3, "set", [{ wrong: 1 }]), await ask(4, "constructor"), await ask(5, "on", ["change"])];
    frame.contentWindow.app.tell("change", { keys: ["lab"] });
    await ask(6, "clips");
    return { answers, heard };
  });
  assert.deepEqual(heard.answers, [
    { segue: 1, id: 1, result: "9.9.9" },
    { segue: 1, id: 2, result: [{ id: "walk" }] },
    { segue: 1, id: 3, error: "wrong: no such key" },
    { segue: 1, id: 4, error: 'There is no call "constructor"' },
    { segue: 1, id: 5, error: 'There is no call "on"' },
  ]);
  assert.deepEqual(heard.heard, [
    { segue: 1, event: "ready", detail: { version: "9.9.9" } },
    { segue: 1, event: "change", detail: { keys: ["lab"] } },
  ]);
});
