// Tests of storage: a loaded file is restored, however the page has ended.

import assert from "node:assert/strict";
import { onOneBackend } from "./harness.mjs";
import { linkStored, random, striding, until } from "./help.mjs";

const SMALL = { viewport: [960, 640] };
/** Returns the ids of clips of files, in the order of their loading. */
const loaded = async (segue) => (await segue("clips")).filter((clip) => clip.sha256).map(({ id }) => id);

const FILES = 40;
const MOMENTS = 10;
const MAX_WAIT_MS = 5000;

/** The ways to end a page. Each returns the page in which the work has to be restored. */
const ENDS = {
  reload: async (page) => {
    await page.reload({ waitUntil: "commit" });
    return page;
  },
  close: async (page) => {
    const context = page.context();
    await Promise.all([page.waitForEvent("close"), page.close({ runBeforeUnload: true })]);
    return context.newPage();
  },
  kill: async (page) => {
    const context = page.context();
    const session = await context.newCDPSession(page);
    const crashed = page.waitForEvent("crash");
    session.send("Page.crash").catch(() => {}); // the crashed page does not answer
    await crashed;
    return context.newPage();
  },
};

// Fails when load() resolves before the file is stored, and when a stored file needs a record that
// is not written yet.
for (const [seed, [end, endPage]] of Object.entries(ENDS).entries()) {
  onOneBackend(`loaded files are restored after a ${end} at any moment`, async ({ open }) => {
    const next = random(20_261_122 + seed);
    const texts = Array.from({ length: FILES }, (_, index) => striding({ frames: 12, swing: 10 + index }).toString());
    let resolved = 0;
    const endOnce = async (wait) => {
      const { page } = await open("lab=view&play=off", SMALL);
      const reported = [];
      await page.exposeFunction("tell", (id) => void reported.push(id));
      const loading = page.evaluate(async (texts) => {
        const segue = await window.segueReady;
        for (const [index, text] of texts.entries()) {
          const { clips } = await segue.load(`${index}.bvh`, new TextEncoder().encode(text));
          window.tell(clips[0].id);
        }
      }, texts).catch(() => {}); // the page ends in the middle of it
      await page.waitForTimeout(wait);
      const again = await endPage(page);
      await loading;
      const expected = [...reported];
      resolved += expected.length;
      if (again !== page) await again.goto(new URL(page.url()).origin, { waitUntil: "commit" });
      await again.waitForFunction(() => "segueReady" in window);
      await again.evaluate(async () => (await window.segueReady).set({}));
      const clips = () => again.evaluate(async () => (await window.segueReady).clips().map(({ id }) => id));
      await until(`all ${expected.length} files are there, ${wait.toFixed(0)} ms after the first`, async () => {
        const there = new Set(await clips());
        return expected.every((id) => there.has(id));
      }).catch(async (error) => {
        const there = new Set(await clips());
        throw new Error(`${error.message}; missing: ${expected.filter((id) => !there.has(id))}`);
      });
      assert.ok((await clips()).includes("walk"), "the clips that were always there are there");
      await again.context().close();
    };
    // Two pages at a time: while one waits for its moment, the other one works.
    const waits = Array.from({ length: MOMENTS }, () => next() * MAX_WAIT_MS);
    const half = async (first) => {
      for (let moment = first; moment < MOMENTS; moment += 2) await endOnce(waits[moment]);
    };
    await Promise.all([half(0), half(1)]);
    assert.ok(resolved > MOMENTS * 3, `${resolved} files were loaded in all`);
  });
}

/**
 * Reads or writes the browser's records and files in the page's origin. It is sent as text, because
 * the page's policy lets no script make a function.
 */
const inStorage = (page, body, argument = null) => page.evaluate(`(async () => {
  const database = await new Promise((resolve, reject) => Object.assign(indexedDB.open("segue"), { onsuccess: (event) => resolve(event.target.result), onerror: reject }));
  const asked = (request) => new Promise((resolve, reject) => Object.assign(request, { onsuccess: () => resolve(request.result), onerror: () => reject(request.error) }));
  const stores = (...names) => names.map((name) => database.transaction(names, "readwrite").objectStore(name));
  try {
    return await (${body})(stores, asked, ${JSON.stringify(argument)});
  } finally {
    database.close();
  }
})()`);

const keysOf = (page, store) => inStorage(page, async (stores, asked, store) => asked(stores(store)[0].getAllKeys()), store);

// Fails when a damaged record is overwritten, and when clips or files are lost with it.
onOneBackend("damaged record is kept, and its clips are restored", async ({ open }) => {
  const { page, segue, load, ready } = await open("lab=view&play=off", SMALL);
  const { clips: [mine] } = await load("mine.bvh", striding({ frames: 12 }));
  await until("the record is written", async () => (await keysOf(page, "work")).includes("latest"));
  await page.goto(new URL("manifest.webmanifest", page.url()).href);
  await inStorage(page, async (stores, asked) => asked(stores("work")[0].put('{"garbage":', "latest")));
  await page.goto(new URL(page.url()).origin, { waitUntil: "commit" });
  await ready();
  await segue("set", { blend_window: 19 });
  await until("the clip is back", async () => (await loaded(segue)).includes(mine.id));
  await until("the old record is kept under another key", async () => {
    const keys = await keysOf(page, "work");
    return keys.includes("latest") && keys.some((key) => key.startsWith("unread "));
  });
  assert.deepEqual(await keysOf(page, "files"), [mine.sha256]);
});

// Fails when one tab does not get the clips that another has stored.
onOneBackend("two tabs get each other's clips", async ({ open }) => {
  const { page, load } = await open("lab=view&play=off", SMALL);
  const other = await page.context().newPage();
  await other.goto(page.url(), { waitUntil: "commit" });
  await other.waitForFunction(() => "segueReady" in window);
  await other.evaluate(async () => (await window.segueReady).set({}));
  const { clips: [mine] } = await load("mine.bvh", striding({ frames: 12 }));
  await other.bringToFront();
  await until("the other tab has it", () => other.evaluate(async (id) => {
    const clip = (await window.segueReady).clips().find((clip) => clip.id === id);
    return clip?.frames === 12;
  }, mine.id));
});

// Fails when a file without room prevents the storage of others, and when it is not named.
onOneBackend("full storage stores what has room and names the rest", async ({ open }) => {
  const { page, segue, load, ready } = await open("lab=view&play=off", SMALL);
  await page.evaluate(() => {
    window.errors = [];
    window.segue.on("error", ({ message }) => window.errors.push(message));
  });
  // Set before anything is stored, because a browser checks its quota only from time to time.
  const session = await page.context().newCDPSession(page);
  await session.send("Storage.overrideQuotaForOrigin", { origin: new URL(page.url()).origin, quotaSize: 700_000 });
  const { clips: [small] } = await load("small.bvh", striding({ frames: 12 }));
  const large = striding({ frames: 1800 });
  assert.ok(large.length > 800_000, `${large.length} bytes`);
  const [{ clips: [huge] }, { clips: [more] }] = await Promise.all([load("huge.bvh", large), load("more.bvh", striding({ frames: 14 }))]);
  const [reported] = await until("it is reported", () => page.evaluate(() => window.errors.length && window.errors));
  assert.match(reported, /storage is full: huge\.bvh will not be here/);
  await until("the rest is stored", async () => (await keysOf(page, "files")).length === 2);
  await segue("set", { blend_window: 19 });
  await linkStored(page, "blend_window=19");
  await page.reload({ waitUntil: "commit" });
  await ready();
  await segue("set", {});
  await until("those with room are back", async () => (await loaded(segue)).length === 2);
  const there = await loaded(segue);
  assert.ok(there.includes(small.id) && there.includes(more.id) && !there.includes(huge.id), there.join());
});
