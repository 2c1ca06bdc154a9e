// Tests of lessons: bundled ones in both languages, and a teacher's own from another server.

import assert from "node:assert/strict";
import { onOneBackend } from "./harness.mjs";
import { elsewhere, until } from "./help.mjs";

const DESK = { viewport: [1280, 800] };

// Fails when the texts are not bundled, when a lesson that is opened alone does not set its state,
// and when it replaces the state of a link.
onOneBackend("lesson sets its state, and exists in both languages", async ({ open }) => {
  const asked = [];
  const prepare = (page) => page.on("request", (request) => asked.push(new URL(request.url()).pathname));
  const { segue } = await open("lesson=half_life", { ...DESK, prepare });
  const becomes = (lab) => until(`the lab becomes ${lab}`, async () => (await segue("params")).lab === lab);
  const isAsked = (file) => until(`${file} is asked for`, () => asked.some((path) => path.endsWith(`/lessons/${file}`)));
  await becomes("transition");
  await isAsked("en/04-half_life.md");
  await segue("set", { lang: "zh-Hant" });
  await isAsked("zh-Hant/04-half_life.md");
  await segue("set", { lesson: "loops" });
  await becomes("loop");
  await segue("set", { lesson: "slerp", lab: "make" });
  await isAsked("zh-Hant/02-slerp.md");
  assert.equal((await segue("params")).lab, "make", "a state that is named beside the lesson stays");
});

onOneBackend("lesson of another server is shown, or the reason why not", async ({ open }) => {
  const text = "# Mine\n\n[Begin](?lab=loop&a=walk)\n\nText.\n\n# Second\n\n[On](?lab=make&gait=run)\n";
  const type = "text/plain; charset=utf-8";
  const answers = { "/mine.md": { text, type }, "/closed.md": { text, type, cors: false }, "/long.md": { text: text.padEnd(300_000, "x"), type } };
  await elsewhere(answers, async (far) => {
    const { segue } = await open(`lesson=${far}/mine.md`, DESK);
    const becomes = (lab) => until(`the lab becomes ${lab}`, async () => (await segue("params")).lab === lab);
    await becomes("loop");
    await segue("set", { lesson: `${far}/mine.md#2` });
    await becomes("make");
    for (const file of ["closed.md", "long.md", "gone.md"]) {
      await segue("set", { lesson: `${far}/${file}` }); // resolves once the text is there, or refused
      assert.equal((await segue("params")).lab, "make", `${file} changes nothing`);
    }
  });
});
