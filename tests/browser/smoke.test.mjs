import assert from "node:assert/strict";
import { onBothBackends } from "./harness.mjs";

onBothBackends("page starts and draws", async ({ open, backend }) => {
  const { page, segue, pixels } = await open();
  assert.equal((await segue("stats")).backend, backend);
  assert.equal(await page.locator("#loading").count(), 0, "the loading state is gone");
  assert.equal(await page.locator(".veil").count(), 0, "no panel shows a failure");
  const { width, height, colours } = await pixels();
  assert.deepEqual([width, height], [1280, 800]);
  assert.ok(colours() > 3, "the canvas shows more than one flat colour");
});
