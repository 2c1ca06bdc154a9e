// A short run of what `cargo xtask fuzz page` does for minutes.

import assert from "node:assert/strict";
import { fuzz } from "./fuzz.mjs";
import { onBackend } from "./harness.mjs";

// Fails when the page stops, shows a number that is none, or refuses something without a sentence.
onBackend("webgl2", "the page takes whatever comes", async ({ open, t }) => {
  assert.ok((await fuzz(open, 20261122, 40, (line) => t.diagnostic(line))) > 5);
});
