// What the app calls for corpora (src/platform/web/corpora.rs): `read` for clips that a link names,
// and the panel beside the stage.

import { readClip } from "./client.js";

let panel;

/** Returns the panel, which comes with its first use. `app` has the app's handle. */
function panelOf(app) {
  panel ??= Promise.all([import("./panel.js"), window.segueReady]).then(([{ Panel }, api]) => Panel.make(api, () => app.handle));
  panel.catch(() => { panel = undefined; });
  return panel;
}

/** Reads the clip at an address. Returns the name of its file, and its bytes. */
export const read = (_, address, signal) => readClip(address, signal);

/** Shows the corpus at an address; without one, closes that which is shown. */
export async function show(app, address) {
  if (address || panel) (await panelOf(app)).show(address);
}

/** Lets the user choose a corpus. */
export async function choose(app) {
  (await panelOf(app)).choose();
}

/** Shows the corpus in a folder that was dropped on the page, a `FileSystemDirectoryEntry`. */
export async function showFolder(app, entry) {
  (await panelOf(app)).showEntry(entry);
}
