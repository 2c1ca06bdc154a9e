// Tests of the panel of a corpus, with the small corpus in corpus/. Its files are made by
//   cargo xtask make-test-corpus
// and have to be made again when the format changes.

import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import path from "node:path";
import process from "node:process";
import { fileURLToPath } from "node:url";
import { corpusServer } from "./corpus_server.mjs";
import { onOneBackend } from "./harness.mjs";
import { until } from "./help.mjs";

const FOLDER = process.env.SEGUE_CORPUS ?? fileURLToPath(new URL("./corpus", import.meta.url));
const AXE = readFileSync(fileURLToPath(import.meta.resolve("axe-core/axe.min.js")), "utf8");
const DESK = { viewport: [1440, 900] };
const link = (address, more = "") => `lab=view&play=off&corpus=${encodeURIComponent(address)}${more}`;

/** Returns what the table shows: the names of its rows in order, and how many there are. */
const shown = (page) => page.evaluate(() => {
  const rows = [...document.querySelectorAll("#corpus .row")].sort((one, other) => one.ariaRowIndex - other.ariaRowIndex);
  return {
    names: rows.map((row) => row.querySelector("[role=rowheader] b").textContent).filter(Boolean),
    playable: rows.filter((row) => !row.matches(".wrong")).map((row) => row.querySelector("[role=rowheader] b").textContent).filter(Boolean),
    details: rows.map((row) => row.querySelector("[role=rowheader] small").textContent),
    count: Number(document.querySelector("#corpus .grid")?.ariaRowCount ?? 1) - 1,
    status: document.querySelector("#corpus .count")?.textContent,
    isFilled: (rows.length > 0 || document.querySelector("#corpus .grid")?.ariaRowCount === "1") && rows.every((row) => row.querySelector("[role=rowheader] b").textContent),
    pictures: document.querySelectorAll("#corpus .row img[src^=blob]").length,
  };
});
const rowsAre = (page, what, test) => until(what, async () => {
  const now = await shown(page);
  return now.isFilled && test(now) && now;
});
const opened = (page) => rowsAre(page, "the table has rows", ({ names, count }) => count > 0 && names.length > 0);
/** Returns the row of a clip by its name. */
const rowOf = (page, name) => page.locator("#corpus .row").filter({ has: page.getByRole("rowheader", { name: new RegExp(`^${name}(,|$)`) }) });
const message = (page) => until("a sentence is there", () => page.evaluate(() => [...document.querySelectorAll("#corpus [role=alert]")].map((each) => each.textContent).find(Boolean)));
const faults = (page) => page.evaluate(async (axe) => {
  if (!window.axe) (0, eval)(axe);
  const { violations } = await window.axe.run(document.getElementById("corpus"), { resultTypes: ["violations"] });
  return violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html).join("\n")}`);
}, AXE);
/** Keeps the page from drawing frames until it calls `releaseFrames`. */
const holdFrames = (page) => page.evaluate(() => {
  const [request, held] = [window.requestAnimationFrame, []];
  window.requestAnimationFrame = (callback) => held.push(callback);
  window.releaseFrames = () => {
    window.requestAnimationFrame = request;
    for (const callback of held) request(callback);
  };
});
const typeInto = (page, text) => page.evaluate((text) => {
  const field = document.querySelector("#corpus input[type=search]");
  field.value = text;
  field.dispatchEvent(new Event("input"));
}, text);
const corpusClips = async (segue) => (await segue("clips")).filter(({ format, sha256 }) => sha256 && format === "npz");

// Fails when the table is not made of the columns alone, or search, order and filters do not work.
onOneBackend("corpus opens as a table that is searched, sorted and filtered", async ({ open }) => {
  await corpusServer(FOLDER, {}, async (address, asked) => {
    const { page, segue } = await open(link(address), DESK);
    const first = await opened(page);
    assert.deepEqual(first.names, first.names.toSorted(), "by name");
    assert.ok(!asked.some(({ name }) => name.startsWith("poses")), "no motion is read for the table");
    await rowsAre(page, "thumbnails are there", ({ pictures }) => pictures > 3);
    assert.ok(asked.filter(({ name }) => name.startsWith("thumbnails")).every(({ range }) => range), "thumbnails come by ranges");
    assert.deepEqual(await faults(page), [], "table");

    const search = page.getByRole("searchbox", { name: "Search names and labels" });
    await search.fill(first.names[0]);
    const found = await rowsAre(page, "the search finds", ({ count }) => count < first.count);
    assert.ok(found.names.every((name) => name.includes(first.names[0].split(" ")[0])), found.names.join());
    await search.press("Escape");
    await rowsAre(page, "the search is cleared", ({ count }) => count === first.count);
    await search.press("Escape");
    assert.equal(await page.locator("#corpus").count(), 1, "Escape in an empty search closes nothing");
    // Beside a stage that draws slowly, frames are long.
    await holdFrames(page);
    await typeInto(page, first.names[0]);
    await rowsAre(page, "the search finds without a frame", ({ names, count }) => count === found.count && names.length > 0);
    await page.evaluate(() => window.releaseFrames());
    await typeInto(page, "");
    await rowsAre(page, "the search is cleared again", ({ count }) => count === first.count);

    const length = page.getByRole("columnheader", { name: "Length" });
    await length.getByRole("button").click();
    const seconds = async () => (await page.locator("#corpus .row .number:nth-child(3)").allTextContents()).map(Number).filter(Number.isFinite);
    await until("the longest is first", async () => (await length.getAttribute("aria-sort")) === "descending" && (await seconds()).every((value, at, all) => at === 0 || value <= all[at - 1]));

    await page.getByRole("button", { name: "Filters" }).click();
    const histogram = page.locator("#corpus .histogram").first();
    await until("the histogram is drawn", () => histogram.locator("canvas").evaluate((canvas) => new Uint32Array(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.buffer).some(Boolean)));
    assert.deepEqual(await faults(page), [], "filters");
    const { x, y, width, height } = await histogram.locator(".plot").boundingBox();
    await page.mouse.move(x + 1, y + height / 2);
    await page.mouse.down();
    await page.mouse.move(x + width / 2, y + height / 2, { steps: 6 });
    await page.mouse.up();
    const fewer = await rowsAre(page, "the range leaves fewer", ({ count }) => count < first.count);
    assert.match(fewer.status, new RegExp(`^${fewer.count} of ${first.count} clips`));
    await page.locator("#corpus .set-filters button").first().click();
    await rowsAre(page, "the range is gone", ({ count }) => count === first.count);
    await until("the focus stays in the panel", () => page.getByRole("button", { name: "Filters" }).evaluate((button) => button === document.activeElement));
    const slider = histogram.getByRole("slider").first();
    await slider.focus();
    for (let press = 0; press < 24; press++) await page.keyboard.press("ArrowRight");
    await rowsAre(page, "by keyboard, too", ({ count }) => count < first.count);
    await page.keyboard.press("Home");
    await rowsAre(page, "and back", ({ count }) => count === first.count);

    await page.getByRole("radio", { name: "Only" }).click();
    await rowsAre(page, "copies are found", ({ count }) => count > 0 && count < first.count);
    await page.getByRole("radio", { name: "Hide" }).click();
    const last = await rowsAre(page, "copies are hidden", ({ count, details }) => count < first.count && !details.some((text) => text.includes("copy")));

    // The link shows the same to others, and another link another part.
    const inLink = async () => new URL(await segue("url")).searchParams.get("corpus");
    await until("the link has what is shown", async () => (await inLink()) === `${address}#copies=hide&sort=-seconds`);
    const again = await open(new URL(await segue("url")).search.slice(1), DESK);
    await rowsAre(again.page, "the same rows are shown", ({ names, count }) => count === last.count && names.join() === last.names.join());
    await again.page.getByRole("button", { name: "Filters" }).click();
    assert.equal(await again.page.getByRole("radio", { name: "Hide" }).getAttribute("aria-checked"), "true");
    await again.segue("set", { corpus: `${address}#search=${encodeURIComponent(first.names[0])}` });
    await rowsAre(again.page, "another search is shown", ({ count }) => count === found.count);
    assert.equal(await again.page.getByRole("searchbox").inputValue(), first.names[0]);
    await again.segue("set", { corpus: `${address}#seconds=a..&labels=nobody&copies=some&sort=-nothing&fps=9..1&=..` });
    await rowsAre(again.page, "what is wrong leaves out nothing", ({ names, count }) => count === first.count && names.every((name, row) => name === first.names[row]));
  });
});

// Fails when a click does not play, what was looked at stays, or the link does not restore it.
onOneBackend("click plays a clip, and the link shows the same to others", async ({ open }) => {
  await corpusServer(FOLDER, {}, async (address) => {
    const { page, segue } = await open(link(address), DESK);
    const { names: all, playable: names } = await opened(page);
    const row = (name) => rowOf(page, name);
    await row(names[0]).click();
    const playing = async (name) => until(`${name} plays`, async () => {
      const [params, clips] = [await segue("params"), await corpusClips(segue)];
      return params.lab === "view" && clips.find(({ id, name: own }) => id === params.a && own === name);
    });
    const first = await playing(names[0]);
    await row(names[1]).click();
    await playing(names[1]);
    await until("the clip that was looked at is gone", async () => !(await corpusClips(segue)).some(({ id }) => id === first.id));

    // A click is one step of undo.
    const press = (name) => page.getByRole("button", { name, exact: true }).evaluate((button) => button.click());
    const isAtFoot = (name) => until(`${name} is at the foot`, () => page.evaluate((name) => document.querySelector("#corpus .dock b").textContent === name, name));
    await press("Undo");
    await playing(names[0]);
    await isAtFoot(names[0]);
    await press("Redo");
    await playing(names[1]);
    await isAtFoot(names[1]);

    // A range of it, by keyboard.
    const end = page.getByRole("slider", { name: "End of the range" });
    await end.focus();
    for (let press = 0; press < 4; press++) await page.keyboard.press("ArrowLeft");
    const cut = await until("the range is cut out, and it alone is a source", async () => {
      const { src, a } = await segue("params");
      const clip = (await corpusClips(segue)).find(({ id }) => id === a);
      const [, to] = /^[^#\s]+#[^@\s]+@0-([\d.]+)$/.exec(src) ?? [];
      const shown = Number(await end.getAttribute("aria-valuenow"));
      return to && clip && Math.abs(clip.duration - shown) < 0.05 && Math.abs(shown - Number(to)) < 0.01 && { clip, to };
    });
    const { to } = cut;

    const url = new URL(await segue("url"));
    assert.equal(url.searchParams.get("corpus"), address);
    const again = await open(url.search.slice(1), DESK);
    await opened(again.page);
    await again.segue("loaded");
    const there = await again.segue("params");
    assert.equal(there.a, cut.clip.id);
    assert.deepEqual((await corpusClips(again.segue)).map(({ id, duration }) => [id, duration]), [[cut.clip.id, cut.clip.duration]]);
    await until("it is marked", () => again.page.evaluate((name) => document.querySelector("#corpus .row[aria-current] b")?.textContent === name, names[1]));
    await until("so is its range", () => again.page.evaluate((to) => document.querySelector("#corpus .dock .title small").textContent.includes(`0 – ${to} s`), to));

    // Into a lab, by the keyboard and by a drag.
    await again.page.locator("#corpus .grid").focus();
    await again.page.keyboard.press("Home");
    for (let step = 0; step < all.indexOf(names[0]); step++) await again.page.keyboard.press("ArrowDown");
    await again.page.keyboard.press("b");
    await until("it is B of Blend", async () => {
      const { lab, a, b } = await again.segue("params");
      return lab === "blend" && a === cut.clip.id && (await corpusClips(again.segue)).some(({ id, name }) => id === b && name === names[0]);
    });
    await rowOf(again.page, names[2]).dragTo(again.page.locator("#segue"), { targetPosition: { x: 150, y: 300 }, force: true });
    await until("the drag is A", async () => {
      const { lab, a } = await again.segue("params");
      return lab === "blend" && (await corpusClips(again.segue)).some(({ id, name }) => id === a && name === names[2]);
    });
    await again.page.getByRole("button", { name: "Close the corpus" }).click();
    await until("it is closed", async () => (await again.segue("params")).corpus === "" && (await again.page.locator("#corpus").count()) === 0);
  });
});

// Fails when a click waits for an older one whose clip is still read, or leaves that clip behind.
onOneBackend("newer click in a corpus replaces one that is still read", async ({ open }) => {
  await corpusServer(FOLDER, { after: 500 }, async (address) => {
    const { page, segue } = await open(link(address), DESK);
    const { playable: names } = await opened(page);
    const row = (name) => rowOf(page, name);
    await row(names[0]).click();
    await row(names[1]).click();
    await until("the newer one plays, alone", async () => {
      const [{ a, src }, clips] = [await segue("params"), await corpusClips(segue)];
      return clips.length === 1 && clips[0].id === a && clips[0].name === names[1] && src.split(" ").length === 1;
    });
    assert.equal(await page.locator("#corpus .problem").textContent(), "");
  });
});

// Fails when a search finds nothing, or not what it should: the copy of a clip at the same moment.
onOneBackend("more like this finds moments in the corpus, from its clips and from others", async ({ open }) => {
  await corpusServer(FOLDER, {}, async (address, asked) => {
    // Little motion: what is played stays at its moment.
    const { page, segue } = await open(link(address), { ...DESK, motion: "reduce" });
    await opened(page);
    const like = page.getByRole("button", { name: "More like this moment" });
    // From what is on the stage without the corpus.
    await like.click();
    const hits = await rowsAre(page, "moments are found", ({ status, count }) => /^All clips.*Like/.test(status) && count > 2);
    assert.ok(hits.details.filter(Boolean).every((text) => /^at [\d.]+ s/.test(text)), hits.details.join("\n"));
    const distances = (await page.locator("#corpus .row .number:nth-child(3)").allTextContents()).map(Number);
    assert.deepEqual(distances, distances.toSorted((one, other) => one - other), "the nearest first");
    assert.ok(asked.some(({ name, range }) => name.startsWith("index/lists") && range), "lists come by ranges");
    assert.deepEqual(await faults(page), [], "hits");
    await page.locator("#corpus .row:not(.wrong)").first().click();
    await until("it plays at that moment", async () => {
      const [, at] = /at ([\d.]+) s/.exec(hits.details[0]);
      return Math.abs((await segue("time")) - Number(at)) < 0.05 && (await corpusClips(segue)).length > 0;
    });
    await page.getByRole("button", { name: "All clips" }).click();
    /** Plays a clip that is not on the stage, and waits until it stands at its start. */
    const playOther = async (row) => {
      const { a: before } = await segue("params");
      await row.click();
      await until("it is on the stage", async () => (await segue("params")).a !== before);
      await segue("set", {});
    };
    const copies = page.locator("#corpus .row", { hasText: "copy" }).first();
    await playOther(page.locator("#corpus .row", { hasText: "jump" }).first());
    await playOther(copies);
    const name = await copies.locator("b").textContent();
    await until("the copy is at the foot", () => page.evaluate((name) => document.querySelector("#corpus .dock b").textContent === name, name));
    await segue("seek", 0.3);
    await like.click();
    const [nearest] = (await rowsAre(page, "its moments are found", ({ status }) => status.includes(`Like ${name} at 0.30 s`))).details;
    assert.match(nearest, /^at 0\.[234]\d s/);
    await page.getByRole("button", { name: "All clips" }).click();
    await page.getByRole("button", { name: /^\d+ cop/ }).click();
    await rowsAre(page, "its copies are listed", ({ status, count }) => status.includes(`Copies of ${name}`) && count > 1);
    await page.keyboard.press("Escape");
    await page.getByRole("radio", { name: "Map" }).click();
    const map = page.getByRole("application", { name: /^Map/ });
    await until("the map is drawn", () => map.evaluate((canvas) => new Uint32Array(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.buffer).some(Boolean)));
    assert.deepEqual(await faults(page), [], "map");
    await segue("set", { a: "walk" });
    await map.focus();
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("+");
    await page.keyboard.press("Enter");
    await until("the point in the middle plays", async () => {
      const { a } = await segue("params");
      return (await corpusClips(segue)).some(({ id }) => id === a);
    });
  });
});

// Fails when a folder of this computer is not read, or its clips do not play.
onOneBackend("corpus in a folder plays, and no link names it", async ({ open }) => {
  const { page, segue } = await open("lab=view&play=off", { ...DESK, prepare: (page) => page.addInitScript(() => { delete window.showDirectoryPicker; }) });
  await page.getByRole("button", { name: "Corpus…" }).focus();
  await page.keyboard.press("Enter");
  await page.getByRole("heading", { name: "Open a corpus" }).waitFor();
  assert.deepEqual(await faults(page), [], "chooser");
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.getByRole("button", { name: "Open a folder…" }).click()]);
  await chooser.setFiles(FOLDER);
  const { playable: names } = await opened(page);
  await page.locator("#corpus .row:not(.wrong)").first().click();
  await until("it plays", async () => (await corpusClips(segue)).some(({ name }) => name === names[0]));
  assert.ok(!(await segue("url")).includes("corpus"), await segue("url"));
  // The same folder, dropped on the page.
  await page.getByRole("button", { name: "Close the corpus" }).click();
  const files = readdirSync(FOLDER, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile())
    .map((entry) => path.relative(FOLDER, path.join(entry.parentPath, entry.name))).map((name) => [name, readFileSync(path.join(FOLDER, name)).toString("base64")]);
  await page.evaluate(async (files) => {
    const bytes = (base64) => Uint8Array.from(atob(base64), (char) => char.charCodeAt(0));
    const folder = (name, prefix) => ({
      isFile: false, isDirectory: true, name, fullPath: `/${name}`,
      createReader: () => {
        const below = files.filter(([path]) => path.startsWith(prefix)).map(([path, base64]) => [path.slice(prefix.length), base64]);
        const own = below.filter(([path]) => !path.includes("/")).map(([path, base64]) => ({ isFile: true, isDirectory: false, name: path, fullPath: path, file: (resolve) => resolve(new File([bytes(base64)], path)) }));
        const folders = [...new Set(below.filter(([path]) => path.includes("/")).map(([path]) => path.split("/")[0]))].map((name) => folder(name, `${prefix}${name}/`));
        const parts = [[...own, ...folders], []];
        return { readEntries: (resolve) => resolve(parts.shift()) };
      },
    });
    const whole = folder("takes", "");
    DataTransferItem.prototype.webkitGetAsEntry = () => whole;
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([], "takes"));
    const canvas = document.getElementById("segue");
    for (const type of ["dragenter", "dragover", "drop"]) canvas.dispatchEvent(new DragEvent(type, { bubbles: true, cancelable: true, composed: true, clientX: 800, clientY: 300, dataTransfer }));
  }, files);
  await opened(page);
  assert.equal(await page.locator("#corpus h1").textContent(), "takes");
});

// Fails when a host or a file that is wrong gives no sentence that says what to do.
onOneBackend("hosts without ranges and damaged files are told in a sentence", async ({ open }) => {
  const { page, segue } = await open("lab=view&play=off", { viewport: [1280, 800] });
  const close = async () => {
    await segue("set", { corpus: "" });
    await until("it is closed", async () => (await page.locator("#corpus").count()) === 0);
  };
  const told = async (options, expected, act) => corpusServer(FOLDER, options, async (address) => {
    await segue("set", { corpus: address });
    if (act) await act(address);
    const text = await until(`it says ${expected}`, async () => {
      const text = await message(page);
      return expected.test(text) && text;
    });
    assert.ok(text.length < 320 && /[.。]$/.test(text.trim()), text);
    await close();
  });
  const play = async () => {
    await opened(page);
    await page.locator("#corpus .row:not(.wrong)").first().click();
  };
  await told({ cors: false }, /does not let other pages read its files \(CORS\)/);
  await told({ change: (name, bytes) => (name === "corpus.json" ? null : bytes) }, /There is no corpus\.json at this address/);
  await told({ change: (name, bytes) => (name === "corpus.json" ? Buffer.from("{") : bytes) }, /does not describe a corpus: it is not JSON/);
  await told({ change: (name, bytes) => (name === "corpus.json" ? Buffer.from("{}") : bytes) }, /older version of Segue/);
  const ofFormat = (format) => ({ change: (name, bytes) => (name === "corpus.json" ? Buffer.from(JSON.stringify({ ...JSON.parse(bytes), format })) : bytes) });
  await told(ofFormat(99), /made by a newer version of Segue\. Load the page again/);
  await told(ofFormat(1), /older version of Segue, in another format\. Build it again/);
  await told({ change: (name, bytes) => (name === "columns.bin" ? bytes.subarray(0, bytes.length / 2) : bytes) }, /The corpus is damaged: columns\.bin/);
  await told({ change: (name, bytes) => (name === "columns.bin" ? Buffer.alloc(bytes.length, 7) : bytes) }, /The corpus is damaged/);
  await told({ ranges: false, stated: (name) => (name.startsWith("poses") ? 64 << 20 : undefined) }, /sends whole files instead of the parts/, play);
  await told({ change: (name, bytes) => (name.startsWith("poses") ? bytes.subarray(0, 100) : bytes) }, /is shorter than corpus\.json says/, play);
  await told({ change: (name, bytes) => (name.startsWith("poses") ? Buffer.alloc(bytes.length, 0xff) : bytes) }, /could not be played/, play);
  await told({ change: (name, bytes) => (name.endsWith("centroids.bin") ? bytes.subarray(0, 10) : bytes) }, /The corpus is damaged: centroids/, async () => {
    await opened(page);
    await page.getByRole("button", { name: "More like this moment" }).click();
  });
  // A link has a filter, and its corpus can be read only when it is tried again: the filter is set.
  let isThere = false;
  await corpusServer(FOLDER, { change: (name, bytes) => (name === "corpus.json" && !isThere ? null : bytes) }, async (address) => {
    await segue("set", { corpus: `${address}#copies=hide` });
    await until("it says what is missing", async () => /There is no corpus\.json/.test(await message(page)));
    isThere = true;
    await page.getByRole("button", { name: "Try again" }).click();
    await opened(page);
    await page.getByRole("button", { name: "Filters" }).click();
    assert.equal(await page.getByRole("radio", { name: "Hide" }).getAttribute("aria-checked"), "true");
    assert.equal((await segue("params")).corpus, `${address}#copies=hide`);
    await close();
  });
  // A small corpus is read whole from a host without ranges.
  await corpusServer(FOLDER, { ranges: false }, async (address) => {
    await segue("set", { corpus: address });
    await play();
    await until("it plays", async () => (await corpusClips(segue)).length > 0);
    await close();
  });
  // A clip of a link that is not there, and an address that is none.
  await corpusServer(FOLDER, {}, async (address) => {
    await page.evaluate(() => {
      window.errors = [];
      window.segue.on("error", ({ message }) => window.errors.push(message));
    });
    await segue("set", { src: `${address}#00000000-0` });
    const [text] = await until("it is reported", () => page.evaluate(() => window.errors.length && window.errors));
    assert.match(text, /There is no clip 00000000-0 in this corpus/);
  });
  await segue("set", { corpus: "ftp://example.org/takes" });
  assert.match(await message(page), /This is not the address of a corpus/);
});

// Fails when the panel covers a phone's stage for good, or its targets are too small.
onOneBackend("on a phone the stage is behind the panel, a tap away", async ({ open }) => {
  await corpusServer(FOLDER, {}, async (address) => {
    const { page, segue } = await open(link(address), { viewport: [390, 844] });
    await opened(page);
    const small = await page.evaluate(() => [...document.querySelectorAll("#corpus button, #corpus input, #corpus .row")].filter((each) => each.offsetParent && !each.closest(".row .acts"))
      .map((each) => [each.ariaLabel ?? each.textContent ?? each.className, each.getBoundingClientRect()]).filter(([, { width, height }]) => Math.min(width, height) < 43.5).map(([name, { width, height }]) => `${name}: ${width} × ${height}`));
    assert.deepEqual(small, []);
    await page.locator("#corpus .row:not(.wrong)").first().click();
    await until("it plays", async () => (await corpusClips(segue)).length > 0);
    assert.ok(await page.locator("#corpus").isHidden());
    await page.getByRole("button", { name: "Corpus", exact: true }).click();
    assert.ok(await page.locator("#corpus").isVisible());
    await segue("set", { lang: "zh-Hant" });
    await until("it is Chinese", () => page.getByPlaceholder("搜尋名稱與標籤").isVisible());
    await opened(page);
    assert.deepEqual(await faults(page), [], "phone");
    // A phone on its side, and the narrowest panel beside a stage.
    for (const [width, height, panel] of [[844, 390, 844], [810, 800, 390]]) {
      await page.setViewportSize({ width, height });
      await until(`names have room at ${width} × ${height}`, () => page.evaluate((panel) => {
        const [corpus, name] = ["#corpus", "#corpus .row .name"].map((path) => document.querySelector(path)?.getBoundingClientRect().width ?? 0);
        return Math.abs(corpus - panel) < 2 && name > 100;
      }, panel));
    }
  });
});
