// The page's public object, `await window.segueReady`, around what the app exports. The README documents it.

const EVENTS = ["change", "error", "progress"];

/**
 * @param handle the app's `SegueHandle`
 * @param life what the page knows of it: `stopped()` says why it no longer runs, `onLost()` is told that its graphics device is gone
 */
export function makeApi(handle, { stopped, onLost }) {
  const listeners = new Map(EVENTS.map((event) => [event, new Set()]));
  handle.setListener((event, detail) => {
    if (event === "lost") onLost();
    for (const listener of listeners.get(event) ?? []) {
      try {
        listener(detail);
      } catch (error) {
        console.error(error); // one listener's mistake is not the app's, nor the next listener's
      }
    }
  });

  /** Calls the app, and makes one kind of error of whatever it throws. */
  const call = (method, ...args) => {
    if (stopped()) throw new Error(`Segue has stopped: ${stopped()}`);
    try {
      return handle[method](...args);
    } catch (reason) {
      throw asError(reason);
    }
  };
  const callAsync = async (method, ...args) => {
    try {
      return await call(method, ...args);
    } catch (reason) {
      throw asError(reason);
    }
  };

  return Object.freeze({
    version: handle.version(),
    load: (name, bytes) => callAsync("load", String(name), asBytes(bytes)),
    stop: (name) => call("stop", String(name)),
    clips: () => call("clips"),
    params: () => call("params"),
    set: (values) => callAsync("set", values),
    keys: () => call("keys"),
    url: () => call("url"),
    play: () => call("play"),
    pause: () => call("pause"),
    seek: (seconds) => call("seek", seconds),
    time: () => call("time"),
    pose: (which, seconds) => call("pose", which, seconds),
    metrics: () => call("metrics"),
    export: (which, format, body) => call("exportClip", which, format, body),
    keep: (which) => call("keep", which),
    report: () => callAsync("report"),
    snapshot: () => callAsync("snapshot"),
    record: () => call("record"),
    stopRecording: () => callAsync("stopRecording"),
    stats: () => call("stats"),
    on(event, listener) {
      const set = listeners.get(event);
      if (!set) throw new Error(`There is no event "${event}", only ${EVENTS.join(", ")}`);
      // Wrapped, so that the same function subscribed twice is two subscriptions.
      const subscription = (detail) => listener(detail);
      set.add(subscription);
      return () => void set.delete(subscription);
    },
  });
}

function asError(reason) {
  return reason instanceof Error ? reason : new Error(String(reason));
}

function asBytes(bytes) {
  if (bytes instanceof Uint8Array) return bytes;
  if (bytes instanceof ArrayBuffer) return new Uint8Array(bytes);
  if (ArrayBuffer.isView(bytes)) return new Uint8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  throw new TypeError("The bytes of a file are a Uint8Array or an ArrayBuffer");
}
