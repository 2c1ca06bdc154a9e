// A worker that reads large motion files with the app's own WebAssembly. src/platform/web/reader.rs gives it tasks.
//
// The page sends first { jsUrl, module }, then tasks { task, name, setup, file }. For each the worker answers with messages
// { task, progress }, { task, head }, { task, piece } …, { task, end: true }, or { task, failed: reason }.

let started;

self.onmessage = async ({ data }) => {
  if (data.module) {
    started = start(data);
    started.catch(() => {}); // each task tells of it
    return;
  }
  const { task, name, setup, file } = data;
  const tell = (news, transfer = []) => self.postMessage({ task, ...news }, transfer);
  try {
    const { readFile } = await started;
    const buffer = await file.arrayBuffer();
    const sha256 = await digest(buffer);
    const bytes = new Uint8Array(buffer);
    const progress = (done) => tell({ progress: done });
    readFile(name, bytes, setup, sha256, progress, (head) => tell({ head }), (piece) => tell({ piece }, [piece.buffer]));
    tell({ end: true });
  } catch (reason) {
    tell({ failed: String(reason?.message ?? reason) });
  }
};

/** The browser's own digest is several times as fast; it has none on an insecure address. */
async function digest(buffer) {
  if (!self.crypto?.subtle) return undefined;
  const sum = new Uint8Array(await crypto.subtle.digest("SHA-256", buffer));
  return Array.from(sum, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

async function start({ jsUrl, module }) {
  const bindings = await import(jsUrl);
  await bindings.default({ module_or_path: module });
  return bindings;
}
