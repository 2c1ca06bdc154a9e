// Tests of the panels: a slider under the mouse, panes side by side, a phone, and a page at rest.

import assert from "node:assert/strict";
import { setTimeout as pause } from "node:timers/promises";
import { onBothBackends } from "./harness.mjs";
import { apart, count, isClay, stageOf, until } from "./help.mjs";

const DESK = { viewport: [1000, 700] };

const isAccent = (red, green, blue) => green > 150 && green - red > 60 && green - blue > 20;
const isWhite = (...rgb) => Math.min(...rgb) > 225;

/**
 * Returns the positions on the first slider of the right panel: the start of the filled part, the
 * handle, the end of the track.
 */
function firstSlider(picture) {
  const [left, right] = [picture.width - 288 + 20, picture.width - 16]; // past the rounded end
  for (let y = 60; y < picture.height - 214; y++) {
    let x = left;
    while (x < right && isAccent(...picture.at(x, y))) x++;
    if (x - left < 20) continue;
    let handle = x;
    while (handle < right && !isWhite(...picture.at(handle, y))) handle++;
    let end = handle;
    while (end < right && isWhite(...picture.at(end, y))) end++;
    assert.ok(end < right && end - handle > 4, "a handle ends the filled part");
    return { y: y + 1, left, right, handle: (handle + end) / 2 };
  }
  throw new Error("no slider in the right panel");
}

// Fails when the mouse does not reach the slider, when the result is not computed again, and when a
// drag is more than one step of undo.
onBothBackends("dragging the blend window changes the result, and undo takes it back in one step", async ({ open }) => {
  const { page, segue, drag, pixels } = await open("lab=blend&play=off", { scale: 1, ...DESK });
  await segue("set", {});
  assert.equal((await segue("params")).blend_window, 30);
  const [before, metrics] = [await segue("pose", "result", 2.4), await segue("metrics")];
  const { y, left, right, handle } = firstSlider(await pixels());
  await drag([handle, y], [left + (right - left) * 0.6, y], 8);
  const dragged = await until("the blend window is wider", async () => {
    const { blend_window: frames } = await segue("params");
    return frames > 75 && frames;
  });
  await segue("set", {});
  assert.ok(apart(await segue("pose", "result", 2.4), before) > 1e-3, "another pose");
  assert.notDeepEqual(await segue("metrics"), metrics);
  assert.ok(firstSlider(await pixels()).handle > handle + 60, "the handle went along");

  await page.keyboard.press("Control+z");
  await until("undo brings 30 frames back", async () => (await segue("params")).blend_window === 30);
  await segue("set", {});
  assert.ok(apart(await segue("pose", "result", 2.4), before) < 1e-6, "the pose of before");
  await page.keyboard.press("Control+Shift+z");
  await until("redo", async () => (await segue("params")).blend_window === dragged);
});

// Fails when a pane is missing, empty, or the same as its neighbour.
onBothBackends("three panes have values and characters of their own", async ({ open }) => {
  const { segue, pixels } = await open("compare=blend_window:30,15,10&play=off", { scale: 1, ...DESK });
  await segue("set", {});
  for (const [name, { panes, value }] of Object.entries(await segue("metrics"))) {
    assert.equal(panes.length, 3, name);
    assert.equal(panes[0], value, name);
  }
  const { velocity_jump_dps: seam } = await segue("metrics");
  assert.equal(new Set(seam.panes).size, 3, `the seams differ: ${seam.panes}`);
  const shortened = await until("the panes differ somewhere", async () => {
    for (let t = 1.8; t < 3; t += 0.1) {
      const [first, second, third] = await Promise.all([0, 1, 2].map((pane) => segue("pose", `result:${pane}`, t)));
      if (apart(first, second) > 0.01 && apart(second, third) > 0.001) return t;
    }
  });
  await segue("seek", shortened);
  await assert.rejects(segue("pose", "result:3", 0), /found `result:3`/);

  const clay = await until("a character in each pane", async () => {
    const picture = await pixels();
    const [left, top, right, bottom] = stageOf(picture);
    const width = (right - left) / 3;
    const counts = [0, 1, 2].map((pane) => count(picture, [left + pane * width + 4, top, left + (pane + 1) * width - 4, bottom], isClay));
    return counts.every((clay) => clay > 1500) && counts;
  });
  await segue("set", { compare: "" });
  const { velocity_jump_dps: alone } = await segue("metrics");
  assert.equal(alone.panes.length, 1, `one pane is left of ${clay}`);
});

// Fails when a frame is requested although nothing changes, which drains batteries.
onBothBackends("page at rest draws nothing", async ({ open }) => {
  const { segue } = await open("lab=blend&play=off", DESK);
  await segue("set", {});
  const drawnIn = async (ms) => {
    const { frames } = await segue("stats");
    await pause(ms);
    return (await segue("stats")).frames - frames;
  };
  await until("it comes to rest", async () => (await drawnIn(1500)) === 0);
  assert.equal(await drawnIn(1500), 0);
  await segue("play");
  await until("it draws again when it plays", async () => (await drawnIn(300)) > 0);
  await segue("pause");
  await until("and rests again", async () => (await drawnIn(1500)) === 0);
});

// Fails when a phone shows the columns of the wide layout, all three panes, or something wider than
// its screen.
onBothBackends("phone shows one pane, and the whole page", async ({ open }) => {
  const [width, height] = [390, 844];
  const { page, segue, pixels, log } = await open("compare=blend_window:30,15,10&play=off", { scale: 1, viewport: [width, height] });
  await segue("set", {});
  const size = await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.scrollHeight, document.getElementById("segue").clientWidth]);
  assert.deepEqual(size, [width, height, width]);
  const stage = [0, 48 + 40, width - 100, 48 + (height - 48) / 2 - 100]; // between title, buttons and numbers
  const picture = await until("the character is drawn", async () => {
    const picture = await pixels();
    return count(picture, stage, isClay) > 3000 && picture;
  });
  // One character has the colour of clay in one run of columns.
  const columns = Array.from({ length: stage[2] }, (_, x) => count(picture, [x, stage[1], x + 1, stage[3]], isClay) > 3);
  const runs = columns.filter((clay, x) => clay && !columns[x - 1]).length;
  assert.ok(runs >= 1 && runs <= 2, `${runs} separate characters`);
  assert.ok(count(picture, [0, height - 200, width, height], isAccent) > 50, "the parameters stand below");
  assert.deepEqual(log.filter((line) => line.startsWith("error")), []);
});

// Fails when egui does not know the places of the widgets of panels that stand still, and when a
// change by a call is not shown while they do.
onBothBackends("panels that stand still while the motion plays take a click and show a change", async ({ open }) => {
  const { page, segue } = await open("lab=blend", { viewport: [1440, 900] });
  const told = () => page.evaluate(() => document.getElementById("outline")?.textContent);
  const standStill = () => until("ten frames pass of which the page is told nothing", async () => {
    const [{ frames }, text] = [await segue("stats"), await told()];
    await until("ten frames", async () => (await segue("stats")).frames >= frames + 10);
    return text && (await told()) === text;
  });
  await standStill();
  const { x, y, width, height } = await page.getByRole("tab", { name: "Loop", exact: true }).boundingBox();
  await page.mouse.click(x + width / 2, y + height / 2);
  await until("the click opens the lab", async () => (await segue("params")).lab === "loop");
  await standStill();
  await segue("set", { lab: "view", a: "run" });
  await until("the tab of the other lab is selected", async () => (await page.getByRole("tab", { name: "View", exact: true, selected: true }).count()) > 0);
});
