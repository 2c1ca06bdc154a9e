// The API for a page that frames this one with `embed=1`: the same calls and events, through
// postMessage.
//
//   to the frame      { segue: 1, id, call: "set", args: [{ half_life: 0.2 }] }      any method of the API but `on`; `args` may be left out
//   back              { segue: 1, id, result }   or   { segue: 1, id, error: "text" }
//   from the frame    { segue: 1, event: "ready", detail: { version } }              once; calls made before it wait for it
//                     { segue: 1, event, detail }                                    "change", "error", "progress"
//
// Messages of other windows are ignored. The host of the page restricts framing with the header
// `frame-ancestors`. The origins that may drive the page and get its events are in the page (<meta
// name="embedders">), for hosts that cannot set headers.

const EVENTS = ["change", "error", "progress"];

const isFramed = window.parent !== window;
// Whether the link says so, by the app's own parser, because a page that answers must have no
// storage.
let isEmbedded = false;
const embedders = (document.querySelector('meta[name="embedders"]')?.content ?? "*").split(/\s+/).filter(Boolean);
const mayDrive = (origin) => embedders.includes("*") || embedders.includes(origin);
if (isFramed) window.addEventListener("message", receive);

async function receive({ source, origin, data }) {
  if (source !== window.parent || !mayDrive(origin) || data?.segue !== 1 || typeof data.call !== "string") return;
  const { id, call, args = [] } = data;
  const answer = (message) => source.postMessage({ segue: 1, id, ...message }, origin === "null" ? "*" : origin);
  try {
    const api = await window.segueReady;
    if (!isEmbedded) return;
    if (call === "on" || !Object.hasOwn(api, call)) throw new Error(`There is no call "${call}"`);
    if (!Array.isArray(args)) throw new TypeError(`${call}: args: expected a list`);
    const member = api[call];
    answer({ result: typeof member === "function" ? await member(...args) : member });
  } catch (error) {
    answer({ error: error.message ?? String(error) });
  }
}

/**
 * Starts to answer the framing window, and to send it events.
 * @param api the public object
 * @param embedded whether the app's link says that it is embedded
 */
export function answerParent(api, embedded) {
  isEmbedded = isFramed && embedded;
  if (!isEmbedded) return;
  // The browser drops messages whose target has another origin.
  const post = (event, detail) => embedders.forEach((origin) => window.parent.postMessage({ segue: 1, event, detail }, origin));
  for (const event of EVENTS) api.on(event, (detail) => post(event, detail));
  post("ready", { version: api.version });
}
