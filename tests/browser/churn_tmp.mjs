import process from "node:process";
import { close, openSegue } from "./segue.mjs";
const prepare = (page) => page.route("**/outline*.js", async (route) => {
  const response = await route.fetch();
  let source = await response.text();
  source = source.replace("handle.setOutline((text) => this.#update(JSON.parse(text)));", `handle.setOutline((text) => { const data = JSON.parse(text); const t = data.elements.find((e) => e.name === "Timeline" && e.role === "region"); const s = data.elements.find((e) => e.role === "text" && /frame/.test(e.name ?? "")); if (t) (window.places ??= []).push([s?.name, t.place.join()].join(" | ")); this.#update(data); });`);
  return route.fulfill({ response, body: source });
});
for (const q of ["compare=blend_window:30,15,10", "lab=blend"]) {
const { page, segue } = await openSegue("webgpu", q, { prepare });
await page.waitForTimeout(25000);
console.log((await page.evaluate(() => window.places)).join("\n"));
await page.context().close();
}
await close(); process.exit();
