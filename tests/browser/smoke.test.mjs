import assert from "node:assert/strict";
import { onBothBackends } from "./harness.mjs";

onBothBackends("page starts and draws", async ({ open, backend }) => {
  const { page, segue, pixels } = await open("", { scale: 1 });
  assert.equal((await segue("stats")).backend, backend);
  assert.equal(await page.locator("#loading").count(), 0, "the loading state is gone");
  assert.equal(await page.locator(".veil").count(), 0, "no panel shows a failure");
  const { width, height, colours, at } = await pixels();
  assert.deepEqual([width, height], [1280, 800]);
  assert.ok(colours() > 3, "the canvas shows more than one flat colour");
  const [bar, library, parameters, timeline] = [[2, 2], [2, 300], [width - 2, 300], [2, height - 2]].map(([x, y]) => at(x, y));
  for (const panel of [library, parameters, timeline]) assert.deepEqual(panel, bar, "all panels have one ground");
  assert.notDeepEqual(bar, at(width / 2, 120), "which is not that of the stage");
});
