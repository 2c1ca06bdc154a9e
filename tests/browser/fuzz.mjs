// Feeds the page with random input: links, calls, messages, lessons, and valid parameters. `cargo
// xtask fuzz page` runs it for minutes, fuzz.test.mjs for seconds. The same seed makes the same
// input.

import assert from "node:assert/strict";
import process from "node:process";
import { fileURLToPath } from "node:url";
import { close, openSegue } from "./segue.mjs";

const SCHOOL = "https://school.example/";
/**
 * The greatest growth of the memory in the last third of a run, bytes. A lab that is opened for the
 * first time takes some.
 */
const MOST_GROWTH = 192e6;

/** A generator of random numbers (mulberry32). */
export function chance(seed) {
  let state = seed >>> 0;
  const number = () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let mixed = Math.imul(state ^ (state >>> 15), state | 1);
    mixed ^= mixed + Math.imul(mixed ^ (mixed >>> 7), mixed | 61);
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 4294967296;
  };
  const below = (most) => Math.floor(number() * most);
  const pick = (list) => list[below(list.length)];
  return { number, below, pick, some: (most, make) => Array.from({ length: below(most) }, make) };
}

const ODD_TEXTS = [
  "", " ", "%", "%%", "%E0%A4", "%00", "\0", "\u202e", "a\nb", "-1", "1e309", "NaN", "auto", "null", "0x10", ":", ",", "((((", "blend(a:walk,b:", "../x", "<img src=x>",
  "https://", "http://[", "javascript:0", "走", "🚶‍♀️", "`", "|", "=", "&", "#", "+", "\\", "__proto__", "constructor", "result:9", "result", "walk~", "x~12ab.99999999999999999999",
];

function oddText({ pick, below, some }) {
  const texts = [pick(ODD_TEXTS), ...some(4, () => pick(ODD_TEXTS))].join(pick(["", ",", ":", "(", "-"]));
  return below(40) === 0 ? texts.padEnd(1 + below(100_000), pick(["x", "(", "%", ",", "走"])) : texts;
}

function oddQuery(dice, keys) {
  const { pick, below, some } = dice;
  const key = () => (below(4) === 0 ? oddText(dice) : pick(keys).key);
  const value = () => pick([oddText(dice), encodeURIComponent(oddText(dice)), String(below(1000) - 500), "on", "walk,run,idle", "blend_window:30,15"]);
  return [0, ...some(6, () => 0)].map(() => `${key()}=${value()}`).join(pick(["&", "&", "&&", "?"])).replaceAll("#", "%23");
}

function oddLesson(dice) {
  const { pick, below, some } = dice;
  const parts = ["# ", "## Try\n", "## Question\n", "## Answer\n", "- [a](?lab=loop)\n", "[x](", ")", "**", "*", "`", "```\n", "\n\n", "> ", "<b>", "&lt;", "|", "1. ", "\\", "https://a.b/c ", "[begin](?lab=make)\n"];
  return `${pick(["# A\n", ""])}${some(200, () => pick([...parts, oddText(dice)])).join("")}`.slice(0, below(20) === 0 ? 300_000 : 4000);
}

/** Returns a valid value of a parameter by its row of `keys()`; undefined for free texts. */
function fitting({ pick, number }, { type, min, max, step, choices, auto }, clips) {
  if (auto && number() < 0.2) return "auto";
  if (type === "number" || type === "integer") return min + Math.round((number() * (max - min)) / step) * step;
  if (type === "switch") return number() < 0.5;
  if (type === "choice") return pick(choices);
  return type === "clip" ? pick(clips) : undefined;
}

/** Asserts after each step that the page runs, and that all its numbers are finite. */
async function sound({ page, segue }, what, seconds) {
  assert.equal(await page.locator(".veil").count(), 0, `it stopped after ${what}`);
  const bad = await page.evaluate(async (seconds) => {
    const { segue } = window;
    try {
      const { positions, rotations } = await segue.pose("result", seconds);
      if (![...positions, ...rotations].every(Number.isFinite)) return "a pose that is not finite";
      const odd = Object.entries(await segue.metrics()).find(([, { value }]) => value !== null && !Number.isFinite(value));
      return odd && `${odd[0]} is ${odd[1].value}`;
    } catch (error) {
      return error.message ? undefined : "a refusal without a sentence";
    }
  }, seconds);
  assert.equal(bad, undefined, `after ${what}`);
  return (await segue("stats")).wasm_bytes;
}

/** Takes a random step. Returns its description. */
async function step(dice, opened, keys, clips) {
  const { page, segue } = opened;
  const { pick, below, some } = dice;
  const kind = pick(["link", "call", "lesson", "fitting", "fitting", "fitting", "fitting"]);
  if (kind === "link") {
    const query = oddQuery(dice, keys.filter(({ key }) => !["src", "lesson", "embed"].includes(key)));
    await page.evaluate((query) => {
      history.pushState(null, "", `?${query}`);
      dispatchEvent(new PopStateEvent("popstate"));
    }, query);
    await segue("set", {});
    return `the link ?${query.slice(0, 2000)}`;
  }
  if (kind === "lesson") {
    const text = oddLesson(dice);
    const name = `${SCHOOL}${below(1e9)}.md`;
    await page.route(name, (route) => route.fulfill({ contentType: "text/plain", headers: { "access-control-allow-origin": "*" }, body: text }));
    await segue("set", { lesson: name });
    await segue("set", { lesson: "" });
    await page.unroute(name);
    return `the lesson ${JSON.stringify(text.slice(0, 2000))}`;
  }
  if (kind === "call") {
    const calls = ["load", "stop", "set", "seek", "pose", "export", "keep", "on", "metrics", "params", "url", "play", "pause", "time"];
    const made = { call: pick(calls), kinds: some(4, () => below(12)), text: oddText(dice), number: below(1000) - 500 };
    await page.evaluate(async ({ call, kinds, text, number }) => {
      const circle = {};
      circle.circle = circle;
      const values = [undefined, null, text, number, NaN, Infinity, {}, [], circle, Symbol("x"), new Uint8Array(7), { [text]: text, blend_window: number }];
      await Promise.resolve().then(() => window.segue[call](...kinds.map((kind) => values[kind]))).catch((error) => {
        if (error instanceof WebAssembly.RuntimeError || !error.message) throw error;
      });
    }, made);
    return `the call ${JSON.stringify(made).slice(0, 2000)}`;
  }
  const values = {};
  const { lab } = await segue("params");
  const own = keys.filter((row) => row.lab === lab || ["a", "b", "lab"].includes(row.key));
  for (let count = 1 + below(3); count > 0; count--) {
    const row = pick(below(3) === 0 ? keys.filter(({ key }) => key !== "lang" && key !== "embed") : own);
    const value = fitting(dice, row, clips);
    if (value !== undefined) values[row.key] = value;
  }
  await segue("set", values);
  return `set(${JSON.stringify(values)})`;
}

/** Sends messages to a frame from its parent. The last one must be answered. */
async function messages(dice, opened, count) {
  const { page } = opened;
  const made = Array.from({ length: count }, () => ({ segue: dice.pick([1, 1, 1, 2, "1"]), id: dice.below(9), call: dice.pick(["set", "pose", "on", "load", "toString", "__proto__", oddText(dice)]), args: dice.pick([undefined, null, 7, "x", {}, [], [{}], [oddText(dice)]]) }));
  const answer = await page.evaluate(async (made) => {
    const frame = Object.assign(document.createElement("iframe"), { src: `/?lab=view&play=off&embed=1` });
    const answered = new Promise((resolve) => addEventListener("message", ({ data }) => {
      if (data.event === "ready") {
        for (const message of [...made, { segue: 1, id: "last", call: "version" }]) frame.contentWindow.postMessage(message, "*");
      }
      if (data.id === "last") resolve(data.result);
    }));
    document.body.append(frame);
    return answered;
  }, made);
  assert.match(answer, /^\d+\.\d+/, "the frame answers no longer");
}

/** Runs for a time. Throws at the first failure of the page, with the step that caused it. */
export async function fuzz(open, seed, seconds, tell = () => {}) {
  const dice = chance(seed);
  const course = await open("", {
    wait: false,
    viewport: [640, 480],
    prepare: (page) => page.route(({ pathname, search }) => pathname === "/" && search === "", (route) => route.fulfill({ contentType: "text/html", body: "<!doctype html><title>A course</title>" })),
  });
  await messages(dice, course, 100);
  await course.page.close();

  const opened = await open("lab=view&play=off", { viewport: [640, 480] });
  const [keys, clips] = [await opened.segue("keys"), (await opened.segue("clips")).map(({ id }) => id)];
  const [began, sizes] = [Date.now(), []];
  let steps = 0;
  let last = "the start";
  while (Date.now() - began < 1000 * seconds) {
    try {
      last = await step(dice, opened, keys, clips);
      sizes.push(await sound(opened, last, 5 * dice.number()));
      assert.deepEqual(opened.problems, [], `after ${last}`);
    } catch (error) {
      error.message = `seed ${seed}, step ${steps}, behind ${last}: ${error.message}`;
      throw error;
    }
    steps++;
  }
  const grown = sizes.at(-1) - sizes[Math.floor((2 * sizes.length) / 3)];
  tell(`seed ${seed}: ${steps} steps, ${Math.round(sizes.at(-1) / 1e6)} MB, of which ${Math.round(grown / 1e6)} MB in the last third`);
  assert.ok(grown < MOST_GROWTH, `${grown} bytes more in the last third`);
  return steps;
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const option = (name, fallback) => Number(process.argv[process.argv.indexOf(`--${name}`) + 1 || Infinity] ?? fallback);
  try {
    await fuzz((query, options) => openSegue("webgl2", query, options), option("seed", 1), 60 * option("minutes", 20), console.log);
  } finally {
    await close();
  }
}
