// Tests of the link: every parameter into the address and back, and wrong addresses.

import assert from "node:assert/strict";
import { onOneBackend } from "./harness.mjs";
import { striding, until } from "./help.mjs";

const SMALL = { viewport: [960, 640] };

/** The values that do not follow from the type: ids, texts, and numbers within the clips. */
const CHOSEN = {
  a: "idle", b: "jump", leave_a: 0.35, enter_b: 0.25, gait: "run", gait_speed: 3.15, make_seconds: 5.5, lab: "make",
  joint: "left hand & 100 % = #1+2", follow_joint: "Kopf, rechts/\"ü\"", in: 0.25, out: 3.75, t: 1.234, play: false,
  warp_curve: "0-0,100-100", warp_also: "0.3:walk", pins: "12-30,50-71", path: "AAUAAADIAfAByAF3yAF3rAI", others: "walk,run", edit_body: "run",
  prefer_clip: "walk", clips: "walk,run(turn_rate:20,lean:2)", go_to: "12.5:1,40:0", walk_path: "0:0,1.5:4", jump: "0:52-1:14",
  character: "somebody~0a1b2c3d", match_clips: "walk,run", tags: "walk:0.2-1.5:exclude", ask_tag: "walk", forbid_tag: "turn", contact_edits: "idle:L2-9;-R4-6", drive: "3c.0.s_1o.0.0",
  more_curves: "height,angle", clean_skip: "spike-34,gap-7",
  compare: "blend_window:60,20", lesson: "slerp", src: "https://example.org/one.bvh?x=1&y=2 https://example.org/two.bvh",
  corpus: "https://example.org/takes?x=1&y=2",
};

/** Returns a value of this row that is not its default, two thirds up its range and on its step. */
function otherThanDefault({ key, type, min, max, step, choices, default: usual }) {
  if (key in CHOSEN) return CHOSEN[key];
  if (type === "switch") return !usual;
  if (type === "choice") return choices.find((choice) => choice !== usual);
  const value = Number((Math.round((min + (max - min) * 0.66) / step) * step).toFixed(6));
  return value === usual ? value + step : value;
}

const serveFiles = (page) => page.route(({ hostname }) => hostname === "example.org", (route) => route.fulfill({
  headers: { "access-control-allow-origin": "*" }, body: striding({ frames: 30 }),
}));

// Fails for every key that url() leaves out or escapes wrongly, or that a link does not restore,
// and when a file of the link replaces a clip in it.
onOneBackend("every key is restored by its link", async ({ open }) => {
  const { segue } = await open("", { ...SMALL, prepare: serveFiles });
  const keys = await segue("keys");
  const wanted = Object.fromEntries(keys.map((row) => [row.key, otherThanDefault(row)]));
  for (const { key, default: usual } of keys) assert.notDeepEqual(wanted[key], usual, `${key} is not left at its default`);
  await segue("set", wanted);
  const fetched = async ({ segue }) => (await segue("clips")).filter((clip) => clip.sha256).map((clip) => clip.id.split("~")[0]);
  assert.deepEqual(await fetched({ segue }), ["one", "two"]);
  assert.deepEqual(await segue("params"), wanted);

  const url = new URL(await segue("url"));
  assert.deepEqual([...url.searchParams.keys()], keys.map(({ key }) => key), "each key once, in the order of the table");
  const again = await open(url.search.slice(1), { ...SMALL, prepare: serveFiles });
  await again.segue("set", {});
  assert.deepEqual(await fetched(again), ["one", "two"]);
  assert.deepEqual(await again.segue("params"), wanted);
  assert.equal(new URL(await again.segue("url")).search, url.search);
});

onOneBackend("defaults are not part of a link, and the address follows", async ({ open }) => {
  const { page, segue } = await open("lab=blend&blend_window=24", SMALL);
  assert.equal(new URL(await segue("url")).search, "?blend_window=24");
  await segue("set", { blend_window: 30, weight_law: "linear" });
  assert.equal(new URL(await segue("url")).search, "?weight_law=linear");
  await until("the address follows", () => page.url().endsWith("?weight_law=linear"));
  await segue("set", { weight_law: "smooth" });
  assert.equal(new URL(await segue("url")).search, "?lab=blend", "never empty: that would be a first visit");
  await segue("set", { weight_law: "smoother" });
  await until("the address follows again", () => page.url().endsWith("?weight_law=smoother"));
});

// Fails when one bad part of a link affects the others, and when there is no notice. Notices are
// not part of the API, so the picture is checked.
onOneBackend("wrong parts of a link are reported, and the rest is used", async ({ open }) => {
  const query = "blend_window=24&align=off&play=off";
  const right = await open(query, { scale: 1, ...SMALL });
  const wrong = await open(`colour=red&weight_law=steep&ghosts=99&${query}`, { scale: 1, ...SMALL });
  assert.deepEqual(await wrong.segue("params"), await right.segue("params"));
  assert.equal((await wrong.segue("params")).blend_window, 24);
  for (const { segue } of [right, wrong]) await segue("set", {});
  const differing = async () => {
    const [one, other] = [await right.pixels(), await wrong.pixels()];
    let found = 0;
    for (let i = 0; i < one.data.length; i += 3) if (Math.abs(one.data[i] - other.data[i]) > 16) found++;
    return found;
  };
  await until("a notice stands on the page", async () => (await differing()) > 1000);
});

onOneBackend("going back in the history restores the state", async ({ open }) => {
  const { page, segue } = await open("blend_window=24&play=off", SMALL);
  await page.evaluate(() => history.pushState(null, "", "?blend_window=48&play=off"));
  await page.evaluate(() => history.pushState(null, "", "?blend_window=48&play=off&x"));
  await page.goBack();
  await until("the link of the step before is used", async () => (await segue("params")).blend_window === 48);
});

// Fails when the body parts that were corrected are not in the link of their clip, or are not
// corrected where it is opened.
onOneBackend("link of a clip holds its corrected body parts", async ({ open }) => {
  const { segue } = await open("lab=view&a=walk&play=off", SMALL);
  await segue("set", {});
  const map = await segue("boneMap", "walk");
  map.roles.left_toe = null;
  await segue("setBoneMap", map);
  const url = new URL(await segue("url"));
  assert.match(url.searchParams.get("bones") ?? "", /^[0-9a-f]{16}:left_toe-$/);
  const other = await open(url.search.slice(1), SMALL);
  await other.segue("set", {});
  assert.equal((await other.segue("boneMap", "walk")).roles.left_toe, null);
});
