// Helpers of several tests: generated motion files, waiting for a state, and inspection of
// pictures.

import http from "node:http";
import { setTimeout as pause } from "node:timers/promises";
import { WAIT_TIMEOUT_MS, withTimeout } from "./segue.mjs";

/**
 * Polls a condition until it holds, and fails with `what` where it never does. Software rendering
 * is slow, so no test depends on a time.
 */
export async function until(what, ask, limitMs = WAIT_TIMEOUT_MS) {
  let isLate = false;
  const poll = async () => {
    while (!isLate) {
      const answer = await ask();
      if (answer) return answer;
      await pause(60);
    }
  };
  try {
    return await withTimeout(poll(), limitMs, () => `not yet: ${what}`);
  } finally {
    isLate = true;
  }
}

/**
 * Starts to measure how long the page's thread computes, and returns a function that returns the
 * seconds since then. They are those of the thread's own clock, which stands still while other
 * programs have the processor, so that a busy machine does not lengthen them.
 */
export async function computingTime(page) {
  const client = await page.context().newCDPSession(page);
  await client.send("Performance.enable", { timeDomain: "threadTicks" });
  const secs = async () => (await client.send("Performance.getMetrics")).metrics.find(({ name }) => name === "TaskDuration").value;
  const start = await secs();
  return async () => (await secs()) - start;
}

/**
 * Records the tasks of the page's thread. Returns a function that ends that, and returns their
 * processor times, the longest first, milliseconds. Other programs do not lengthen them.
 */
export async function tracedTasks(page) {
  const browser = page.context().browser();
  await browser.startTracing(page, { categories: ["disabled-by-default-devtools.timeline", "__metadata"] });
  return async () => {
    const { traceEvents } = JSON.parse((await browser.stopTracing()).toString());
    const mains = new Set(traceEvents.filter(({ name, args }) => name === "thread_name" && args.name === "CrRendererMain").map(({ pid, tid }) => `${pid} ${tid}`));
    const tasks = traceEvents.filter(({ name, pid, tid }) => name === "RunTask" && mains.has(`${pid} ${tid}`));
    return tasks.map(({ tdur = 0 }) => tdur / 1000).sort((a, b) => b - a);
  };
}

/**
 * Returns the contents of the browser's storage: the link, the ids of the clips, the SHA-256 of the
 * files.
 */
export const stored = (page) => page.evaluate(async () => {
  const database = await new Promise((resolve, reject) => Object.assign(indexedDB.open("segue"), { onsuccess: (event) => resolve(event.target.result), onerror: reject }));
  const all = (name, what, ...args) => new Promise((resolve) => { database.transaction(name).objectStore(name)[what](...args).onsuccess = (event) => resolve(event.target.result); });
  const [work, files] = [await all("work", "get", "latest"), await all("files", "getAllKeys")];
  database.close();
  const { query, entries } = work ? JSON.parse(work) : { query: "", entries: [] };
  return { query, ids: entries.map(({ id }) => id), files };
});

/** Waits until the stored link contains `part`. */
export const linkStored = (page, part) => until(`a link with ${part} is stored`, async () => (await stored(page)).query.includes(part));

/**
 * Drops a folder of files, each a path and a text. A transfer that a script makes cannot contain a
 * folder, so `webkitGetAsEntry` is replaced.
 */
export function dropFolder(page, files) {
  return page.evaluate(async (files) => {
    const file = (path, text) => {
      const name = path.split("/").at(-1);
      return { isFile: true, isDirectory: false, name, fullPath: path, file: (resolve) => resolve(new File([text], name)) };
    };
    const folder = (path) => {
      const below = files.filter(([name]) => name.startsWith(`${path}/`)).map(([name, text]) => [name.slice(path.length + 1), text]);
      const own = below.filter(([name]) => !name.includes("/")).map(([name, text]) => file(`${path}/${name}`, text));
      const folders = [...new Set(below.filter(([name]) => name.includes("/")).map(([name]) => name.split("/")[0]))];
      const parts = [own, folders.map((name) => folder(`${path}/${name}`)), []];
      const name = path.split("/").at(-1);
      return { isFile: false, isDirectory: true, name, fullPath: path, createReader: () => ({ readEntries: (resolve) => resolve(parts.shift()) }) };
    };
    const [root] = files[0][0].split("/").filter(Boolean);
    const whole = folder(`/${root}`);
    DataTransferItem.prototype.webkitGetAsEntry = () => whole;
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([], root));
    const canvas = document.getElementById("segue");
    for (const type of ["dragenter", "dragover", "dragover", "drop"]) {
      canvas.dispatchEvent(new DragEvent(type, { bubbles: true, cancelable: true, composed: true, clientX: 400, clientY: 300, dataTransfer }));
      await new Promise((resolve) => requestAnimationFrame(resolve));
    }
  }, files);
}

/** Returns a generator of random numbers from 0 to 1 by a seed (mulberry32). */
export function random(seed) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

// A body of 31 joints: [name, parent, offset in centimetres].
const BODY = [
  ["Hips", -1, [0, 0, 0]],
  ...side("Left", 1), ...side("Right", -1),
  ["LowerBack", 0, [0, 6, 0]], ["Spine", 11, [0, 11, 0]], ["Spine1", 12, [0, 11, 0]], ["Neck", 13, [0, 11, 0]], ["Neck1", 14, [0, 5, 0]], ["Head", 15, [0, 6, 0]],
  ...arm("Left", 1, 17), ...arm("Right", -1, 24),
];

function side(name, x) {
  const first = name === "Left" ? 1 : 6;
  return [
    [`${name}HipJoint`, 0, [0, 0, 0]], [`${name}UpLeg`, first, [9 * x, -4, 0]], [`${name}Leg`, first + 1, [0, -42, 0]],
    [`${name}Foot`, first + 2, [0, -42, 0]], [`${name}ToeBase`, first + 3, [0, -6, 13]],
  ];
}

function arm(name, x, first) {
  return [
    [`${name}Shoulder`, 13, [0, 6, 0]], [`${name}Arm`, first, [17 * x, 0, 0]], [`${name}ForeArm`, first + 1, [29 * x, 0, 0]],
    [`${name}Hand`, first + 2, [23 * x, 0, 0]], [`${name}FingerBase`, first + 3, [7 * x, 0, 0]],
    [`${name}HandIndex1`, first + 4, [5 * x, 0, 0]], [`${name}Thumb`, first + 3, [3 * x, 0, 4]],
  ];
}

/**
 * Returns a BVH file of a walk with `hertz` steps a second, and legs and arms that swing by `swing`
 * degrees.
 */
export function striding({ frames = 180, hertz = 1, swing = 30, fps = 60 } = {}) {
  const childrenOf = (parent) => BODY.flatMap(([, of], index) => (of === parent ? [index] : []));
  const order = [];
  const joint = (index, indent) => {
    order.push(index);
    const [name, parent, offset] = BODY[index];
    const children = childrenOf(index);
    return [
      `${indent}${parent < 0 ? "ROOT" : "JOINT"} ${name}`, `${indent}{`, `${indent}  OFFSET ${offset.join(" ")}`,
      `${indent}  CHANNELS ${parent < 0 ? "6 Xposition Yposition Zposition" : "3"} Zrotation Yrotation Xrotation`,
      ...(children.length ? children.flatMap((child) => joint(child, `${indent}  `)) : [`${indent}  End Site`, `${indent}  {`, `${indent}    OFFSET 0 0 3`, `${indent}  }`]),
      `${indent}}`,
    ];
  };
  const hierarchy = joint(0, "");
  const rows = Array.from({ length: frames }, (_, frame) => {
    const phase = (2 * Math.PI * hertz * frame) / fps;
    const row = [0, 92 + 2 * Math.cos(2 * phase), (120 * hertz * frame) / fps];
    for (const index of order) row.push(...turn(BODY[index][0], phase, swing));
    return row.map((value) => value.toFixed(3)).join(" ");
  });
  return Buffer.from(["HIERARCHY", ...hierarchy, "MOTION", `Frames: ${frames}`, `Frame Time: ${(1 / fps).toFixed(7)}`, ...rows, ""].join("\n"));
}

/** Returns the Z, Y, X rotation of a joint, degrees. */
function turn(name, phase, swing) {
  const forward = name.startsWith("Left") ? Math.sin(phase) : -Math.sin(phase);
  if (name.endsWith("UpLeg")) return [0, 0, -swing * forward];
  if (name.endsWith("Leg")) return [0, 0, swing * (1 - forward)];
  if (name.endsWith("ForeArm")) return [0, 0, -0.5 * swing];
  if (name.endsWith("Arm")) return [name.startsWith("Left") ? -75 : 75, 0, swing * forward];
  return [0, 3 * Math.sin(phase), 0];
}

/** Returns the greatest distance between the same joints of two answers of `pose()`, metres. */
export function apart(one, other) {
  return one.positions.reduce((most, value, index) => Math.max(most, Math.abs(value - other.positions[index])), 0);
}

/** Counts the pixels of a rectangle for which `test(red, green, blue)` holds. */
export function count(picture, [left, top, right, bottom], test) {
  let found = 0;
  for (let y = Math.round(top); y < bottom; y++) {
    for (let x = Math.round(left); x < right; x++) if (test(...picture.at(x, y))) found++;
  }
  return found;
}

/**
 * Returns whether a colour is the grey of the character: brighter than the background, and without
 * the hue of the lines.
 */
export const isClay = (red, green, blue) => Math.min(red, green, blue) > 70 && Math.max(red, green, blue) - Math.min(red, green, blue) < 40;

/** Returns the height of the panel with the timeline, which is lower in low windows. */
export const timelineOf = (height) => Math.min(214, Math.round(0.31 * height));

/** The height of the numbers below the stage of one pane at a desk, points. */
export const STRIP = 54;

/**
 * Returns the rectangle of the stage in a window of at least 960 points, without the title at its
 * top and the numbers at its bottom.
 */
export const stageOf = ({ width, height }) => [248, 48 + 40, width - 288, height - timelineOf(height) - STRIP - 8];

/**
 * Starts a server of another origin. Playwright's own answers would have CORS headers, so this is a
 * real one.
 */
export async function elsewhere(answers, body) {
  const server = http.createServer(async (request, response) => {
    const { status = 200, cors = true, after = 0, type = "application/octet-stream", text = "" } = answers[request.url] ?? { status: 404 };
    await new Promise((resolve) => setTimeout(resolve, after));
    response.writeHead(status, { "content-type": type, ...(cors && { "access-control-allow-origin": "*" }) }).end(text);
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  try {
    await body(`http://127.0.0.1:${server.address().port}`);
  } finally {
    server.closeAllConnections();
    server.close();
  }
}
