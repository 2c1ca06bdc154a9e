// Tests that the command line makes what the page makes.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import process from "node:process";
import { fileURLToPath } from "node:url";
import { onOneBackend } from "./harness.mjs";
import { striding, until } from "./help.mjs";

/** The program, which `cargo xtask test browser` has built; otherwise cargo builds it. */
const SEGUE = process.env.SEGUE_PROGRAM ? [process.env.SEGUE_PROGRAM] : ["cargo", "run", "--quiet", "--package", "segue-cli", "--"];

const COMMANDS = [
  ["view", "run"],
  ["blend", "walk", "run", "--set", "blend_window=44", "--set", "foot_lock=on"],
  ["transition", "run", "walk", "--set", "method=dead"],
  ["speed", "walk", "run"],
  ["loop", "walk"],
  ["layers", "walk", "run"],
  ["register", "walk", "run"],
  ["path", "walk"],
  ["graph", "walk", "walk", "run"],
  ["edit", "walk", "--set", "mirror=on"],
];

/** Returns the place and the text of the first lines that differ. */
const firstDifference = (one, other) => {
  const [lines, others] = [one, other].map((bytes) => bytes.toString().split("\n"));
  const at = lines.findIndex((line, index) => line !== others[index]);
  return at < 0 ? "" : `line ${at + 1}: ${lines[at].slice(0, 120)} | ${others[at]?.slice(0, 120)}`;
};

// Fails when a function of real numbers has other bits in WebAssembly than on this machine.
onOneBackend("results of the command line are those of the page, bit for bit", async ({ open }) => {
  const folder = mkdtempSync(join(tmpdir(), "segue-"));
  try {
    const fetched = [];
    const prepare = (page) => void page.context().on("request", (request) => fetched.push(new URL(request.url()).pathname));
    const { page, segue, load, ready } = await open("play=off", { viewport: [640, 480], prepare });
    const own = join(folder, "own.bvh");
    writeFileSync(own, striding({ frames: 90, swing: 33 }));
    const run = (command, out) => {
      const [program, ...before] = SEGUE;
      const said = execFileSync(program, [...before, ...command, "-o", out, "--print-link"], { encoding: "utf8", cwd: fileURLToPath(new URL("../..", import.meta.url)) });
      return new URL(said.trim().split("\n").at(-1)).search;
    };
    for (const [index, command] of COMMANDS.entries()) {
      const out = join(folder, `${index}.bvh`);
      const query = run(command, out);
      await page.goto(`${page.url().split("?")[0]}${query}&play=off`, { waitUntil: "commit" });
      await ready();
      await until(`${command} is computed`, async () => (await segue("stats")).jobs.length === 0);
      const [made, shown] = [readFileSync(out), await segue("export", "result", "bvh")];
      assert.ok(made.equals(shown), `${command.join(" ")}: ${firstDifference(made, shown)}`);
    }
    // A file of the user's, in another rig than the page's clips.
    const { clips: [clip] } = await load("own.bvh", readFileSync(own));
    await segue("set", { lab: "transition", a: clip.id, b: "run" });
    const out = join(folder, "own-out.bvh");
    run(["transition", own, "run"], out);
    const [made, shown] = [readFileSync(out), await segue("export", "result", "bvh")];
    assert.ok(made.equals(shown), firstDifference(made, shown));
    // A long one, which a worker writes with a program that the page fetches for it.
    const long = join(folder, "long.bvh");
    writeFileSync(long, striding({ frames: 9000, swing: 33 }));
    run(["view", long], out);
    const { clips: [longClip] } = await load("long.bvh", readFileSync(long));
    await segue("set", { lab: "view", a: longClip.id });
    const written = await segue("export", "result", "bvh");
    assert.ok(readFileSync(out).equals(written), firstDifference(readFileSync(out), written));
    assert.ok(fetched.some((path) => path.endsWith("/converter_bg.wasm")), fetched.join(" "));
  } finally {
    rmSync(folder, { recursive: true });
  }
});
