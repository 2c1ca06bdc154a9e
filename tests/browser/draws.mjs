// Measures what each WebGL 2 call of a frame takes where the browser draws in software:
//   node tests/browser/draws.mjs [--query "lab=blend"] [--size 1280x800]
// Prints the calls of one frame in their order (program, viewport, scissor, arguments, ms), and the
// sum of each frame of five seconds. A call is waited for by reading a pixel, so the sums are those
// of the work, without what the browser does for a frame itself.

import process from "node:process";
import { parseArgs } from "node:util";
import { close, openSegue } from "./segue.mjs";

const { values } = parseArgs({ options: { query: { type: "string", default: "lab=blend" }, size: { type: "string", default: "1280x800" } } });

/** Time for the pipelines and bodies to be made, and time to measure, ms. */
const SETTLING = 4000;
const MEASURED = 5000;

/** Runs in the page before its scripts: times the calls between `calls.on = true` and `false`. */
function watch() {
  const kind = WebGL2RenderingContext.prototype;
  const calls = (window.calls = { on: false, frame: 0, rows: [] });
  const [READ, DRAW] = [kind.READ_FRAMEBUFFER, kind.DRAW_FRAMEBUFFER];
  const { bindFramebuffer, readPixels, useProgram } = kind;
  const programs = new Map();
  let [program, read, own] = [0, null, null];
  kind.useProgram = function (used) {
    if (!programs.has(used)) programs.set(used, programs.size);
    program = programs.get(used);
    return useProgram.call(this, used);
  };
  kind.bindFramebuffer = function (target, buffer) {
    if (target !== DRAW) read = buffer;
    return bindFramebuffer.call(this, target, buffer);
  };
  /** Waits for all calls so far: reads a pixel of a buffer of its own. */
  const wait = (gl) => {
    const packed = gl.getParameter(gl.PIXEL_PACK_BUFFER_BINDING);
    if (packed) gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
    own ??= gl.createFramebuffer();
    bindFramebuffer.call(gl, READ, own);
    if (gl.checkFramebufferStatus(READ) !== gl.FRAMEBUFFER_COMPLETE) {
      const pixel = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, pixel);
      gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA8, 1, 1);
      gl.framebufferRenderbuffer(READ, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, pixel);
      gl.bindRenderbuffer(gl.RENDERBUFFER, null);
    }
    readPixels.call(gl, 0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    bindFramebuffer.call(gl, READ, read);
    if (packed) gl.bindBuffer(gl.PIXEL_PACK_BUFFER, packed);
  };
  for (const name of [
    "drawArrays", "drawElements", "drawArraysInstanced", "drawElementsInstanced", "blitFramebuffer", "clear", "clearBufferfv", "clearBufferfi",
    "texSubImage2D", "bufferSubData",
  ]) {
    const real = kind[name];
    kind[name] = function (...args) {
      if (!calls.on) return real.apply(this, args);
      const [x, y, width, height] = this.getParameter(this.SCISSOR_TEST) ? this.getParameter(this.SCISSOR_BOX) : this.getParameter(this.VIEWPORT);
      wait(this);
      const start = performance.now();
      const result = real.apply(this, args);
      wait(this);
      calls.rows.push({
        frame: calls.frame,
        ms: performance.now() - start,
        words: [name, `program ${program}`, `${width}×${height} at ${x},${y}`, args.filter((value) => typeof value === "number").join(" ")],
      });
      return result;
    };
  }
  const request = window.requestAnimationFrame;
  window.requestAnimationFrame = (callback) => request.call(window, (time) => {
    calls.frame += 1;
    callback(time);
  });
}

try {
  const { page } = await openSegue("webgl2", values.query, {
    viewport: values.size.split("x").map(Number),
    prepare: (page) => page.addInitScript(watch),
  });
  await page.waitForTimeout(SETTLING);
  await page.evaluate(() => { window.calls.on = true; });
  await page.waitForTimeout(MEASURED);
  const rows = await page.evaluate(() => {
    window.calls.on = false;
    return window.calls.rows;
  });
  // The first and the last frame may be cut.
  const frames = [...new Set(rows.map(({ frame }) => frame))].slice(1, -1);
  if (!frames.length) throw new Error("no whole frame was drawn: is the page at rest?");
  const of = (frame) => rows.filter((row) => row.frame === frame);
  for (const { words, ms } of of(frames[0])) console.log(`${ms.toFixed(1).padStart(6)} ms  ${words.join("  ")}`);
  const sums = frames.map((frame) => of(frame).reduce((sum, { ms }) => sum + ms, 0)).sort((a, b) => a - b);
  console.log(`${sums.length} frames: ${sums[0].toFixed(0)} to ${sums.at(-1).toFixed(0)} ms, median ${sums[Math.floor(sums.length / 2)].toFixed(0)} ms`);
} finally {
  await close();
  process.exit();
}
