// What the panel shows instead of a corpus: a choice of one, that one is being opened, or why it could not be.

import { button, element } from "./elements.js";
import { chooseFolder } from "./folder.js";
import { sentence } from "./words.js";

/**
 * Makes the choice of a corpus.
 * @param hooks openAddress(text): whether it is an address, openFiles(name, files)
 */
export function chooser({ openAddress, openFiles }) {
  const problem = element("p", { class: "problem", role: "alert" });
  const input = element("input", { type: "url", id: "corpus-address", placeholder: sentence("addressHint"), autocomplete: "url", spellcheck: false });
  const submit = (event) => {
    event.preventDefault();
    if (openAddress(input.value)) return;
    problem.textContent = sentence("wrongAddress");
    input.focus();
  };
  const open = async () => {
    try {
      const chosen = await chooseFolder();
      if (chosen) await openFiles(chosen.name, chosen.files);
    } catch (reason) {
      problem.textContent = String(reason?.message ?? reason);
    }
  };
  return element("div", { class: "message chooser" }, [
    element("h2", { textContent: sentence("chooseTitle") }),
    element("p", {}, withCode(sentence("chooseText"))),
    element("form", { noValidate: true, onsubmit: submit }, [
      element("label", { htmlFor: input.id, textContent: sentence("address") }),
      element("div", { class: "line" }, [input, button({ text: sentence("open"), type: "submit", class: "main" })]), problem,
    ]),
    button({ icon: "folder", text: sentence("folder"), onclick: open }),
    element("p", { class: "muted", textContent: sentence("folderText") }),
  ]);
}

/** Says that a corpus is being opened. */
export const opening = (name) => element("div", { class: "message", role: "status" }, [
  element("p", { textContent: sentence("opening", { name }) }), element("div", { class: "busy" }),
]);

/**
 * Says why a corpus could not be opened.
 * @param hooks again(), unless it cannot be tried again, and choose()
 */
export const failure = (reason, { again, choose }) => element("div", { class: "message" }, [
  element("p", { role: "alert" }, withCode(String(reason?.message ?? reason))),
  element("div", { class: "actions" }, [
    again ? button({ text: sentence("tryAgain"), class: "main", onclick: again }) : null,
    button({ text: sentence("other"), class: again ? "" : "main", onclick: choose }),
  ]),
]);

/** Returns the parts of a text, with code where it stands in backticks. */
const withCode = (text) => text.split("`").map((part, at) => (at % 2 ? element("code", { textContent: part }) : part));
