import assert from "node:assert/strict";
import { onBothBackends } from "./harness.mjs";

onBothBackends("the page starts and draws", async ({ open, backend }) => {
  const opened = await open("", { wait: false });
  const { page, log, pixels } = opened;
  const outcome = await opened.ready().catch((error) => String(error));
  if (outcome !== true) {
    // Until the app brings its API, the page says exactly that, and the app draws all the same.
    assert.match(outcome, /exports no SegueHandle/, log.join("\n"));
    await page.waitForTimeout(1000);
  } else {
    assert.equal((await opened.segue("stats")).backend, backend);
  }
  assert.equal(await page.locator("#loading").count(), 0, "the loading state is gone");
  assert.equal(await page.locator(".veil").count(), 0, "no panel says that something went wrong");
  const { width, height, colours } = await pixels();
  assert.deepEqual([width, height], [1280, 800]);
  assert.ok(colours() > 3, "the canvas shows more than one flat colour");
});
