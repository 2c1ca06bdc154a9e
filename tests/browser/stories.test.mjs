// Stories of people who use Segue: a teacher, a student, an engineer, somebody with a phone, and somebody
// without a mouse. They work through the page alone, by real mouse, keyboard and touch.

import assert from "node:assert/strict";
import { onBothBackends } from "./harness.mjs";
import { apart, striding, until } from "./help.mjs";

/**
 * Returns the place of the element with that role and name on the page, once it is there and no
 * longer moves.
 */
async function placeOf(page, role, name) {
  const element = page.getByRole(role, { name, exact: true }).first();
  let before = "";
  return until(`${role} ${name} stands still`, async () => {
    const box = (await element.count()) > 0 && (await element.boundingBox());
    const isStill = box && JSON.stringify(box) === before;
    before = JSON.stringify(box);
    return isStill && box;
  });
}

const middle = ({ x, y, width, height }) => [x + width / 2, y + height / 2];

/** Clicks an element with the real mouse. */
async function click(page, role, name, options) {
  await page.mouse.click(...middle(await placeOf(page, role, name)), options);
}

/** Returns a function that waits until a parameter has a value. */
const expecting = (segue) => (key, value) => until(`${key} is ${value}`, async () => (await segue("params"))[key] === value);

// Fails when the stage alone, the next lesson or the way back is out of a teacher's reach, and when
// the link that she hands out has the size of her projector.
onBothBackends("teacher presents a lesson and hands out its link", async ({ open }) => {
  const { page, segue } = await open("lesson=half_life&projector=on", { viewport: [1280, 720] });
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  await click(page, "button", "Copy link");
  const copied = await until("a link is copied", () => page.evaluate(() => navigator.clipboard.readText()));
  assert.match(copied, /lesson=half_life/);
  assert.doesNotMatch(copied, /projector/);
  const form = page.getByRole("form", { name: "Parameters" });
  assert.equal(await form.count(), 1);
  await page.keyboard.press("p");
  await until("the stage is alone", async () => (await form.count()) === 0);
  await page.keyboard.press("PageDown");
  await until("the next lesson is there", async () => !["half_life", ""].includes((await segue("params")).lesson));
  await page.keyboard.press("PageUp");
  await expecting(segue)("lesson", "half_life");
  await page.keyboard.press("Escape");
  await until("the page is whole again", async () => (await form.count()) === 1);
});

// Fails when a letter of a row assigns no clip, a slider does not follow the mouse, a number explains
// nothing or leads nowhere, and when a kept result is lost by a reload.
onBothBackends("student blends two files, asks what a number means and keeps the result", async ({ open }) => {
  const { page, segue, dropFile, drag, ready } = await open("lab=blend&play=off", { viewport: [1440, 900] });
  const is = expecting(segue);
  const clip = async (name) => until(`${name} is in the library`, async () => (await segue("clips")).find((clip) => clip.name === name)?.id);
  await dropFile("slow.bvh", striding({ hertz: 0.8, swing: 20 }));
  const slow = await clip("slow");
  await dropFile("fast.bvh", striding({ hertz: 1.5, swing: 45 }));
  const fast = await clip("fast");
  await is("b", fast);
  await click(page, "button", "fast as A");
  await is("a", fast);
  await is("b", slow);

  const before = await segue("pose", "result", 1.5);
  const track = await placeOf(page, "slider", "Blend window");
  const y = track.y + track.height - 8;
  await drag([track.x + track.width * 0.2, y], [track.x + track.width * 0.8, y]);
  await until("the window is longer", async () => (await segue("params")).blend_window > 60);
  await until("the result follows", async () => apart(before, await segue("pose", "result", 1.5)) > 1e-3);

  await segue("play");
  await click(page, "button", /^Velocity jump/);
  await click(page, "button", "Show the frame");
  await is("play", false);
  const { at } = (await segue("metrics")).velocity_jump_dps;
  await until("the playhead is there", async () => Math.abs((await segue("time")) - at) < 0.02);

  const count = (await segue("clips")).length;
  await click(page, "button", "Keep in library");
  const kept = await until("the result is kept", async () => {
    const clips = await segue("clips");
    return clips.length === count + 1 && clips.find(({ id }) => id.startsWith("blend("))?.id;
  });
  await until("it is stored", async () => (await page.getByText("Saved", { exact: true }).count()) > 0);
  await page.reload({ waitUntil: "commit" });
  await ready();
  await click(page, "button", "fast to slow as A");
  await is("a", kept);
  await until("it has its motion again", async () => (await segue("clips")).some(({ id, frames }) => id === kept && frames > 0));
});

// Fails when the menu of a row edits no clip, or a lab with many clips does not take one's own.
onBothBackends("engineer mirrors a clip and walks a graph of own clips", async ({ open }) => {
  const { page, segue, dropFile } = await open("lab=view&play=off", { viewport: [1440, 900] });
  await dropFile("walk.bvh", striding());
  const row = await placeOf(page, "button", "walk as A");
  await page.mouse.click(row.x + row.width + 60, row.y + row.height / 2, { button: "right" });
  await click(page, "menuitem", "Mirror");
  await until("its mirror image is there", async () => (await segue("clips")).some(({ id, frames }) => id.startsWith("edit(") && id.includes("mirror:on") && frames > 0));
  await click(page, "tab", "Graph");
  await expecting(segue)("lab", "graph");
  await click(page, "button", "My clips");
  const own = (await segue("clips")).find(({ name }) => name === "walk").id;
  await expecting(segue)("clips", own);
});

// Fails when the library of a phone does not scroll by a finger or takes the scroll for a choice, and
// when a comparison does not show its next pane by a swipe.
onBothBackends("phone's user scrolls the library and swipes through a comparison", async ({ open }) => {
  const { page, segue } = await open("compare=blend_window:30,10&play=off", { viewport: [390, 844] });
  const client = await page.context().newCDPSession(page);
  await client.send("Emulation.setTouchEmulationEnabled", { enabled: true, maxTouchPoints: 2 });
  const touch = (type, ...points) => client.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y]) => ({ x, y })) });
  const swipe = async ([x, y], [dx, dy], steps) => {
    // Sent at once, as a finger does not wait for the frames of the page.
    const sent = [touch("touchStart", [x, y])];
    for (let step = 1; step <= steps; step++) sent.push(touch("touchMove", [x + (dx * step) / steps, y + (dy * step) / steps]));
    await Promise.all([...sent, touch("touchEnd")]);
  };
  const tap = async (role, name) => {
    const place = middle(await placeOf(page, role, name));
    await touch("touchStart", place);
    await touch("touchEnd");
  };
  await until("the first pane is there", async () => (await page.getByText(/1 \/ 2/).count()) > 0);
  // A machine under load may take the finger for a slow one, which turns the camera.
  await until("the second pane is there", async () => {
    await swipe([300, 200], [-200, 0], 2);
    await page.waitForTimeout(1000);
    return (await page.getByText(/2 \/ 2/).count()) > 0;
  });

  const { a } = await segue("params");
  await tap("button", "Menu");
  await tap("menuitem", "Library");
  await placeOf(page, "button", "Open files…");
  const first = await placeOf(page, "button", "Run as A");
  await swipe([200, first.y + 20], [0, -120], 12);
  await until("the list has moved", async () => (await placeOf(page, "button", "Run as A")).y < first.y - 60);
  assert.equal((await segue("params")).a, a, "nothing was chosen");
});

// Fails when a clip cannot be chosen, a value set or the help read without a mouse.
onBothBackends("keyboard alone chooses a clip, sets a value and keeps the result", async ({ open }) => {
  const { page, segue } = await open("lab=blend&play=off", { viewport: [1440, 900] });
  const is = expecting(segue);
  /** Presses Tab, or Shift+Tab to go back, until that element has the keyboard. */
  const focus = async (role, name, key = "Tab") => {
    await placeOf(page, role, name);
    const wanted = await page.getByRole(role, { name, exact: true }).first().elementHandle();
    for (let press = 0; press < 120; press++) {
      await page.keyboard.press(key);
      if (await wanted.evaluate((element) => element === document.activeElement)) return;
    }
    throw new Error(`${key} does not reach ${role} ${name}`);
  };
  await focus("button", "Stand as B");
  await page.keyboard.press("Enter");
  await is("b", "idle");
  await focus("slider", "Blend window");
  for (let press = 0; press < 3; press++) await page.keyboard.press("ArrowRight");
  await is("blend_window", 33);
  const count = (await segue("clips")).length;
  await focus("button", "Keep in library", "Shift+Tab");
  await page.keyboard.press("Enter");
  await until("the result is kept", async () => (await segue("clips")).length === count + 1);
});
