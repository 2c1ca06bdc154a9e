// Settings in the browser's storage, which a page may lack.

/** Returns a text that was stored; null without it. */
export function readStored(key) {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

/** Stores a text. */
export function writeStored(key, value) {
  try {
    localStorage.setItem(key, value);
  } catch {
    // It is for this visit alone.
  }
}
