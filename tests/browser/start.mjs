// A measurement without bounds: the start of a page in a new browser, in milliseconds since the
// page was asked for. "Frame" is the time of the first frame on screen, "ready" that from which on
// the page answers input and its API; medians. `--mbit` slows the network down, with 40 ms to each
// answer, and is meant for a folder that `cargo xtask serve --dist` has compressed. A page of
// another build, served at an address of its own, is measured in turns with it.
//
//   node tests/browser/start.mjs [--mbit 8] [--rounds 5] [--query lab=view] [--other ADDRESS]

import process from "node:process";
import { parseArgs } from "node:util";
import { BACKENDS, close, endBrowser, openSegue } from "./segue.mjs";

const { values } = parseArgs({
  options: { mbit: { type: "string" }, rounds: { type: "string", default: "5" }, query: { type: "string", default: "" }, other: { type: "string" } },
});
const LATENCY_MS = 40;

const times = {};
for (let round = 0; round < Number(values.rounds); round++) {
  for (const backend of BACKENDS) {
    for (const [name, base] of Object.entries({ here: undefined, ...(values.other && { other: values.other }) })) {
      (times[`${backend}: ${name}`] ??= []).push(await started(backend, base));
    }
  }
}
await close();
const middle = (numbers) => Math.round(numbers.sort((one, other) => one - other)[numbers.length >> 1]);
console.table(Object.fromEntries(Object.entries(times).map(([name, all]) => [name, { frame: middle(all.map(([frame]) => frame)), ready: middle(all.map(([, ready]) => ready)) }])));
process.exit();

/** Starts a page in a new browser, and returns the two times. */
async function started(backend, base) {
  const { page, ready } = await openSegue(backend, values.query, { viewport: [1440, 900], scale: 0.5, base, wait: false, prepare });
  await ready();
  const outcome = await page.evaluate(() => [window.firstFrame, performance.now()]);
  await endBrowser(backend);
  return outcome;
}

async function prepare(page) {
  await page.addInitScript(() => {
    const isShown = () => document.readyState !== "loading" && !document.getElementById("loading");
    const watching = new MutationObserver(() => {
      if (!isShown()) return;
      window.firstFrame = performance.now();
      watching.disconnect();
    });
    watching.observe(document, { childList: true, subtree: true });
  });
  if (!values.mbit) return;
  const client = await page.context().newCDPSession(page);
  await client.send("Network.enable");
  const bytesPerSec = Number(values.mbit) * 125_000;
  await client.send("Network.emulateNetworkConditions", { offline: false, latency: LATENCY_MS, downloadThroughput: bytesPerSec, uploadThroughput: bytesPerSec });
}
