// Writes FILE.br and FILE.gz beside every file of a folder that becomes smaller, and prints the
// size of the first visit, and of what its first frame waits for. Called by `cargo xtask serve
// --dist` with the folder and a cache folder, where results are kept by content.

import { createHash } from "node:crypto";
import { existsSync } from "node:fs";
import { copyFile, readFile, readdir, rename, writeFile } from "node:fs/promises";
import path from "node:path";
import { promisify } from "node:util";
import zlib from "node:zlib";

const [folder, cache] = process.argv.slice(2);
const PACKED = /\.(br|gz|png|jpe?g|webp)$/;
/** The files that are fetched only on request. */
const LATER = /^(samples|lessons|lang|js-\w+\/(read|convert|compute|corpus))\//;
/** The rests of modules, which come behind the first frame. */
const BEHIND = /_rest\.wasm$/;
/** The modules of the app by what a browser draws with: one of them is fetched. A page may have the second alone. */
const MODULES = { WebGPU: /^webgpu-/, "WebGL 2": /^segue-app-/ };

const brotli = promisify(zlib.brotliCompress);
const gzip = promisify(zlib.gzip);
const encoders = {
  br: (bytes) => brotli(bytes, { params: {
    [zlib.constants.BROTLI_PARAM_QUALITY]: 11, [zlib.constants.BROTLI_PARAM_LGWIN]: 24, [zlib.constants.BROTLI_PARAM_SIZE_HINT]: bytes.length,
  } }),
  gz: (bytes) => gzip(bytes, { level: 9 }),
};

const files = (await readdir(folder, { recursive: true, withFileTypes: true }))
  .filter((entry) => entry.isFile() && !PACKED.test(entry.name))
  .map((entry) => path.join(entry.parentPath ?? entry.path, entry.name))
  .sort();

const rows = await Promise.all(files.map(async (file) => {
  const bytes = await readFile(file);
  const key = createHash("sha256").update(bytes).digest("hex");
  const sizes = await Promise.all(Object.entries(encoders).map(async ([kind, encode]) => {
    const kept = path.join(cache, `${key}.${kind}`);
    if (!existsSync(kept)) {
      await writeFile(`${kept}.part`, await encode(bytes));
      await rename(`${kept}.part`, kept);
    }
    const { length } = await readFile(kept);
    if (length < bytes.length) await copyFile(kept, `${file}.${kind}`);
    return Math.min(length, bytes.length);
  }));
  return [path.relative(folder, file), bytes.length, ...sizes];
}));

const line = (name, ...sizes) => console.log(`  ${name.padEnd(40)}${sizes.map((size) => String(size).padStart(12)).join("")}`);
line("file", "bytes", "brotli", "gzip");
for (const row of rows) line(...row);
for (const [backend, own] of Object.entries(MODULES).filter(([, own]) => rows.some(([name]) => own.test(name)))) {
  const isOther = (name) => Object.values(MODULES).some((module) => module !== own && module.test(name));
  const visit = rows.filter(([name]) => !LATER.test(name) && !isOther(name));
  const sums = (rows) => [1, 2, 3].map((column) => rows.reduce((sum, row) => sum + row[column], 0));
  line(`first frame, ${backend}`, ...sums(visit.filter(([name]) => !BEHIND.test(name))));
  line(`first visit, ${backend}`, ...sums(visit));
}
