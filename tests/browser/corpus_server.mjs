// A server of a corpus on another origin, with ranges and CORS, and with the faults of hosts.

import { createReadStream, existsSync, statSync } from "node:fs";
import http from "node:http";
import path from "node:path";

/**
 * Serves a folder while `body` runs, which gets the address of its corpus.json and what was asked.
 * @param options.ranges false: whole files instead of ranges
 * @param options.cors false: without the header that lets other pages read
 * @param options.after milliseconds before each answer
 * @param options.stated (name) => the size that is stated of a file, bytes, though it is another one
 * @param options.change (name, bytes) => other bytes of a file, or null if it is not there
 */
export async function corpusServer(folder, options, body) {
  const { ranges = true, cors = true, after = 0, stated, change } = options;
  const asked = [];
  const server = http.createServer(async (request, response) => {
    if (after) await new Promise((resolve) => setTimeout(resolve, after));
    const { pathname } = new URL(request.url, "http://x");
    const name = decodeURIComponent(pathname).replace(/^\/takes\//, "");
    const headers = { ...(cors && { "access-control-allow-origin": "*", "access-control-allow-headers": "range" }), "accept-ranges": "bytes" };
    if (request.method === "OPTIONS") return response.writeHead(204, headers).end();
    const file = path.join(folder, name);
    const found = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? "");
    const entry = { name, range: found && [Number(found[1]), Number(found[2])], bytes: 0 };
    asked.push(entry);
    if (!file.startsWith(folder) || !existsSync(file) || !statSync(file).isFile()) return response.writeHead(404, headers).end();
    const { size } = statSync(file);
    if (change) {
      const chunks = [];
      return createReadStream(file).on("data", (chunk) => chunks.push(chunk)).on("end", () => {
        const bytes = change(name, Buffer.concat(chunks));
        if (!bytes) return response.writeHead(404, headers).end();
        if (!found || !ranges) return response.writeHead(200, { ...headers, "content-length": bytes.length }).end(bytes);
        if (Number(found[1]) >= bytes.length) return response.writeHead(416, headers).end();
        return response.writeHead(206, headers).end(bytes.subarray(Number(found[1]), Number(found[2]) + 1));
      });
    }
    if (!found || !ranges) {
      entry.bytes = size;
      response.writeHead(200, { ...headers, "content-length": stated?.(name) ?? size });
      return createReadStream(file).pipe(response);
    }
    const [start, end] = [Number(found[1]), Math.min(Number(found[2]), size - 1)];
    if (start >= size) return response.writeHead(416, headers).end();
    entry.bytes = end - start + 1;
    response.writeHead(206, { ...headers, "content-length": end - start + 1, "content-range": `bytes ${start}-${end}/${size}` });
    return createReadStream(file, { start, end }).pipe(response);
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  try {
    return await body(`http://127.0.0.1:${server.address().port}/takes/corpus.json`, asked);
  } finally {
    server.closeAllConnections();
    server.close();
  }
}
