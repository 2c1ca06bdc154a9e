// Tests of the two languages: the choice for a visitor, and the download of the chosen one alone.

import assert from "node:assert/strict";
import { onOneBackend } from "./harness.mjs";
import { linkStored, until } from "./help.mjs";

const isOfLanguage = (url) => url.pathname.includes("/lang/");

/** Counts the requests for files of the languages. */
function counted() {
  const fetched = [];
  return { fetched, prepare: (page) => void page.on("request", (request) => {
    const url = new URL(request.url());
    if (isOfLanguage(url)) fetched.push(url.pathname.split("/").at(-1));
  }) };
}

const spoken = (page, tag) => page.waitForFunction((tag) => document.documentElement.lang === tag, tag);

/** Opens a page in a browser with these languages. */
const readerOf = (...languages) => (page) => page.addInitScript((languages) => {
  Object.defineProperty(navigator, "languages", { get: () => languages });
  Object.defineProperty(navigator, "language", { get: () => languages[0] });
}, languages);

// Fails when the font is part of the first visit, when Chinese is not shown, or when both languages
// look the same.
onOneBackend("link selects Chinese, the switch selects English, and files are fetched on demand", async ({ open }) => {
  const plain = counted();
  const english = await open("lab=blend&play=off&t=1", { scale: 1, prepare: plain.prepare });
  const before = await english.screenshot();
  assert.deepEqual(plain.fetched, []);
  assert.equal(await english.page.evaluate(() => document.documentElement.lang), "en");

  const chinese = counted();
  const { page, segue, screenshot } = await open("lab=blend&play=off&t=1&lang=zh-Hant", { scale: 1, prepare: chinese.prepare });
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

onOneBackend("browser set to Chinese shows Chinese, and the link does not name it", async ({ open }) => {
  const { page, segue, ready } = await open("lab=make&play=off", { prepare: readerOf("zh-TW", "en") });
  await spoken(page, "zh-Hant");
  assert.equal((await segue("params")).lang, "auto");
  assert.doesNotMatch(await segue("url"), /lang=/);

  // A language that the user has chosen is shown on the next visit, with any link.
  await segue("set", { lang: "en" });
  await spoken(page, "en");
  await linkStored(page, "lang=en");
  await page.goto(page.url().replace(/\?.*/, "?lab=blend"), { waitUntil: "commit" });
  await ready();
  await until("the choice is restored", async () => (await segue("params")).lang === "en");
  await spoken(page, "en");
});

onOneBackend("language that cannot be loaded leaves English", async ({ open }) => {
  let refused = 0;
  const { page, segue } = await open("lab=blend&play=off&lang=zh-Hant", {
    prepare: (page) => page.route(isOfLanguage, (route) => (refused++, route.fulfill({ status: 404, body: "" }))),
  });
  await until("it is refused", () => refused > 0);
  await segue("set", { blend_window: 20 });
  assert.equal((await segue("params")).blend_window, 20);
  assert.equal(await page.evaluate(() => document.documentElement.lang), "en");
  assert.equal(refused, 1, "it is requested once");
});

onOneBackend("panels of the page are in the browser's language", async ({ open }) => {
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
