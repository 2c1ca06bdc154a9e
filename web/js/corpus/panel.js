// The panel of a corpus, beside the stage; on a phone, over it. panel.css has its looks. What it
// shows of a corpus that is open has open_corpus.js.

import { corpusAddress, corpusName } from "./address.js";
import { corpusAt, corpusOf } from "./client.js";
import { lengthText } from "./dock.js";
import { DropTargets } from "./drop_targets.js";
import { button, delayed, element } from "./elements.js";
import { filesOfEntry } from "./folder.js";
import { Layout } from "./layout.js";
import { chooser, failure, opening } from "./messages.js";
import { OpenCorpus } from "./open_corpus.js";
import { Player } from "./player.js";
import { loadCatalogue, sentence } from "./words.js";

export class Panel {
  #api;
  #player;
  #root;
  #layout;
  #targets = new DropTargets();
  /** What is open, or should be: { address, name } or { files, name }; undefined while a corpus is chosen. */
  #place;
  #isOpening = false;
  /** The `OpenCorpus`; undefined unless it is open. */
  #open;
  /** Makes what the panel shows, in the language of the page. */
  #content = () => [];
  /** Counts what the panel has shown: what comes late for something else is dropped. */
  #turn = 0;
  #language = document.documentElement.lang;
  #followSoon = delayed(() => this.#follow(), 150);
  #linkSoon = delayed(() => this.#link(), 300);
  /** The text that the panel has put into the link by itself. */
  #linked;

  /** Makes the panel, with its style. */
  static async make(api, app) {
    const style = element("link", { rel: "stylesheet", href: new URL("./panel.css", import.meta.url).href });
    const loaded = new Promise((resolve) => {
      style.addEventListener("load", resolve);
      style.addEventListener("error", resolve);
    });
    document.head.append(style);
    await loaded;
    return new Panel(api, app);
  }

  constructor(api, app) {
    this.#api = api;
    this.#player = new Player(api, app);
    this.#root = element("section", {
      id: "corpus", class: "corpus", role: "complementary", onkeydown: (event) => this.#key(event), ondragover: (event) => this.#dragOver(event), ondrop: (event) => this.#drop(event),
    });
    this.#layout = new Layout(this.#root, () => this.#open?.layOut());
    api.on("change", () => this.#followSoon());
    new MutationObserver(() => this.#relabel()).observe(document.documentElement, { attributeFilter: ["lang"] });
    window.matchMedia("(prefers-color-scheme: light)").addEventListener("change", () => this.#theme());
  }

  // What is open.

  /**
   * Shows the corpus at an address, with the filter behind it; without one, closes the one that an
   * address names.
   */
  async show(text) {
    if (text === this.#linked) return;
    this.#endLink();
    if (!text) {
      // The link is as it should be, and may name another corpus by now.
      if (this.#place && !this.#place.files) this.#leave();
      return;
    }
    const address = corpusAddress(text);
    if (!address) return this.#fail({ name: text }, new Error(sentence("wrongAddress")));
    const filter = text.split("#").slice(1).join("#");
    const isHere = this.#place?.address === address && (this.#isOpening || (this.#open && !this.#open.hasFailed));
    if (!isHere) return this.#connectTo({ address, name: corpusName(address), filter });
    this.#place.filter = filter;
    if (this.#open) this.#open.filter = filter;
    this.#layout.showPanel(true);
  }

  #connectTo(place) {
    return this.#connect(place, () => corpusAt(place.address));
  }

  /** Puts what the table shows into the link. */
  #link() {
    const { address } = this.#place;
    if (!this.#open || !address) return;
    const { filter } = this.#open;
    this.#linked = filter ? `${address}#${filter}` : address;
    this.#place.filter = filter;
    if (this.#linked !== this.#api.params().corpus) this.#api.set({ corpus: this.#linked }).catch((reason) => console.error(reason));
  }

  /** Leaves the link as it is. */
  #endLink() {
    this.#linkSoon.cancel();
    this.#linked = undefined;
  }

  /** Lets the user choose a corpus. */
  choose() {
    if (this.#open) return this.#layout.showPanel(true);
    const turn = this.#begin(undefined);
    const openAddress = (text) => {
      const address = corpusAddress(text);
      if (!address) return false;
      this.show(address);
      this.#api.set({ corpus: address }).catch((reason) => console.error(reason));
      return true;
    };
    const openFiles = async (name, files) => {
      if (turn === this.#turn) await this.#openFiles(name, files);
    };
    this.#build(() => [chooser({ openAddress, openFiles })]);
    this.#root.querySelector("input").focus();
  }

  /** Shows the corpus in a dropped folder. */
  async showEntry(entry) {
    const turn = this.#turn;
    try {
      const files = await filesOfEntry(entry);
      if (turn === this.#turn) await this.#openFiles(entry.name, files);
    } catch (reason) {
      if (turn === this.#turn) this.#fail({ name: entry.name }, reason);
    }
  }

  async #openFiles(name, files) {
    if (!files.has("corpus.json")) {
      const reason = new Error(sentence("noFolder", { name }));
      return this.#open ? this.#open.say(reason) : this.#fail({ name }, reason);
    }
    await this.#connect({ name, files }, () => corpusOf(files));
  }

  async #connect(place, connect) {
    const turn = this.#begin(place);
    this.#isOpening = true;
    this.#build(() => [opening(place.name)]);
    let client;
    try {
      client = connect();
      const facts = await client.opened;
      await loadCatalogue();
      if (turn !== this.#turn) return;
      const hooks = { api: this.#api, player: this.#player, layout: this.#layout, targets: this.#targets, filtered: () => this.#linkSoon() };
      this.#open = new OpenCorpus(place, client, facts, hooks, place.filter);
    } catch (reason) {
      if (turn === this.#turn) this.#fail(place, reason);
      return;
    } finally {
      if (turn === this.#turn) this.#isOpening = false;
      // Those of addresses are kept for a while.
      if (place.files && this.#open?.place !== place) client?.end();
    }
    const open = this.#open;
    this.#build(() => open.build());
    await open.start();
    // No link can name it.
    if (place.files && turn === this.#turn && this.#api.params().corpus) await this.#api.set({ corpus: "" });
  }

  /** Begins to show something else. Returns its turn. */
  #begin(place) {
    this.#open?.end();
    this.#endLink();
    [this.#open, this.#place, this.#isOpening] = [undefined, place, false];
    this.#layout.attach(this.#targets.root);
    this.#theme();
    return ++this.#turn;
  }

  #fail(place, reason) {
    this.#begin(place);
    console.info(reason);
    const again = place.address && (() => this.#connectTo(place));
    this.#build(() => [failure(reason, { again, choose: () => this.choose() })]);
  }

  /** Closes the panel by hand. */
  #close() {
    this.#leave();
    if (this.#api.params().corpus) this.#api.set({ corpus: "" }).catch((reason) => console.error(reason));
  }

  /** Closes the panel, and leaves the link as it is. */
  #leave() {
    const hadFocus = this.#root.contains(document.activeElement) || document.activeElement === document.body;
    this.#open?.end();
    this.#endLink();
    [this.#open, this.#place, this.#isOpening] = [undefined, undefined, false];
    this.#turn++;
    this.#layout.detach(this.#targets.root);
    if (hadFocus) document.getElementById("segue").focus({ preventScroll: true });
  }

  // The page around it.

  /** Fills the panel. */
  #build(content = this.#content) {
    this.#content = content;
    const [place, open] = [this.#place, this.#open];
    this.#root.setAttribute("aria-label", sentence("corpus"));
    this.#root.classList.toggle("filtering", open?.isFiltering ?? false);
    const host = place?.address ? new URL(place.address).host : place?.files ? sentence("local") : "";
    const about = [host, open && lengthText(open.seconds)].filter(Boolean).join(" · ");
    const parts = content();
    this.#root.replaceChildren(
      element("header", {}, [
        element("div", { class: "who", title: place?.address ?? (place?.files ? sentence("localLink") : "") }, [
          element("h1", { textContent: place?.name ?? sentence("corpus") }), element("small", { textContent: about }),
        ]),
        open ? open.viewChoice : null,
        button({ text: sentence("stage"), class: "to-stage", onclick: () => this.#layout.showPanel(false) }),
        button({ icon: "close", name: sentence("closeCorpus"), class: "quiet close", "aria-keyshortcuts": "Escape", onclick: () => this.#close() }),
      ]),
      ...parts,
      this.#layout.build(),
    );
    this.#layout.update();
  }

  /** Builds all texts again, in another language. */
  async #relabel() {
    const { lang } = document.documentElement;
    if (lang === this.#language) return;
    this.#language = lang;
    if (!this.#root.isConnected) return;
    const turn = this.#turn;
    await loadCatalogue();
    if (turn !== this.#turn || lang !== this.#language) return;
    this.#build();
    await this.#open?.rebuilt();
  }

  #follow() {
    if (!this.#root.isConnected) return;
    this.#theme();
    this.#open?.follow();
  }

  #theme() {
    const { theme } = this.#api.params();
    const isLight = theme === "light" || (theme !== "dark" && window.matchMedia("(prefers-color-scheme: light)").matches);
    const word = isLight ? "light" : "dark";
    if (this.#root.dataset.theme === word) return;
    for (const part of [this.#root, this.#targets.root, ...this.#layout.elements]) part.dataset.theme = word;
    this.#open?.draw();
  }

  #key(event) {
    if (event.key !== "Escape" || event.defaultPrevented) return;
    event.preventDefault();
    event.stopPropagation();
    if (!this.#open?.goBack()) this.#close();
  }

  #dragOver(event) {
    if ([...event.dataTransfer.types].includes("Files")) event.preventDefault();
  }

  /** Opens a folder that is dropped on the panel, or loads files as the stage does. */
  async #drop(event) {
    if (![...event.dataTransfer.types].includes("Files")) return;
    event.preventDefault();
    const files = [...event.dataTransfer.files];
    const folder = [...event.dataTransfer.items].map((item) => item.webkitGetAsEntry?.()).find((entry) => entry?.isDirectory);
    if (folder) return this.showEntry(folder);
    for (const file of files) {
      const loaded = file.arrayBuffer().then((bytes) => this.#api.load(file.name, bytes));
      await loaded.catch((reason) => (this.#open ? this.#open.say(reason) : console.info(reason)));
    }
  }
}
