// A short run of `cargo xtask fuzz page`.

import assert from "node:assert/strict";
import { fuzz } from "./fuzz.mjs";
import { onOneBackend } from "./harness.mjs";

// Fails when the page stops, shows a number that is not finite, or refuses something without a
// sentence.
onOneBackend("page survives random input", async ({ open, t }) => {
  assert.ok((await fuzz(open, 20261122, 40, (line) => t.diagnostic(line))) > 5);
});
