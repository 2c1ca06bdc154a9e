// Fills the page's memory, and prints the page's notices: four BVH files of about 500 MB of zeros,
// and twice a stream that is longer than a file may be. Ends with an error when the page stops,
// when a refusal does not name the memory, the file and what to remove, and when the second stream
// makes the page larger. Takes a minute or two, 8 GB of memory and 3 GB of disk.
//
//   node tests/browser/memory.mjs [--megabytes 490] [--files 4]

import assert from "node:assert/strict";
import http from "node:http";
import process from "node:process";
import { parseArgs } from "node:util";
import { striding, until } from "./help.mjs";
import { close, openSegue } from "./segue.mjs";

const { values } = parseArgs({ options: { megabytes: { type: "string", default: "490" }, files: { type: "string", default: "4" } } });
const [megabytes, files] = [Number(values.megabytes), Number(values.files)];
const WAIT_MS = 300_000;
const rows = {};

try {
  await fill();
  await stream();
} finally {
  console.table(rows);
  await close();
}
process.exit();

/** Drops one file of zeros after the other. */
async function fill() {
  const { page, segue } = await openSegue("webgl2", "lab=view&play=off", { viewport: [960, 640] });
  await listen(page);
  await note("at first", segue);
  let refused = 0;
  for (let index = 0; index < files; index++) {
    const name = `zeros${index}.bvh`;
    const started = Date.now();
    await dropZeros(page, name);
    const clip = await until(`${name} is read or refused`, async () => {
      if (await page.locator(".veil").count()) throw new Error(`the page has stopped: ${await page.locator(".veil").innerText()}`);
      const said = (await errors(page)).find((message) => message.includes(name));
      const clip = (await segue("clips")).find((clip) => clip.name === `zeros${index}` && clip.frames > 0);
      return said ?? clip;
    }, WAIT_MS);
    const isRead = typeof clip !== "string";
    await note(`${name} ${isRead ? "read" : "refused"}, ${((Date.now() - started) / 1000).toFixed(0)} s`, segue);
    if (isRead) {
      await segue("set", {}); // what is made of it
      await note(`${name} shown`, segue);
      continue;
    }
    refused += 1;
    console.log(clip);
    assert.match(clip, new RegExp(`There is no memory for ${name} .* Remove clips that you do not need; the largest are zeros`));
  }
  assert.ok(refused > 0, "one of them has no room");
  const { frames } = await segue("stats");
  await segue("play");
  await until("it draws", async () => (await segue("stats")).frames > frames + 3);
  await page.context().close();
}

/** Opens the address of an endless file twice. */
async function stream() {
  const piece = Buffer.alloc(1 << 20, "0 0 0 0 0 0 0 0 0 0\n");
  const server = http.createServer(async (request, response) => {
    response.writeHead(200, { "content-type": "application/octet-stream", "access-control-allow-origin": "*" });
    response.write("HIERARCHY\n");
    let [open, goOn] = [true, () => {}];
    response.on("drain", () => goOn());
    response.on("close", () => {
      open = false;
      goOn();
    });
    for (let sent = 0; open && sent < 1024; sent++) if (!response.write(piece)) await new Promise((resolve) => (goOn = resolve));
    response.end();
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const at = `http://127.0.0.1:${server.address().port}`;
  try {
    const { page, segue } = await openSegue("webgl2", "lab=view&play=off", { viewport: [960, 640] });
    await listen(page);
    await segue("set", {});
    const sizes = [await note("before a stream", segue)];
    for (const name of ["one.bvh", "two.bvh"]) {
      await segue("set", { src: `${at}/${name}` });
      await until(`${name} is refused`, async () => (await errors(page)).find((message) => message.includes(name)), WAIT_MS);
      sizes.push(await note(`${name} refused`, segue));
    }
    for (const message of await errors(page)) console.log(message);
    assert.ok(sizes[1] - sizes[0] < 64e6, `the first stream made the page larger by ${(sizes[1] - sizes[0]) / 1e6} MB`);
    assert.ok(sizes[2] - sizes[1] < 8e6, `the second stream made the page larger by ${(sizes[2] - sizes[1]) / 1e6} MB`);
    await page.context().close();
  } finally {
    server.closeAllConnections();
    server.close();
  }
}

function listen(page) {
  return page.evaluate(() => {
    window.errors = [];
    window.segue.on("error", ({ message }) => window.errors.push(message));
  });
}

function errors(page) {
  return page.evaluate(() => window.errors);
}

async function note(what, segue) {
  const { wasm_bytes } = await segue("stats");
  rows[what] = { "wasm MB": Math.round(wasm_bytes / 1e6), clips: (await segue("clips")).filter(({ sha256 }) => sha256).length };
  return wasm_bytes;
}

/**
 * Drops a file of zeros that is made in the page. Each differs from the others in its first row.
 */
function dropZeros(page, name) {
  const head = striding({ frames: 1 }).toString();
  const channels = head.trim().split("\n").at(-1).split(" ").length;
  const row = `${"0 ".repeat(channels - 1)}0\n`;
  const rowsOfPiece = Math.ceil((1 << 20) / row.length);
  const pieces = Math.floor((megabytes * 1e6) / (rowsOfPiece * row.length));
  const start = head.replace("Frames: 1\n", `Frames: ${rowsOfPiece * pieces + 1}\n`).replace(/Hips/, `Hips_${name.replace(/\W/g, "_")}`);
  return page.evaluate(async ([name, start, row, rowsOfPiece, pieces]) => {
    const piece = new Blob([row.repeat(rowsOfPiece)]);
    const transfer = new DataTransfer();
    transfer.items.add(new File([start, ...Array.from({ length: pieces }, () => piece)], name));
    const canvas = document.getElementById("segue");
    for (const type of ["dragenter", "dragover", "dragover", "drop"]) {
      canvas.dispatchEvent(new DragEvent(type, { bubbles: true, cancelable: true, composed: true, clientX: 400, clientY: 300, dataTransfer: transfer }));
      await new Promise((resolve) => requestAnimationFrame(resolve));
    }
  }, [name, start, row, rowsOfPiece, pieces]);
}
