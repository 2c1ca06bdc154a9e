// The page's public object, `await window.segueReady`, around the app's `SegueHandle`.
// `docs/api.md` documents it.

const EVENTS = ["change", "error", "progress"];

/**
 * @param handle the app's `SegueHandle`
 * @param app `stopped()` returns the reason why the app no longer runs, `onLost()` is called when
 *   its graphics device is lost
 */
export function makeApi(handle, { stopped, onLost }) {
  const listeners = new Map(EVENTS.map((event) => [event, new Set()]));
  handle.setListener((event, detail) => {
    if (event === "lost") onLost();
    for (const listener of listeners.get(event) ?? []) {
      try {
        listener(detail);
      } catch (error) {
        console.error(error); // a failing listener must not stop the app or other listeners
      }
    }
  });

  /** Calls the app, and converts everything that it throws to an Error. */
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

  const WHICH = "the id of a clip, \"result\", or \"result:1\" for the second pane";
  const PANE = "\"result\", or \"result:1\" for the second pane";
  const FILE = "the name of a file, such as \"walk.bvh\"";
  const FORMAT = "\"bvh\", \"fbx\", \"glb\", \"vrma\", \"npz\", \"csv\" or \"g1\"";

  return Object.freeze({
    version: handle.version(),
    load: async (name, bytes) => callAsync("load", text("load: name", name, FILE), asBytes(bytes)),
    stop: (name) => call("stop", text("stop: name", name, FILE)),
    clips: () => call("clips"),
    loaded: () => callAsync("loaded"),
    params: () => call("params"),
    set: async (values) => callAsync("set", asValues(values)),
    keys: () => call("keys"),
    url: () => call("url"),
    play: () => call("play"),
    pause: () => call("pause"),
    seek: (seconds) => call("seek", number("seek: seconds", seconds)),
    time: () => call("time"),
    pose: async (which, seconds) => callAsync("pose", text("pose: which", which, WHICH), number("pose: seconds", seconds)),
    metrics: () => callAsync("metrics"),
    export: async (which, format, options) =>
      callAsync("exportClip", text("export: which", which, WHICH), text("export: format", format, FORMAT), ...asExportOptions(options)),
    boneMap: async (which) => JSON.parse(await callAsync("boneMap", text("boneMap: which", which, WHICH))),
    setBoneMap: async (map) => callAsync("setBoneMap", asBoneMap(map)),
    keep: (which) => call("keep", text("keep: which", which, PANE)),
    report: () => callAsync("report"),
    snapshot: () => callAsync("snapshot"),
    record: () => call("record"),
    stopRecording: () => callAsync("stopRecording"),
    stats: () => call("stats"),
    on(event, listener) {
      const set = listeners.get(event);
      if (!set) throw new TypeError(`on: event: found ${named(event)}, expected one of ${EVENTS.join(", ")}`);
      if (typeof listener !== "function") throw new TypeError(`on: listener: found ${named(listener)}, expected a function`);
      // Wrapped, so that the same function subscribed twice is two subscriptions.
      const subscription = (detail) => listener(detail);
      set.add(subscription);
      return () => void set.delete(subscription);
    },
  });
}

// Arguments are checked here, because the app's bindings would read the memory of any value as a
// string.

/** Returns a short description of a value. */
function named(value) {
  if (typeof value === "string") return `\`${value.length > 60 ? `${value.slice(0, 60)}…` : value}\``;
  if (value === undefined) return "nothing";
  if (value === null || typeof value === "number" || typeof value === "boolean") return String(value);
  if (Array.isArray(value)) return "a list";
  return typeof value === "object" ? "an object" : `a ${typeof value}`;
}

function text(key, value, expected) {
  if (typeof value !== "string") throw new TypeError(`${key}: found ${named(value)}, expected ${expected}`);
  return value;
}

function number(key, value, expected = "seconds") {
  if (typeof value !== "number" || !Number.isFinite(value)) throw new TypeError(`${key}: found ${named(value)}, expected ${expected}`);
  return value;
}

/** Returns a bone map as the text of its file. The app checks its contents. */
function asBoneMap(map) {
  const EXPECTED = "an object as boneMap() returns it";
  if (typeof map !== "object" || map === null || Array.isArray(map)) throw new TypeError(`setBoneMap: found ${named(map)}, expected ${EXPECTED}`);
  try {
    return JSON.stringify(map);
  } catch {
    throw new TypeError(`setBoneMap: found an object that is no JSON, expected ${EXPECTED}`);
  }
}

/** Returns the body, the root and the frame rate of an export. A text alone is the body. */
function asExportOptions(options) {
  if (options == null) return [];
  if (typeof options === "string") return [options];
  const EXPECTED = "an object with some of body, root and fps";
  if (typeof options !== "object" || Array.isArray(options)) throw new TypeError(`export: options: found ${named(options)}, expected ${EXPECTED}`);
  const { body, root, fps, ...others } = options;
  const [unknown] = Object.keys(others);
  if (unknown !== undefined) throw new TypeError(`export: options: found ${named(unknown)}, expected ${EXPECTED}`);
  return [
    body == null ? undefined : text("export: body", body, "\"character\", \"plain\", or nothing"),
    root == null ? undefined : text("export: root", root, "\"as-is\", \"ground\", \"in-place\", or nothing"),
    fps == null ? undefined : number("export: fps", fps, "frames per second, or nothing"),
  ];
}

/** Returns a flat copy of keys and values. The app checks whether they fit. */
function asValues(values) {
  if (typeof values !== "object" || values === null || Array.isArray(values)) {
    throw new TypeError(`set: found ${named(values)}, expected an object of keys and values, as in { blend_window: 24 }`);
  }
  for (const [key, value] of Object.entries(values)) {
    if (!["number", "string", "boolean"].includes(typeof value)) {
      throw new TypeError(`set: ${key}: found ${named(value)}, expected a number, a text, true or false`);
    }
  }
  return { ...values };
}

function asError(reason) {
  return reason instanceof Error ? reason : new Error(String(reason));
}

function asBytes(bytes) {
  if (bytes instanceof Uint8Array) return bytes;
  if (bytes instanceof ArrayBuffer) return new Uint8Array(bytes);
  if (ArrayBuffer.isView(bytes)) return new Uint8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  throw new TypeError(`load: bytes: found ${named(bytes)}, expected a Uint8Array or an ArrayBuffer`);
}
