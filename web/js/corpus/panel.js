// The panel of a corpus, beside the stage; on a phone, over it. panel.css has its looks.

import { clipAddress, clipOf, corpusAddress, corpusName } from "./address.js";
import { clipsRead, corpusAt, corpusOf, isRead, readClip } from "./client.js";
import { Dock, lengthText } from "./dock.js";
import { button, delayed, element, icon, segments } from "./elements.js";
import { Filters, LAST } from "./filters.js";
import { chooseFolder, filesOfEntry } from "./folder.js";
import { BINS } from "./histogram.js";
import { ClipMap } from "./map.js";
import { Player, addresses } from "./player.js";
import { ClipTable, written } from "./table.js";
import { columnName, loadCatalogue, number, sentence, valueText } from "./words.js";

const WIDTHS = { least: 380, usual: 540, most: 1100 };
/** The least width of the stage beside the panel, pixels. */
const MIN_STAGE = 420;
const WIDTH_KEY = "segue corpus width";
/** The page is narrower than this on a phone. */
const PHONE = window.matchMedia("(max-width: 700px)");
/** The widths of what a row has beside its numbers, and of a number, pixels. */
const ROW_REST = 456;
const NUMBER_WIDTH = 72;
const HITS = 40;

export class Panel {
  #api;
  #player;
  #root;
  /** The way back to the panel from the stage of a phone. */
  #back;
  #targets;
  /** What is open: { address, name } or { files, name }; undefined while a corpus is chosen. */
  #place;
  /** The same while it is being opened. */
  #opening;
  #client;
  #facts;
  #filter;
  /** The rows of the table. */
  #rows = new Uint32Array();
  /** A search or copies instead of all clips: { kind, title, hits } or { kind, title, near }. */
  #list;
  #view = "table";
  #filtersOpen = false;
  #map;
  #mapPoints;
  /** The clip of the corpus on the stage: { row, id, name, seconds, range, clipId, copies }. */
  #current;
  #dragged;
  #parts = {};
  #width = WIDTHS.usual;
  #language = document.documentElement.lang;
  #asked = 0;
  #sync = delayed(() => this.#follow(), 150);
  #refreshSoon = delayed(() => this.#refresh(), 60);

  /** Makes the panel, with its style. */
  static async make(api, discard) {
    const style = element("link", { rel: "stylesheet", href: new URL("./panel.css", import.meta.url).href });
    const loaded = new Promise((resolve) => {
      style.addEventListener("load", resolve);
      style.addEventListener("error", resolve);
    });
    document.head.append(style);
    await loaded;
    return new Panel(api, discard);
  }

  constructor(api, discard) {
    this.#api = api;
    this.#player = new Player(api, discard);
    this.#root = element("section", { id: "corpus", class: "corpus", role: "complementary", onkeydown: (event) => this.#key(event) });
    this.#back = element("button", { type: "button", class: "corpus corpus-back", hidden: true, onclick: () => this.#showPanel(true) });
    this.#targets = element("div", { class: "corpus corpus-targets", hidden: true });
    this.#root.addEventListener("dragover", (event) => this.#dragOver(event));
    this.#root.addEventListener("drop", (event) => this.#drop(event));
    this.#width = Number(readStored(WIDTH_KEY)) || WIDTHS.usual;
    api.on("change", () => this.#sync());
    new MutationObserver(() => this.#relabel()).observe(document.documentElement, { attributeFilter: ["lang"] });
    window.matchMedia("(prefers-color-scheme: light)").addEventListener("change", () => this.#theme());
    PHONE.addEventListener("change", () => this.#layOut());
    window.addEventListener("resize", () => this.#layOut());
  }

  // What is open.

  /** Shows the corpus at an address; without one, closes the one that an address names. */
  async show(text) {
    if (!text) {
      if (this.#place && !this.#place.files) this.#close();
      return;
    }
    const address = corpusAddress(text);
    if (!address) return this.#fail({ name: text }, new Error(sentence("wrongAddress")));
    if (this.#place?.address === address && (this.#client || this.#opening === this.#place)) return this.#showPanel(true);
    await this.#open({ address, name: corpusName(address) }, () => corpusAt(address));
  }

  /** Lets the user choose a corpus. */
  choose() {
    if (this.#client) return this.#showPanel(true);
    this.#begin(undefined);
    this.#build(this.#chooser());
    this.#root.querySelector("input").focus();
  }

  /** Shows the corpus in a dropped folder. */
  async showEntry(entry) {
    try {
      await this.#openFiles(entry.name, await filesOfEntry(entry));
    } catch (reason) {
      this.#fail({ name: entry.name }, reason);
    }
  }

  async #openFiles(name, files) {
    if (!files.has("corpus.json")) return this.#fail({ name }, new Error(sentence("noFolder", { name })));
    await this.#open({ name, files }, () => corpusOf(files));
    // No link can name it.
    if (this.#api.params().corpus) await this.#api.set({ corpus: "" });
  }

  async #open(place, connect) {
    this.#begin(place);
    this.#opening = place;
    this.#build(element("div", { class: "message", role: "status" }, [element("p", { textContent: sentence("opening", { name: place.name }) }), element("div", { class: "busy" })]));
    try {
      const client = connect();
      const facts = await client.opened;
      if (this.#place !== place) return;
      [this.#client, this.#facts] = [client, facts];
      await loadCatalogue();
      [this.#filter, this.#filtersOpen] = [newFilter(), false];
      this.#build(this.#content());
      await this.#refresh();
      client.call("prepare").catch((reason) => console.info(reason));
      await this.#follow();
      this.#parts.table?.reveal(this.#current?.row);
    } catch (reason) {
      if (this.#place === place && reason?.name !== "AbortError") this.#fail(place, reason);
    } finally {
      if (this.#opening === place) this.#opening = undefined;
    }
  }

  #begin(place) {
    if (!this.#place?.address) this.#client?.end();
    this.#parts.table?.end();
    [this.#place, this.#client, this.#facts, this.#list, this.#map, this.#mapPoints, this.#current] = [place];
    [this.#view, this.#rows, this.#parts] = ["table", new Uint32Array(), {}];
    if (!this.#root.isConnected) document.getElementById("segue").before(this.#root, this.#back, this.#targets);
    this.#showPanel(true);
    this.#theme();
  }

  #fail(place, reason) {
    this.#begin(place);
    console.info(reason);
    const again = () => (place.address ? this.show(place.address) : this.choose());
    this.#client = undefined;
    this.#build(element("div", { class: "message" }, [
      element("p", { role: "alert", textContent: String(reason?.message ?? reason) }),
      element("div", { class: "actions" }, [
        place.address ? button({ text: sentence("tryAgain"), class: "main", onclick: again }) : null,
        button({ text: sentence("other"), class: place.address ? "" : "main", onclick: () => this.choose() }),
      ]),
    ]));
  }

  #close() {
    const hadFocus = this.#root.contains(document.activeElement) || document.activeElement === document.body;
    if (!this.#place?.address) this.#client?.end();
    this.#parts.table?.end();
    [this.#place, this.#client, this.#parts] = [undefined, undefined, {}];
    this.#root.remove();
    this.#back.remove();
    this.#targets.remove();
    this.#layOut();
    if (hadFocus) document.getElementById("segue").focus({ preventScroll: true });
    if (this.#api.params().corpus) this.#api.set({ corpus: "" }).catch((reason) => console.error(reason));
  }

  /** Opens what the user has typed. */
  #openAddress(input, problem) {
    const address = corpusAddress(input.value);
    if (!address) {
      problem.textContent = sentence("wrongAddress");
      return input.focus();
    }
    this.show(address);
    this.#api.set({ corpus: address }).catch((reason) => console.error(reason));
  }

  // The parts.

  #chooser() {
    const problem = element("p", { class: "problem", role: "alert" });
    const input = element("input", { type: "url", id: "corpus-address", placeholder: sentence("addressHint"), autocomplete: "url", spellcheck: false });
    const form = element("form", {
      noValidate: true,
      onsubmit: (event) => {
        event.preventDefault();
        this.#openAddress(input, problem);
      },
    }, [element("label", { htmlFor: "corpus-address", textContent: sentence("address") }), element("div", { class: "line" }, [input, button({ text: sentence("open"), type: "submit", class: "main" })]), problem]);
    const open = async () => {
      try {
        const chosen = await chooseFolder();
        if (chosen) await this.#openFiles(chosen.name, chosen.files);
      } catch (reason) {
        problem.textContent = String(reason?.message ?? reason);
      }
    };
    return element("div", { class: "message chooser" }, [
      element("h2", { textContent: sentence("chooseTitle") }),
      element("p", {}, withCode(sentence("chooseText"))),
      form,
      button({ icon: "folder", text: sentence("folder"), onclick: open }),
      element("p", { class: "muted", textContent: sentence("folderText") }),
    ]);
  }

  #content() {
    const { columns } = this.#facts;
    const parts = this.#parts;
    parts.search = element("input", {
      type: "search", value: this.#filter.text, placeholder: sentence("search"), "aria-label": sentence("search"), spellcheck: false, autocomplete: "off", enterKeyHint: "search",
      oninput: () => {
        this.#filter.text = parts.search.value;
        this.#changed();
      },
      onkeydown: (event) => {
        if (event.key === "Escape" && parts.search.value) {
          event.stopPropagation();
          event.preventDefault();
          parts.search.value = this.#filter.text = "";
          this.#changed();
        } else if (event.key === "ArrowDown" || event.key === "Enter") {
          event.preventDefault();
          parts.table.focus();
        }
      },
    });
    parts.filtersButton = button({ icon: "filter", text: sentence("filters"), "aria-expanded": String(this.#filtersOpen), onclick: () => this.#toggleFilters() });
    parts.filters = new Filters(columns, this.#filter, () => this.#changed());
    parts.filters.root.hidden = !this.#filtersOpen;
    parts.chips = element("div", { class: "set-filters" });
    parts.count = element("p", { class: "count", role: "status" });
    parts.problem = element("p", { class: "problem", role: "alert" });
    parts.table = new ClipTable({
      play: (row) => this.#play(row),
      put: (row, slot) => this.#put(row, slot),
      sort: (column) => this.#sort(column),
      cells: (rows) => this.#client.call("cells", { rows }),
      thumbnails: (rows, signal, onPart) => this.#client.call("thumbnails", { rows }, { signal, onPart }),
      drag: (row) => this.#drag(row),
      say: (reason) => this.#say(reason),
    });
    parts.body = element("div", { class: "view" }, [parts.table.root]);
    parts.dock = new Dock({
      like: () => this.#like(),
      copies: () => this.#showCopies(),
      put: (slot) => this.#put(this.#current.row, slot, this.#current.range),
      range: (range) => this.#play(this.#current.row, { range, isCut: true }),
      seek: (seconds) => this.#api.seek(Math.max(seconds - (this.#current.range?.[0] ?? 0), 0)),
      time: () => this.#time(),
    });
    requestAnimationFrame(() => this.#tick());
    return [
      element("div", { class: "tools" }, [element("div", { class: "field" }, [icon("search"), parts.search]), parts.filtersButton]),
      parts.filters.root, parts.chips,
      element("div", { class: "status" }, [parts.count]),
      parts.problem, parts.body, parts.dock.root,
    ];
  }

  #build(content) {
    this.#root.setAttribute("aria-label", sentence("corpus"));
    this.#root.classList.toggle("filtering", this.#filtersOpen);
    const views = this.#client && [
      { text: sentence("table"), isChosen: this.#view === "table", choose: () => this.#choose("table") },
      { text: sentence("map"), isChosen: this.#view === "map", choose: () => this.#choose("map") },
    ];
    const place = this.#place;
    const host = place?.address ? new URL(place.address).host : place?.files ? sentence("local") : "";
    const counts = this.#facts?.counts;
    const about = [host, counts && lengthText(counts.seconds)].filter(Boolean).join(" · ");
    this.#parts.views = views ? segments(sentence("view"), views) : element("span");
    this.#parts.resizer = element("div", {
      class: "resizer", role: "separator", tabIndex: 0, "aria-orientation": "vertical", "aria-label": sentence("resize"), "aria-valuemin": WIDTHS.least, "aria-valuemax": WIDTHS.most,
      onpointerdown: (event) => this.#grip(event), onkeydown: (event) => this.#resizeByKey(event),
    });
    this.#root.replaceChildren(
      element("header", {}, [
        element("div", { class: "who", title: place?.address ?? (place?.files ? sentence("localLink") : "") }, [
          element("h1", { textContent: place?.name ?? sentence("corpus") }), element("small", { textContent: about }),
        ]),
        this.#parts.views,
        button({ text: sentence("stage"), class: "to-stage", onclick: () => this.#showPanel(false) }),
        button({ icon: "close", name: sentence("closeCorpus"), class: "quiet close", onclick: () => this.#close() }),
      ]),
      ...[content].flat(),
      this.#parts.resizer,
    );
    this.#back.replaceChildren(icon("left"), element("span", { textContent: sentence("corpus") }));
    this.#layOut();
  }

  /** Builds all texts again, in another language. */
  async #relabel() {
    const { lang } = document.documentElement;
    if (lang === this.#language) return;
    this.#language = lang;
    if (!this.#root.isConnected) return;
    await loadCatalogue();
    if (!this.#client) return this.#place ? undefined : this.choose();
    const top = this.#current?.row;
    this.#parts.table.end();
    this.#map = undefined;
    this.#build(this.#content());
    this.#choose(this.#view);
    await this.#refresh();
    this.#showCurrent();
    if (top !== undefined) this.#parts.table.reveal(top);
  }

  // The rows.

  /** Shows all clips that fit the filter, after it has changed. */
  #changed() {
    if (this.#list) this.#list = undefined;
    this.#refreshSoon();
  }

  async #refresh() {
    const { table, filters } = this.#parts;
    if (!table) return;
    const asked = ++this.#asked;
    const filter = { ...this.#filter, ...(this.#list?.near && { text: "", ranges: {}, choices: {}, copies: "all", near: this.#list.near }) };
    if (this.#list?.hits) {
      const { hits } = this.#list;
      this.#rows = Uint32Array.from(hits, ({ row }) => row);
      this.#showRows(new Map(hits.map((hit) => [hit.row, hit])));
      return;
    }
    try {
      const rows = await this.#client.call("select", { filter });
      if (asked !== this.#asked) return;
      this.#rows = rows;
      this.#showRows();
      if (!this.#filtersOpen) return;
      const counts = await this.#client.call("histograms", { columns: filters.counted, filter: this.#filter, bins: BINS });
      if (asked === this.#asked) filters.setCounts(counts);
    } catch (reason) {
      this.#say(reason);
    }
  }

  #showRows(hits) {
    const { table, count, chips, filtersButton, search } = this.#parts;
    const all = this.#facts.rows;
    table.setColumns(this.#shownColumns(), this.#list?.hits ? {} : this.#filter.sort);
    table.setRows(this.#rows, hits);
    table.setCurrent(this.#current?.row);
    this.#map?.setRows(this.#rows);
    this.#map?.setMarks(this.#current?.row, this.#list?.hits ? [...this.#rows] : []);
    const texts = { count: number(this.#rows.length), all: number(all) };
    const counted = this.#rows.length === all ? sentence("allClips", { count: texts.all }) : sentence("someClips", texts);
    const isEmpty = this.#rows.length === 0;
    count.replaceChildren(...(this.#list
      ? [button({ icon: "left", text: sentence("back"), class: "quiet back", onclick: () => this.#leaveList() }), element("b", { textContent: this.#list.title })]
      : [element("span", { textContent: isEmpty ? sentence("noClips") : counted })]));
    const active = this.#activeFilters();
    filtersButton.classList.toggle("set", active.length > 0);
    chips.replaceChildren(...(this.#list ? [] : active.map(({ text, clear }) => button({
      icon: "close", text, class: "chip", title: sentence("remove", { name: text }), onclick: () => {
        clear();
        this.#parts.filters.update();
        this.#changed();
      },
    }))));
    if (!this.#list && active.length > 1) {
      chips.append(button({ text: sentence("clearFilters"), class: "quiet", onclick: () => {
        for (const { clear } of active) clear();
        this.#parts.filters.update();
        this.#changed();
      } }));
    }
    if (search.value !== this.#filter.text) search.value = this.#filter.text;
  }

  /** Returns the filters that are set, each with its text and how to clear it. */
  #activeFilters() {
    const { ranges, choices, copies } = this.#filter;
    const columnOf = (name) => this.#facts.columns.find((column) => column.name === name);
    const active = Object.entries(ranges).map(([name, [from, to]]) => {
      const column = columnOf(name);
      const ends = from === null ? `≤ ${written(to, column)}` : to === null ? `≥ ${written(from, column)}` : `${written(from, column)} – ${written(to, column)}`;
      return { text: `${columnName(column)} ${ends}`, clear: () => delete ranges[name] };
    });
    for (const [name, values] of Object.entries(choices)) active.push({ text: values.map((value) => valueText(columnOf(name), value)).join(", "), clear: () => delete choices[name] });
    if (copies !== "all") active.push({ text: `${sentence("copies")}: ${sentence(copies === "hide" ? "copiesHide" : "copiesOnly")}`, clear: () => { this.#filter.copies = "all"; } });
    return active;
  }

  /** Returns the columns of numbers that there is room for: those first that are looked at. */
  #shownColumns() {
    const { columns } = this.#facts;
    const { sort, ranges } = this.#filter;
    const numbers = columns.filter(({ kind, name }) => kind === "number" && name !== "seconds");
    const rank = ({ name }) => (name === sort.by ? -2 : name in ranges ? -1 : LAST.includes(name) ? 1 : 0);
    const ordered = numbers.toSorted((one, other) => rank(one) - rank(other));
    const width = PHONE.matches ? 0 : this.#root.clientWidth;
    const room = Math.max(Math.floor((width - ROW_REST) / NUMBER_WIDTH), PHONE.matches ? 0 : 1);
    const seconds = columns.filter(({ name }) => name === "seconds");
    const distance = this.#list?.hits ? [{ name: "distance", label: "", kind: "number" }] : [];
    return [...distance, ...seconds, ...ordered.slice(0, Math.max(room - distance.length, 0))];
  }

  #sort(by) {
    const { sort } = this.#filter;
    // Of numbers, the greatest are looked for first.
    const down = sort.by === by ? !sort.down : by !== "name";
    this.#filter.sort = { by, down };
    if (this.#list?.hits) this.#list = undefined;
    this.#refresh();
  }

  #toggleFilters() {
    this.#filtersOpen = !this.#filtersOpen;
    const { filters, filtersButton } = this.#parts;
    filters.root.hidden = !this.#filtersOpen;
    this.#root.classList.toggle("filtering", this.#filtersOpen);
    filtersButton.setAttribute("aria-expanded", String(this.#filtersOpen));
    if (!this.#filtersOpen) return;
    this.#list = undefined;
    this.#refresh();
  }

  #leaveList() {
    this.#list = undefined;
    this.#refresh();
    this.#parts.table.focus();
  }

  async #choose(view) {
    this.#view = view;
    const { table, body } = this.#parts;
    const hadFocus = this.#parts.views.contains(document.activeElement);
    this.#parts.views.replaceWith((this.#parts.views = segments(sentence("view"), ["table", "map"].map((name) => ({ text: sentence(name), isChosen: name === view, choose: () => this.#choose(name) })))));
    if (hadFocus) this.#parts.views.querySelector("[aria-checked='true']").focus({ preventScroll: true });
    if (view === "table") return body.replaceChildren(table.root);
    try {
      this.#mapPoints ??= await this.#client.call("map");
    } catch (reason) {
      return this.#say(reason);
    }
    if (this.#view !== "map") return;
    this.#map ??= new ClipMap(this.#mapPoints, { play: (row) => this.#play(row), describe: (row) => this.#describe(row) });
    body.replaceChildren(this.#map.root);
    this.#map.setRows(this.#rows);
    this.#map.setMarks(this.#current?.row, this.#list?.hits ? [...this.#rows] : []);
  }

  /** Returns the hint of a point on the map. */
  async #describe(row) {
    const [[cell], picture] = await Promise.all([this.#client.call("cells", { rows: [row] }), this.#thumbnail(row).catch(() => null)]);
    const image = picture && element("canvas", { width: 264, height: 48 });
    image?.getContext("2d").drawImage(picture, 0, 0);
    const facts = [`${cell.seconds?.toFixed(2) ?? "–"} s`, cell.format?.toUpperCase(), cell.labels?.join(", ")].filter(Boolean);
    return [image, element("b", { textContent: cell.name }), element("small", { textContent: facts.join(" · ") })].filter(Boolean);
  }

  async #thumbnail(row) {
    let png;
    await this.#client.call("thumbnails", { rows: [row] }, { onPart: ([, bytes]) => { png = bytes; } });
    return png ? createImageBitmap(new Blob([png], { type: "image/png" })) : null;
  }

  // The stage.

  /** Plays a clip alone, from the moment that a search has found in it. */
  async #play(row, { range, isCut = false } = {}) {
    const hit = this.#list?.hits?.find((hit) => hit.row === row);
    // On a phone, the stage lies behind the panel.
    if (PHONE.matches && !isCut) this.#showPanel(false);
    await this.#load(row, { range, seconds: isCut ? undefined : hit?.seconds });
  }

  async #put(row, slot, range) {
    await this.#load(row, { slot, range });
    if (PHONE.matches) this.#showPanel(false);
  }

  async #load(row, { slot, range, seconds }) {
    const [client, place] = [this.#client, this.#place];
    this.#parts.problem.textContent = "";
    let name = "";
    try {
      const [cell] = await client.call("cells", { rows: [row] });
      ({ name } = cell);
      if (!slot) this.#parts.table.setCurrent(row);
      const read = async () => {
        const { bytes } = await client.call("clip", { id: cell.id, range });
        return [`${name.replaceAll("/", " ")}.npz`, bytes];
      };
      const clip = place.address ? { corpus: place.address, id: cell.id, range } : { read };
      await this.#player.put(clip, { slot, seconds });
      if (this.#client !== client) return;
      const params = this.#api.params();
      if (!slot) await this.#setCurrent({ row, id: cell.id, name, seconds: cell.seconds, range, clipId: params.a });
    } catch (reason) {
      if (reason?.name === "AbortError" || this.#client !== client) return;
      this.#showCurrent();
      this.#showPanel(true);
      this.#say(new Error(sentence("noRead", { name, reason: String(reason?.message ?? reason) })));
    }
  }

  async #setCurrent(current) {
    this.#current = current;
    if (current) {
      const copies = await this.#client.call("copiesOf", { row: current.row });
      if (this.#current === current) current.copies = copies.length;
    }
    await this.#showCurrent();
  }

  /** Shows in the table, on the map and at the foot what is on the stage. */
  async #showCurrent() {
    const [current, { table, dock }] = [this.#current, this.#parts];
    if (!table) return;
    const params = this.#api.params();
    const isPlaying = current && current.clipId === params.a;
    table.setCurrent(isPlaying ? current.row : undefined);
    this.#map?.setMarks(isPlaying ? current.row : undefined, this.#list?.hits ? [...this.#rows] : []);
    if (!isPlaying) {
      const clip = this.#api.clips().find(({ id }) => id === params.a);
      return dock.show({ name: clip?.name });
    }
    dock.show(current, current.picture);
    current.picture ??= await this.#thumbnail(current.row).catch(() => undefined);
    if (current === this.#current) dock.show(current, current.picture);
  }

  /** Follows changes of the app: its theme, and the clip on the stage. */
  async #follow() {
    if (!this.#root.isConnected) return;
    this.#theme();
    const client = this.#client;
    if (!client) return;
    if (this.#place.address) {
      await this.#learn();
      const playing = this.#player.playing(this.#place.address);
      const isKnown = playing && this.#current?.id === playing.id && String(this.#current?.range) === String(playing.range);
      if (playing && !isKnown && this.#client === client) {
        const row = clipsRead.get(clipAddress(playing.corpus, playing.id, playing.range))?.row ?? (await client.call("find", { id: playing.id }));
        if (row === undefined) return;
        const [{ name, seconds, id }] = await client.call("cells", { rows: [row] });
        return this.#setCurrent({ row, id, name, seconds, range: playing.range, clipId: playing.clipId });
      }
    }
    await this.#showCurrent();
  }

  /**
   * Learns the SHA-256 of the link's clips that came from the browser's storage: a name alone may be
   * that of another clip. They are read for that, once.
   */
  async #learn() {
    for (const source of addresses(this.#api.params())) {
      const clip = clipOf(source);
      if (clip?.corpus !== this.#place.address || isRead(source)) continue;
      const row = await this.#client.call("find", { id: clip.id });
      if (row === undefined) continue;
      const [{ name }] = await this.#client.call("cells", { rows: [row] });
      if (this.#player.hasNamed(name) && !isRead(source)) await readClip(source).catch((reason) => console.info(reason));
    }
  }

  /** Returns the time in the clip on the stage, seconds; undefined while it does not play alone. */
  #time() {
    const params = this.#api.params();
    if (params.lab !== "view" || params.a !== this.#current?.clipId) return undefined;
    return (this.#current.range?.[0] ?? 0) + this.#api.time();
  }

  #tick() {
    if (!this.#root.isConnected || !this.#client) return;
    if (!this.#root.hidden) this.#parts.dock.tick();
    // Ten times a second are enough for a line, and leave the time to the stage.
    setTimeout(() => requestAnimationFrame(() => this.#tick()), 100);
  }

  /** Searches for the moments that are most like the present one on the stage. */
  async #like() {
    const { dock } = this.#parts;
    const client = this.#client;
    dock.setSearching(true);
    try {
      const seconds = this.#time();
      const of = seconds === undefined ? undefined : this.#current;
      const time = this.#api.time();
      const question = of ? { row: of.row, seconds } : { name: "stage.npz", bytes: await this.#api.export("result", "npz"), seconds: time };
      const hits = await client.call("like", { ...question, count: HITS + 1 });
      if (this.#client !== client) return;
      const { a } = this.#api.params();
      const name = of?.name ?? this.#api.clips().find(({ id }) => id === a)?.name ?? "";
      const title = sentence("likeTitle", { name, seconds: (seconds ?? time).toFixed(2) });
      this.#list = { kind: "like", title, hits: hits.filter(({ row }) => row !== of?.row).slice(0, HITS) };
      this.#say("");
      await this.#refresh();
      if (this.#view === "table") this.#parts.table.focus();
    } catch (reason) {
      if (reason?.name !== "AbortError") this.#say(reason);
    } finally {
      dock.setSearching(false);
    }
  }

  async #showCopies() {
    const { row, name } = this.#current;
    const copies = await this.#client.call("copiesOf", { row });
    this.#list = { kind: "copies", title: sentence("copiesOf", { name }), near: [row, ...copies] };
    await this.#refresh();
    this.#parts.table.focus();
  }

  // The page around it.

  #say(reason) {
    if (reason?.name === "AbortError") return;
    if (reason) console.info(reason);
    this.#parts.problem.textContent = String(reason?.message ?? reason);
  }

  #key(event) {
    if (event.key !== "Escape" || event.defaultPrevented) return;
    event.preventDefault();
    event.stopPropagation();
    if (this.#list) this.#leaveList();
    else if (this.#filtersOpen && this.#parts.filters) {
      this.#toggleFilters();
      this.#parts.filtersButton.focus();
    } else this.#close();
  }

  #theme() {
    const { theme } = this.#api.params();
    const isLight = theme === "light" || (theme !== "dark" && window.matchMedia("(prefers-color-scheme: light)").matches);
    const word = isLight ? "light" : "dark";
    if (this.#root.dataset.theme === word) return;
    for (const part of [this.#root, this.#back, this.#targets]) part.dataset.theme = word;
    this.#map?.draw();
    this.#parts.filters?.draw();
  }

  /** On a phone, shows the panel or the stage behind it. */
  #showPanel(isShown) {
    if (!PHONE.matches && !isShown) return;
    this.#root.hidden = !isShown;
    this.#layOut();
    if (!isShown) this.#back.focus({ preventScroll: true });
  }

  /** Gives the canvas the room beside the panel. */
  #layOut() {
    const isOpen = this.#root.isConnected;
    const page = document.documentElement;
    if (!PHONE.matches) this.#root.hidden = false;
    this.#back.hidden = !(isOpen && this.#root.hidden);
    page.classList.toggle("with-corpus", isOpen && !PHONE.matches);
    const outline = document.getElementById("outline");
    if (outline) outline.inert = isOpen && PHONE.matches && !this.#root.hidden;
    if (!isOpen) return;
    const width = Math.round(Math.max(Math.min(this.#width, WIDTHS.most, window.innerWidth - MIN_STAGE), Math.min(WIDTHS.least, window.innerWidth - MIN_STAGE)));
    page.style.setProperty("--corpus-width", `${width}px`);
    this.#parts.resizer?.setAttribute("aria-valuenow", width);
    if (this.#parts.table && this.#facts) this.#parts.table.setColumns(this.#shownColumns(), this.#list?.hits ? {} : this.#filter.sort);
  }

  #resize(width) {
    this.#width = Math.min(Math.max(width, WIDTHS.least), WIDTHS.most);
    this.#layOut();
  }

  #grip(event) {
    if (event.button !== 0) return;
    event.preventDefault();
    const grip = event.currentTarget;
    grip.setPointerCapture(event.pointerId);
    const [start, before] = [event.clientX, this.#root.clientWidth];
    let frame = 0;
    const move = ({ clientX }) => {
      cancelAnimationFrame(frame);
      frame = requestAnimationFrame(() => this.#resize(before + clientX - start));
    };
    const end = () => {
      grip.removeEventListener("pointermove", move);
      writeStored(WIDTH_KEY, String(this.#width));
    };
    grip.addEventListener("pointermove", move);
    grip.addEventListener("lostpointercapture", end, { once: true });
  }

  #resizeByKey(event) {
    const step = { ArrowLeft: -20, ArrowRight: 20, Home: -Infinity, End: Infinity }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    this.#resize(this.#width + step);
    writeStored(WIDTH_KEY, String(this.#width));
  }

  /** Shows where a dragged row can be dropped: over the halves of the stage. */
  #drag(row) {
    this.#dragged = row;
    this.#targets.hidden = row === undefined;
    if (row === undefined) return;
    const target = (slot) => element("div", {
      class: `target ${slot.toLowerCase()}`,
      ondragover: (event) => {
        event.preventDefault();
        event.dataTransfer.dropEffect = "copy";
      },
      ondragenter: (event) => event.currentTarget.classList.add("hot"),
      ondragleave: (event) => event.currentTarget.classList.remove("hot"),
      ondrop: (event) => {
        event.preventDefault();
        const dropped = this.#dragged;
        this.#drag(undefined);
        if (dropped !== undefined) this.#put(dropped, slot);
      },
    }, [element("b", { textContent: slot }), element("span", { textContent: sentence(slot === "A" ? "dropA" : "dropB") })]);
    this.#targets.replaceChildren(target("A"), target("B"));
  }

  #dragOver(event) {
    if ([...event.dataTransfer.types].includes("Files")) event.preventDefault();
  }

  /** Loads files that are dropped on the panel. Folders are the app's, which tells of a corpus. */
  async #drop(event) {
    event.preventDefault();
    for (const file of event.dataTransfer.files) {
      const loaded = file.arrayBuffer().then((bytes) => this.#api.load(file.name, bytes));
      await loaded.catch((reason) => this.#parts.problem && this.#say(reason));
    }
  }
}

const newFilter = () => ({ text: "", ranges: {}, choices: {}, copies: "all", sort: { by: "name", down: false } });

/** Returns the parts of a text, with code where it stands in backticks. */
const withCode = (text) => text.split("`").map((part, at) => (at % 2 ? element("code", { textContent: part }) : part));

function readStored(key) {
  try {
    return localStorage.getItem(key);
  } catch {
    return null; // a page without a storage
  }
}

function writeStored(key, value) {
  try {
    localStorage.setItem(key, value);
  } catch {
    // a page without a storage
  }
}
