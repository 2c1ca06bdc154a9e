// Tests of access: screen readers, reduced motion, and reports.

import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { onBothBackends, onOneBackend } from "./harness.mjs";
import { until } from "./help.mjs";

const LABS = ["view", "make", "blend", "transition", "speed", "loop", "layers", "register", "path", "graph", "match", "in_place", "edit", "clean"];
const LESSONS = readdirSync(new URL("../../assets/lessons/en", import.meta.url)).filter((name) => /^\d/.test(name)).length;
const AXE = readFileSync(fileURLToPath(import.meta.resolve("axe-core/axe.min.js")), "utf8");

/** Waits until there are elements and their number no longer changes. */
async function elements(page) {
  let before = -1;
  await until("the elements are told", async () => {
    const now = await page.evaluate(() => document.querySelectorAll("#outline [data-number]").length);
    const still = now > 0 && now === before;
    before = now;
    if (!still) await page.waitForTimeout(300);
    return still;
  });
}

/** Returns the role and the name of the focused element. */
const focused = (page) => page.evaluate(() => {
  const { id, localName, role, ariaLabel, textContent } = document.activeElement;
  return { what: id || role || localName, name: ariaLabel ?? textContent };
});

/** Returns the serious and critical violations that axe-core finds. */
const faults = (page) => page.evaluate(async (axe) => {
  if (!window.axe) (0, eval)(axe);
  const { violations } = await window.axe.run(document, { resultTypes: ["violations"] });
  return violations.filter(({ impact }) => impact === "serious" || impact === "critical").map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html).join("\n")}`);
}, AXE);

/** Returns the names of elements that do not lie within the part of the page that contains them, from side to side. */
const outside = () => [...document.querySelectorAll("#outline [data-number] [data-number]")].filter((element) => {
  const [inner, outer] = [element, element.parentElement].map((each) => each.getBoundingClientRect());
  return inner.width > 0 && (inner.left < outer.left - 1 || inner.right > outer.right + 1);
}).map((element) => `${element.ariaLabel ?? element.textContent} in ${element.parentElement.ariaLabel}`);

// Fails when a control of any lab has no name or no role for screen readers.
onOneBackend("widget of every lab is an element with a role and a name", async ({ open }) => {
  const { page, segue } = await open("play=off", { viewport: [1280, 800] });
  const client = await page.context().newCDPSession(page);
  for (const lab of [...LABS, "lesson"]) {
    await segue("set", lab === "lesson" ? { lab: "blend", lesson: "half_life" } : { lab });
    await until(`${lab} is computed`, async () => (await segue("stats")).jobs.length === 0);
    await elements(page);
    assert.deepEqual(await faults(page), [], lab);
    const { nodes } = await client.send("Accessibility.getFullAXTree");
    const worked = nodes.filter(({ ignored, properties = [] }) => !ignored && properties.some(({ name, value }) => name === "focusable" && value.value));
    const nameless = worked.filter(({ role, name }) => role.value !== "RootWebArea" && !name?.value);
    assert.deepEqual(nameless.map(({ role }) => role.value), [], lab);
    const roles = new Set(worked.map(({ role }) => role.value));
    for (const role of ["tab", "button"]) assert.ok(roles.has(role), `${lab}: ${[...roles]}`);
    const parts = await page.evaluate(() => [...document.getElementById("outline").children].map(({ role, ariaLabel }) => `${role} ${ariaLabel}`));
    for (const part of ["banner Top bar", "main Stage", "region Timeline"]) assert.ok(parts.includes(part), `${lab}: ${parts}`);
    assert.deepEqual(await page.evaluate(outside), [], lab);
  }
});

// Fails when what opens over the page, or a list of lessons, is wrong for screen readers.
onOneBackend("menus, help and contents are elements as the page is", async ({ open }) => {
  const { page, segue } = await open("lab=blend&lesson=contents&play=off", { viewport: [1280, 800] });
  await elements(page);
  assert.deepEqual(await faults(page), [], "contents");
  assert.equal(await page.getByRole("button", { name: /^\d+\. / }).count(), LESSONS);
  await segue("set", { lesson: "" });
  await page.getByRole("combobox", { name: "A: Walk" }).focus();
  await page.keyboard.press("Enter");
  await until("the menu is open", async () => (await page.getByRole("menuitemradio", { name: "Run", exact: true }).count()) === 1);
  await elements(page);
  assert.deepEqual(await faults(page), [], "menu");
  await page.keyboard.press("Escape");
  await until("the menu is closed", async () => (await page.getByRole("menuitemradio").count()) === 0);
  await page.getByRole("button", { name: "Shortcuts" }).focus();
  await page.keyboard.press("Enter");
  await until("the help is open", async () => (await page.locator("#outline").textContent()).includes("Shift"));
  await elements(page);
  assert.deepEqual(await faults(page), [], "help");
});

// Fails when a window over the page, a refusal, the presenter or the other language is wrong for
// screen readers.
onOneBackend("dialogs, refusals, the presenter and Chinese are elements as the page is", async ({ open }) => {
  const { page, segue } = await open("lab=blend&play=off", { viewport: [1280, 800] });
  const button = (name) => page.getByRole("button", { name, exact: true }).first();
  const press = async (element) => {
    await until("it is there", async () => (await element.count()) > 0);
    await element.focus();
    await page.keyboard.press("Enter");
  };
  const sound = async (what) => {
    await elements(page);
    assert.deepEqual(await faults(page), [], what);
  };
  const closed = (what) => until(`${what} is closed`, async () => (await page.getByRole("dialog").count()) === 0);
  await elements(page);

  await press(page.getByRole("button", { name: /^Pose jump/ }).first());
  await until("the explanation is open", async () => (await page.getByRole("dialog", { name: "Pose jump" }).count()) === 1);
  await sound("explanation");
  await page.keyboard.press("Escape");
  await closed("the explanation");
  const number = await focused(page);
  assert.equal(number.what, "button");
  assert.match(number.name, /^Pose jump/, "the number has the keyboard again");

  await press(button("More ways to share"));
  await press(page.getByRole("menuitem", { name: "Convert many files…" }));
  await until("the converter is open", async () => (await page.getByRole("dialog", { name: "Convert many files" }).count()) === 1);
  await sound("converter");
  await page.keyboard.press("Escape");
  await closed("the converter");

  await segue("set", { lab: "speed", a: "idle", b: "idle" }).catch(() => {});
  await until("the refusal is told", async () => (await page.getByRole("main").textContent()).includes("Stand"));
  await sound("refusal");
  await segue("set", { lang: "zh-Hant", lab: "match" });
  await until("the page is Chinese", () => page.evaluate(() => document.documentElement.lang === "zh-Hant"));
  await sound("Chinese");
  await segue("set", { lang: "en", lab: "blend", a: "walk", b: "run" });
  await press(button("More ways to share"));
  await press(page.getByRole("menuitem", { name: "Present" }));
  await until("the stage stands alone", async () => (await page.locator("#outline > [aria-label='Library']").count()) === 0);
  await sound("presenter");
});

// Fails when Tab does not begin at the first element, leaves the reading order, or loses a press
// during a slow frame.
onOneBackend("Tab follows the reading order, and its first stop skips to the parameters", async ({ open }) => {
  const { page } = await open("lab=blend&play=off", { viewport: [1280, 800] });
  await elements(page);
  await page.keyboard.press("Tab");
  assert.deepEqual(await focused(page), { what: "skip", name: "Skip to the parameters" });
  await page.keyboard.press("Tab");
  assert.deepEqual(await focused(page), { what: "tab", name: "View" });
  // As fast as the keyboard gives them: twenty presses are twenty stops. A text field would hand
  // the keyboard to the app's own.
  const stops = await page.evaluate(() => [...document.querySelectorAll("#outline [tabindex='0']")].map(({ type, dataset }) => ({ type, number: dataset.number })));
  const presses = stops.findIndex(({ type }, index) => index >= 20 && type !== "text");
  for (let press = 0; press < presses; press++) await page.keyboard.press("Tab");
  assert.equal(await page.evaluate(() => document.activeElement.dataset.number), stops[presses].number);
  for (let press = 0; press <= presses; press++) await page.keyboard.press("Shift+Tab");
  assert.equal((await focused(page)).what, "skip");
  await page.keyboard.press("Enter");
  assert.equal(await page.evaluate(() => document.activeElement.closest("[role=form]").ariaLabel), "Parameters");
  const order = await page.evaluate(() => [...document.getElementById("outline").children].map(({ ariaLabel }) => ariaLabel));
  assert.deepEqual(order.filter(Boolean), ["Top bar", "Library", "Stage", "Parameters", "Timeline"]);
});

// Fails when the focus of an element does not reach its widget, its keys are lost, or an action of
// a screen reader has no effect.
onOneBackend("element passes keys and actions of screen readers to its widget", async ({ open }) => {
  const { page, segue } = await open("lab=blend&blend_window=30&play=off", { viewport: [1280, 800] });
  await elements(page);
  const params = (key, value) => until(`${key} is ${value}`, async () => (await segue("params"))[key] === value);
  const slider = page.getByRole("slider", { name: "Blend window", exact: true });
  await slider.focus();
  await page.keyboard.press("ArrowRight");
  await params("blend_window", 31);
  await until("the element follows", async () => (await slider.inputValue()) === "31");
  // As a screen reader sets it.
  await slider.evaluate((element) => { element.value = 12; element.dispatchEvent(new Event("input", { bubbles: true })); });
  await params("blend_window", 12);
  await page.getByRole("switch", { name: "Foot lock" }).evaluate((element) => element.click());
  await params("foot_lock", true);
  await until("the switch is on", async () => (await page.getByRole("switch", { name: "Foot lock" }).getAttribute("aria-checked")) === "true");
  await page.getByRole("tab", { name: "View" }).focus();
  await page.keyboard.press("Enter");
  await params("lab", "view");
  await until("the tab is selected", async () => (await page.getByRole("tab", { name: "View" }).getAttribute("aria-selected")) === "true");
});

// Fails when a number cannot be typed without a mouse.
onOneBackend("number of a slider is typed by keyboard alone", async ({ open }) => {
  const { page, segue } = await open("lab=blend&blend_window=30&play=off", { viewport: [1280, 800] });
  await elements(page);
  await page.getByRole("button", { name: "Blend window: Click to type a value" }).focus();
  await page.keyboard.press("Enter");
  await until("the number is edited", () => page.evaluate(() => document.activeElement.matches("input[type=text]")));
  await page.keyboard.press("Control+a");
  await page.keyboard.type("18");
  await page.keyboard.press("Enter");
  await until("it is 18", async () => (await segue("params")).blend_window === 18);
});

// Fails when the text of a lesson, or the way to the next one, is not among the elements.
onOneBackend("lessons are read from start to end by keyboard alone", async ({ open }) => {
  const { page, segue } = await open("play=off", { viewport: [1280, 800] });
  await elements(page);
  /** Presses Tab until the element has the keyboard, and then Enter. */
  const press = async (role, name) => {
    await until(`${name} is there`, async () => (await page.getByRole(role, { name }).count()) > 0);
    const wanted = await page.getByRole(role, { name }).first().elementHandle();
    for (let stop = 0; !(await wanted.evaluate((element) => element === document.activeElement)); stop++) {
      assert.ok(stop < 150, `Tab does not reach ${name}`);
      await page.keyboard.press("Tab");
    }
    await page.keyboard.press("Enter");
  };
  const words = () => page.evaluate(() => document.querySelector("#outline [aria-label='Lesson']")?.textContent ?? "");
  await press("button", "Lessons");
  await until("the contents are there", async () => (await segue("params")).lesson === "contents");
  await until("the contents can be read", async () => (await page.getByRole("button", { name: /^1\. / }).count()) > 0);
  const [read, texts] = [new Set(), new Set([await words()])];
  await press("button", /^1\. /);
  await until("the first lesson is there", async () => (await segue("params")).lesson === "alignment");
  for (let pages = 0; pages < 30; pages++) {
    const { lesson } = await segue("params");
    if (read.has(lesson) || lesson === "contents") break;
    // The elements follow a frame later.
    await until(`${lesson} can be read`, async () => !texts.has(await words()) && (await words()).length > 200);
    texts.add(await words());
    read.add(lesson);
    const next = page.getByRole("button", { name: "Next", exact: true });
    if ((await next.count()) === 0) break;
    // The way through the first page is the same as through the others.
    if (read.size === 1) await press("button", /^Next$/);
    else {
      await next.first().focus();
      await page.keyboard.press("Enter");
    }
    await until("the page is turned", async () => (await segue("params")).lesson !== lesson);
  }
  assert.equal(read.size, LESSONS, [...read].join());
});

// Fails when the page moves by itself although the system is set to little motion.
onOneBackend("page with reduced motion starts paused", async ({ open }) => {
  const { segue } = await open("", { viewport: [640, 480], motion: "reduce" });
  const before = await segue("time");
  assert.equal((await segue("params")).play, false);
  assert.equal(await segue("time"), before);
  await segue("play");
  await until("it plays", async () => (await segue("time")) !== before);
});

// Fails when the picture, a setting, a number or the link is missing.
onBothBackends("report has the picture, the settings, the numbers and the link", async ({ open }) => {
  const { segue } = await open("compare=a:walk,run&lab=view&play=off", { viewport: [960, 640] });
  await until("both are measured", async () => Object.values(await segue("metrics")).length > 3);
  const report = await segue("report");
  const [, picture] = report.match(/!\[[^\]]*\]\(data:image\/jpeg;base64,([^)]+)\)/);
  assert.ok(picture.length > 4_000, `${picture.length} characters of picture`);
  assert.match(report, /\| \| Walk \| Run \|/);
  assert.match(report, /\| Foot slide, cm \| [\d.]+ \| [\d.]+ \|/);
  assert.ok(report.includes("compare=a:walk,run") && report.includes("Segue 0."), report.replace(picture, "…"));
});
