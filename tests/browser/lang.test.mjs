// The two languages: which one a visitor sees, and that nobody downloads the other.

import assert from "node:assert/strict";
import { onBackend, onBothBackends } from "./harness.mjs";
import { linkStored, until } from "./help.mjs";

const isOfLanguage = (url) => url.pathname.includes("/lang/");

/** Counts what is fetched of the languages. */
function counted() {
  const fetched = [];
  return { fetched, prepare: (page) => void page.on("request", (request) => {
    const url = new URL(request.url());
    if (isOfLanguage(url)) fetched.push(url.pathname.split("/").at(-1));
  }) };
}

const spoken = (page, tag) => page.waitForFunction((tag) => document.documentElement.lang === tag, tag);

/** A page for somebody who reads these languages. */
const readerOf = (...languages) => (page) => page.addInitScript((languages) => {
  Object.defineProperty(navigator, "languages", { get: () => languages });
  Object.defineProperty(navigator, "language", { get: () => languages[0] });
}, languages);

// Fails when the font is part of the first visit, when Chinese does not come, or when the two look alike.
onBothBackends("a link brings Chinese, the switch brings English back, and only then is anything fetched", async ({ open }) => {
  const plain = counted();
  const english = await open("lab=blend&play=off&t=1", { prepare: plain.prepare });
  const before = await english.screenshot();
  assert.deepEqual(plain.fetched, []);
  assert.equal(await english.page.evaluate(() => document.documentElement.lang), "en");

  const chinese = counted();
  const { page, segue, screenshot } = await open("lab=blend&play=off&t=1&lang=zh-Hant", { prepare: chinese.prepare });
  await until("both files are asked for", () => chinese.fetched.length === 2);
  assert.deepEqual(chinese.fetched.toSorted(), ["zh-Hant.json", "zh-Hant.otf"]);
  await spoken(page, "zh-Hant");
  await until("it looks different", async () => !(await screenshot()).equals(before));

  await segue("set", { lang: "en" });
  await spoken(page, "en");
  assert.match(await segue("url"), /lang=en/);
  await segue("set", { lang: "zh-Hant" });
  await spoken(page, "zh-Hant");
  assert.equal(chinese.fetched.length, 2, "what is here is not fetched again");
});

onBackend("webgl2", "a reader of Chinese is spoken to in Chinese, and the link says nothing of it", async ({ open }) => {
  const { page, segue, ready } = await open("lab=make&play=off", { prepare: readerOf("zh-TW", "en") });
  await spoken(page, "zh-Hant");
  assert.equal((await segue("params")).lang, "auto");
  assert.doesNotMatch(await segue("url"), /lang=/);

  // Chosen by hand, it is there on the next visit, whatever link that begins with.
  await segue("set", { lang: "en" });
  await spoken(page, "en");
  await linkStored(page, "lang=en");
  await page.goto(page.url().replace(/\?.*/, "?lab=blend"), { waitUntil: "commit" });
  await ready();
  assert.equal((await segue("params")).lang, "en");
  await spoken(page, "en");
});

onBackend("webgl2", "where the language does not come, English stays", async ({ open }) => {
  let refused = 0;
  const { page, segue } = await open("lab=blend&play=off&lang=zh-Hant", {
    prepare: (page) => page.route(isOfLanguage, (route) => (refused++, route.fulfill({ status: 404, body: "" }))),
  });
  await until("it is refused", () => refused > 0);
  await segue("set", { blend_window: 20 });
  assert.equal((await segue("params")).blend_window, 20);
  assert.equal(await page.evaluate(() => document.documentElement.lang), "en");
  assert.equal(refused, 1, "it is not asked for again and again");
});

onBackend("webgl2", "the page's own words are in the reader's language, too", async ({ open }) => {
  const { page, ready } = await open("", {
    wait: false,
    prepare: async (page) => {
      await readerOf("zh-Hant-TW")(page);
      await page.route((url) => url.pathname.endsWith(".wasm"), (route) => route.fulfill({ status: 503, body: "" }));
    },
  });
  await assert.rejects(ready(), /could not be downloaded/);
  assert.match(await page.locator(".veil .panel").innerText(), /無法下載 Segue/);
});
