// Folders of this computer: the files of a corpus by their paths in it.

/** The files that the page reads; in `.work` and elsewhere may be thousands of others. */
const IS_READ = /^(corpus\.json|[\w.-]+\.bin|index\/[\w.-]+\.bin)$/;

/** Returns the files of a dropped folder. */
export async function filesOfEntry(entry) {
  const files = new Map();
  const fileOf = (child) => new Promise((resolve, reject) => child.file(resolve, reject));
  const childrenOf = async (folder) => {
    const reader = folder.createReader();
    const children = [];
    for (;;) {
      // They come in parts, of which the last is empty.
      const part = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
      if (!part.length) return children;
      children.push(...part);
    }
  };
  const visit = async (folder, prefix) => {
    for (const child of await childrenOf(folder)) {
      const path = prefix + child.name;
      if (child.isDirectory && path === "index") await visit(child, "index/");
      else if (child.isFile && IS_READ.test(path)) files.set(path, await fileOf(child));
    }
  };
  await visit(entry, "");
  return files;
}

/** Returns the files of a folder that the user chose with the browser's own dialogue. */
async function filesOfHandle(handle) {
  const files = new Map();
  const visit = async (folder, prefix) => {
    for await (const [name, child] of folder.entries()) {
      const path = prefix + name;
      if (child.kind === "directory" && path === "index") await visit(child, "index/");
      else if (child.kind === "file" && IS_READ.test(path)) files.set(path, await child.getFile());
    }
  };
  await visit(handle, "");
  return files;
}

/** Returns the files of an input of folders: those beside the outermost corpus.json. */
function filesOfInput(list) {
  const all = [...list].map((file) => [file.webkitRelativePath || file.name, file]);
  const manifests = all.map(([path]) => path).filter((path) => /(^|\/)corpus\.json$/.test(path));
  const [manifest = ""] = manifests.sort((one, other) => one.split("/").length - other.split("/").length);
  const prefix = manifest.slice(0, -"corpus.json".length);
  return new Map(all.filter(([path]) => path.startsWith(prefix)).map(([path, file]) => [path.slice(prefix.length), file]).filter(([path]) => IS_READ.test(path)));
}

/**
 * Lets the user choose a folder. Returns its name and files; null if none was chosen. Call it
 * within a click.
 */
export async function chooseFolder() {
  if (window.showDirectoryPicker) {
    try {
      const handle = await window.showDirectoryPicker();
      return { name: handle.name, files: await filesOfHandle(handle) };
    } catch (reason) {
      if (reason?.name === "AbortError") return null;
      if (reason?.name !== "SecurityError") throw reason;
      // Frames of other origins have only the input.
    }
  }
  const input = Object.assign(document.createElement("input"), { type: "file", webkitdirectory: true, hidden: true, id: "corpus-folder" });
  // Safari drops an input that is not in the document.
  document.body.append(input);
  try {
    return await new Promise((resolve) => {
      input.addEventListener("cancel", () => resolve(null));
      input.addEventListener("change", () => {
        const [first] = input.files;
        resolve(first ? { name: (first.webkitRelativePath || first.name).split("/")[0], files: filesOfInput(input.files) } : null);
      });
      input.click();
    });
  } finally {
    input.remove();
  }
}
