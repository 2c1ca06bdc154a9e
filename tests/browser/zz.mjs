import { openSegue } from "./segue.mjs";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { until } from "./help.mjs";
const CLI = "/work/t/main/debug/segue";
const cases = [["blend","walk","run"],["transition","walk","run"],["loop","walk"],["graph","walk","walk","run"],["register","walk","run"],["speed","walk","run"],["layers","walk","run"],["path","walk"],["blend","walk","run","--set","foot_lock=on","--set","blend_window=44"],["transition","run","walk","--set","method=dead"],["edit","walk","--set","mirror=on"],["view","run"],["in_place","walk"],["match"]];
const { page, segue } = await openSegue("webgpu", "play=off", { base: process.env.BASE });
for (const [i, c] of cases.entries()) {
  const out = `/work/try/cli/${i}.bvh`;
  try {
    const said = execFileSync(CLI, [...c, "-o", out, "--print-link"], { encoding: "utf8", stdio: ["ignore","pipe","pipe"] });
    const link = said.trim().split("\n").at(-1);
    const query = new URL(link).search;
    const url = new URL(process.env.BASE + query);
    const values = Object.fromEntries(url.searchParams);
    await page.goto(`${process.env.BASE}${query}&play=off`); 
    await page.evaluate(() => window.segueReady.then(() => true));
    await until("done", async () => (await segue("stats")).jobs.length === 0);
    const got = await segue("export", "result", "bvh");
    const want = readFileSync(out);
    console.log(c.join(" "), query, want.length, got.length, Buffer.compare(want, got) === 0 ? "EQUAL" : "DIFFERENT");
    if (Buffer.compare(want, got)) { const a = want.toString().split("\n"), b = got.toString().split("\n"); const at = a.findIndex((l, k) => l !== b[k]); console.log(a.length, b.length, at, a[at]?.slice(0,150), "|", b[at]?.slice(0,150)); console.log(a.filter((l,k)=>l!==b[k]).length); }
  } catch (e) { console.log(c.join(" "), "ERR", String(e.stderr ?? e).slice(0, 300)); }
}
process.exit(0);
