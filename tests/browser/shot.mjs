// Takes a picture of the page:
//   node tests/browser/shot.mjs --query "lab=blend" --size 1440x900 --backend webgl2 --out x.png [--theme light] [--scale 2]
//                               [--wait 1500] [--eval "await segue.set({ lab: 'graph' })"]
// --eval runs in the page before the wait, with the API as `segue`, and its value is printed.

import { writeFile } from "node:fs/promises";
import process from "node:process";
import { parseArgs } from "node:util";
import { close, openSegue } from "./segue.mjs";

const { values } = parseArgs({
  options: {
    query: { type: "string", default: "" },
    size: { type: "string", default: "1440x900" },
    backend: { type: "string", default: "webgl2" },
    theme: { type: "string", default: "dark" },
    scale: { type: "string", default: "1" },
    out: { type: "string", default: "shot.png" },
    wait: { type: "string", default: "500" },
    eval: { type: "string" },
  },
});

try {
  const { page, ready, screenshot, log, problems } = await openSegue(values.backend, values.query, {
    viewport: values.size.split("x").map(Number),
    scale: Number(values.scale),
    theme: values.theme,
    wait: false,
  });
  await ready().catch((error) => console.error(error.message)); // a picture of what went wrong is worth taking too
  if (values.eval) {
    const result = await page.evaluate(`window.segueReady.then(async (segue) => { return await (async () => { ${statement(values.eval)} })(); })`);
    if (result !== undefined) console.log(JSON.stringify(result, null, 2));
  }
  await page.waitForTimeout(Number(values.wait));
  await writeFile(values.out, await screenshot());
  for (const line of [...log.filter((line) => /^(error|warning):/.test(line)), ...problems]) console.error(line);
} finally {
  await close();
  process.exit();
}

/**
 * Returns the body of a function: an expression gets a `return`, several statements stay as they
 * are.
 */
function statement(code) {
  return /;|\breturn\b/.test(code) ? code : `return ${code}`;
}
