// What the page does for those who do not see it, want little motion, or hand it in.

import assert from "node:assert/strict";
import { onBackend, onBothBackends } from "./harness.mjs";
import { until } from "./help.mjs";

// Fails when what is drawn on the canvas is not told to screen readers.
onBackend("webgl2", "a screen reader hears what has the focus and what was done", async ({ open }) => {
  const { page } = await open("lab=blend&play=off", { viewport: [960, 640] });
  const spoken = () => page.evaluate(() => document.getElementById("spoken").textContent);
  const heard = new Set();
  for (let press = 0; press < 3; press++) {
    await page.keyboard.press("Tab");
    heard.add(await until("something new is said", async () => {
      const said = await spoken();
      return !heard.has(said) && said;
    }));
  }
});

// Fails when the page moves by itself although the system is set to little motion.
onBackend("webgl2", "who wants little motion starts it by hand", async ({ open }) => {
  const { segue } = await open("", { viewport: [640, 480], motion: "reduce" });
  const before = await segue("time");
  assert.equal((await segue("params")).play, false);
  assert.equal(await segue("time"), before);
  await segue("play");
  await until("it plays", async () => (await segue("time")) !== before);
});

// Fails when the picture, a setting, a number or the link is missing.
onBothBackends("a report holds the picture, what was set, the numbers and the link", async ({ open }) => {
  const { segue } = await open("compare=a:walk,run&lab=view&play=off", { viewport: [960, 640] });
  await until("both are measured", async () => Object.values(await segue("metrics")).length > 3);
  const report = await segue("report");
  const [, picture] = report.match(/!\[[^\]]*\]\(data:image\/jpeg;base64,([^)]+)\)/);
  assert.ok(picture.length > 4_000, `${picture.length} characters of picture`);
  assert.match(report, /\| \| Walk \| Run \|/);
  assert.match(report, /\| Foot slide, cm \| [\d.]+ \| [\d.]+ \|/);
  assert.ok(report.includes("compare=a:walk,run") && report.includes("Segue 0."), report.replace(picture, "…"));
});
