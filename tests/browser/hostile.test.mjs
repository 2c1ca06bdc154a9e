// Tests of hostile links, pages, files and scripts.

import assert from "node:assert/strict";
import http from "node:http";
import { onOneBackend } from "./harness.mjs";
import { elsewhere, striding, until } from "./help.mjs";

const SMALL = { viewport: [960, 640] };
const DESK = { viewport: [1280, 800] };

// Fails when a script that is not the page's own runs. The harness checks in every test that the
// page itself keeps its policy.
onOneBackend("policy of the page blocks foreign scripts", async ({ open }) => {
  await elsewhere({ "/evil.js": { type: "text/javascript", text: "window.hit = 'a script from elsewhere';" } }, async (far) => {
    const opened = await open("lab=view&play=off", SMALL);
    opened.refuses = true;
    const { page } = opened;
    await page.evaluate((far) => {
      const violations = [];
      addEventListener("securitypolicyviolation", ({ effectiveDirective }) => violations.push(effectiveDirective));
      const add = (tag, properties) => document.body.append(Object.assign(document.createElement(tag), properties));
      add("script", { textContent: "window.hit = 'a script in the page'" });
      add("script", { src: `${far}/evil.js` });
      add("script", { src: "data:text/javascript,window.hit='a script in an address'" });
      add("div", { innerHTML: "<img src=x onerror=\"window.hit='a handler'\"><style>body { color: red }</style>" });
      add("a", { href: "javascript:window.hit='a link'", id: "evil" });
      document.getElementById("evil").click();
      setTimeout("window.hit = 'a text'");
      add("iframe", { src: `${far}/evil.js` });
      add("base", { href: far });
      add("form", { action: far, id: "form" });
      document.getElementById("form").submit();
      window.violations = violations;
    }, far);
    // The browser reports violations asynchronously; that of the form comes last.
    for (const directive of ["base-uri", "frame-src", "script-src-elem", "style-src-elem", "form-action"]) {
      await until(`a violation of ${directive}`, () => page.evaluate((name) => window.violations.includes(name), directive));
    }
    assert.equal(await page.evaluate(() => window.hit), undefined);
  });
});

// Fails when a page that a lesson's link opens can navigate this one, or gets its address.
onOneBackend("page that a lesson's link opens has no handle to this one", async ({ open }) => {
  const link = (far) => `[${"somewhere else ".repeat(30).trim()}](${far}/other.html)\n\n`;
  const answers = { "/other.html": { type: "text/html", text: "<!doctype html><title>Other</title>" } };
  await elsewhere(answers, async (far) => {
    answers["/mine.md"] = { type: "text/plain", text: `# Mine\n\n${link(far).repeat(6)}` };
    const { page, segue } = await open("", DESK);
    await segue("set", { lesson: `${far}/mine.md` });
    const pages = [];
    page.context().on("page", (opened) => pages.push(opened));
    // The lesson may arrive and be laid out after any of the clicks.
    await until("the link opens a page", async () => {
      await page.mouse.move(160, 400);
      await page.mouse.down();
      await page.mouse.up();
      await page.waitForTimeout(300);
      return pages.length > 0;
    });
    const [other] = pages;
    await other.waitForLoadState();
    assert.match(other.url(), /other\.html$/);
    assert.deepEqual(await other.evaluate(() => [window.opener, document.referrer]), [null, ""]);
  });
});

// Fails when a value of a wrong type reaches the app, and when the message does not name the
// argument, the found value and the expected type.
onOneBackend("call with an argument of a wrong type names it", async ({ open }) => {
  const { page, segue } = await open("lab=blend&play=off", SMALL);
  const refusals = await page.evaluate(async () => {
    const circle = {};
    circle.circle = circle;
    const { segue } = window;
    const calls = [
      () => segue.pose({}, 0), () => segue.pose({ length: -1 }, 0), () => segue.pose(null), () => segue.pose("walk", "soon"), () => segue.pose("walk", NaN),
      () => segue.export({}, "bvh"), () => segue.export("walk", 7), () => segue.export("walk", "glb", 7), () => segue.export("walk", "glb", { body: {} }), () => segue.export("walk", "glb", { bodies: 1 }), () => segue.export("walk", "glb", { fps: "many" }), () => segue.setBoneMap("map"), () => segue.keep(), () => segue.keep(Symbol("x")),
      () => segue.seek("soon"), () => segue.stop([]), () => segue.load({}, new Uint8Array(1)), () => segue.load("x.bvh", "text"),
      () => segue.set(circle), () => segue.set([1]), () => segue.set(null), () => segue.set({ blend_window: null }), () => segue.set({ a: 10n }),
      () => segue.on("change"), () => segue.on({}, () => {}),
    ];
    const said = [];
    for (const call of calls) said.push(await Promise.resolve().then(call).then(() => "taken", (error) => error.message));
    return said;
  });
  const expected = [
    "pose: which: found an object", "pose: which: found an object", "pose: which: found null", "pose: seconds: found `soon`", "pose: seconds: found NaN",
    "export: which: found an object", "export: format: found 7", "export: options: found 7", "export: body: found an object", "export: options: found `bodies`", "export: fps: found `many`", "setBoneMap: found `map`", "keep: which: found nothing", "keep: which: found a symbol",
    "seek: seconds: found `soon`", "stop: name: found a list", "load: name: found an object", "load: bytes: found `text`",
    "set: circle: found an object", "set: found a list", "set: found null", "set: blend_window: found null", "set: a: found a bigint",
    "on: listener: found nothing", "on: event: found an object",
  ];
  refusals.forEach((said, index) => assert.ok(said.startsWith(`${expected[index]}, expected `), `${said}, not ${expected[index]}`));
  assert.ok((await segue("pose", "result", 0)).joints.length > 10, "it goes on");
});

// Fails when a graph of too many clips shows the numbers of an earlier one.
onOneBackend("set with more clips than a graph takes changes nothing", async ({ open }) => {
  const { segue } = await open("lab=graph&play=off", SMALL);
  const before = await segue("params");
  const many = Array.from({ length: 70 }, (_, n) => `clip${n}`).join(",");
  await assert.rejects(segue("set", { clips: many }), /clips: These are 70 clips: take 64 at most/);
  assert.deepEqual(await segue("params"), before);
});

/** A server that takes every request and never answers. */
async function silent(body) {
  const server = http.createServer(() => {});
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  try {
    await body(`http://127.0.0.1:${server.address().port}`);
  } finally {
    server.closeAllConnections();
    server.close();
  }
}

// Fails when a server that never answers is waited for for ever, and when the user cannot stop the
// wait.
onOneBackend("fetch without an answer ends by the user or by the timeout", async ({ open }) => {
  await silent(async (far) => {
    const { page, segue } = await open("lab=view&play=off", { ...SMALL, prepare: (page) => page.clock.install() });
    await page.evaluate(() => {
      window.errors = [];
      window.segue.on("error", ({ message }) => window.errors.push(message));
    });
    const names = async () => (await segue("stats")).jobs.map(({ name }) => name);
    for (const [name, values] of [["walk.bvh", { src: `${far}/walk.bvh` }], ["mine.md", { lesson: `${far}/mine.md` }]]) {
      const set = segue("set", values);
      await until(`${name} is under way`, async () => (await names()).includes(name));
      await segue("stop", name);
      await set;
      assert.ok(!(await names()).includes(name));
    }
    assert.deepEqual(await page.evaluate(() => window.errors), [], "no timeout");
    await assert.rejects(segue("stop", "walk.bvh"), /stop: found `walk\.bvh`, expected the name of a file that is under way/);
    const both = Promise.all([segue("set", { src: `${far}/run.bvh` }), segue("set", { lesson: `${far}/other.md` })]);
    await until("both are under way", async () => (await names()).length === 2);
    await page.clock.fastForward(20_000);
    await both;
    const errors = await page.evaluate(() => window.errors);
    assert.ok(errors.some((message) => /127\.0\.0\.1:\d+ has sent nothing for 20 s, so loading run\.bvh was stopped/.test(message)), errors.join("\n"));
    assert.deepEqual(await names(), []);
  });
});

// Fails when `loaded` resolves before the library has the clips of the link.
onOneBackend("loaded right after the start waits for all clips", async ({ open }) => {
  const text = String(striding({ frames: 30 }));
  await elsewhere({ "/late.bvh": { text, after: 1500 } }, async (far) => {
    const { segue } = await open(`lab=view&play=off&src=${far}/late.bvh`, SMALL);
    const names = (clips) => clips.map(({ name }) => name);
    assert.ok(!names(await segue("clips")).includes("late"));
    assert.ok(names(await segue("loaded")).includes("late"));
  });
});

// Fails when the page answers an origin that its host does not name.
onOneBackend("only origins that the host names may drive the frame", async ({ open }) => {
  const { page } = await open("", {
    ...SMALL,
    wait: false,
    prepare: (page) => page.route(({ pathname }) => pathname === "/", async (route) => {
      const { searchParams } = new URL(route.request().url());
      if (!searchParams.has("embed")) return route.fulfill({ contentType: "text/html", body: "<!doctype html><title>A course</title>" });
      const response = await route.fetch();
      const named = searchParams.has("named") ? new URL(route.request().url()).origin : "https://course.example";
      const body = (await response.text()).replace('<meta name="embedders" content="*">', `<meta name="embedders" content="https://other.example ${named}">`);
      return route.fulfill({ response, body });
    }),
  });
  const answered = (query, last) => page.evaluate(async ([query, last]) => {
    const frame = document.createElement("iframe");
    frame.src = `/?lab=view&play=off&embed=1${query}`;
    const heard = [];
    const listen = ({ data, source }) => source === frame.contentWindow && heard.push(data.event ?? data.id);
    window.addEventListener("message", listen);
    document.body.append(frame);
    await new Promise((resolve) => { frame.onload = resolve; });
    await frame.contentWindow.segueReady;
    frame.contentWindow.postMessage({ segue: 1, id: 7, call: "clips" }, "*");
    do await new Promise((resolve) => setTimeout(resolve, 2000)); while (last && !heard.includes(last));
    window.removeEventListener("message", listen);
    frame.remove();
    return heard;
  }, [query, last]);
  assert.deepEqual(await answered(""), []);
  const heard = await answered("&named=1", 7);
  assert.ok(heard.includes("ready"), String(heard));
});
