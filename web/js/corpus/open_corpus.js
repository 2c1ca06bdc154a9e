// A corpus that is open: its clips in a table and on a map, with a search and filters. What is on the
// stage beside it has playback.js.

import { shownColumns } from "./columns.js";
import { button, delayed, element, icon, segments } from "./elements.js";
import { Filters } from "./filters.js";
import { BINS } from "./histogram.js";
import { ClipMap } from "./map.js";
import { Playback } from "./playback.js";
import { SetFilters } from "./set_filters.js";
import { ClipTable } from "./table.js";
import { hintOf } from "./thumbnail.js";
import { number, sentence } from "./words.js";

export class OpenCorpus {
  /** { address, name } or { files, name } */
  place;
  #client;
  #facts;
  #hooks;
  #playback;
  #filter = { text: "", ranges: {}, choices: {}, copies: "all", sort: { by: "name", down: false } };
  #rows = new Uint32Array();
  /** A search or copies instead of all clips: { word, values } of its title, and `hits` or `near`. */
  #list;
  #view = "table";
  #filtersOpen = false;
  #map;
  #points;
  /** The elements, in the language of the page. */
  #parts = {};
  #refreshes = 0;
  /** Cancels the counts of histograms. */
  #counting = new AbortController();
  #ended = new AbortController();
  #refreshSoon = delayed(() => this.refresh(), 60);

  /**
   * @param client of its worker
   * @param facts what it says of itself
   * @param hooks api, player, layout and targets
   */
  constructor(place, client, facts, hooks) {
    this.place = place;
    [this.#client, this.#facts, this.#hooks] = [client, facts, hooks];
    client.isShown = true;
    this.#playback = new Playback(this, hooks);
  }

  /** The seconds of all its clips. */
  get seconds() {
    return this.#facts.counts.seconds;
  }

  get isFiltering() {
    return this.#filtersOpen;
  }

  /** Whether its worker has ended, which is so after an error. */
  get hasFailed() {
    return this.#client.hasEnded;
  }

  get hasEnded() {
    return this.#ended.signal.aborted;
  }

  /** Aborted when the corpus is closed. */
  get signal() {
    return this.#ended.signal;
  }

  /** Calls its worker. After it was closed, an `AbortError` comes instead of the answer. */
  async ask(name, args, { signal = this.#ended.signal, onPart } = {}) {
    const answer = await this.#client.call(name, args, { signal, onPart });
    this.#ended.signal.throwIfAborted();
    return answer;
  }

  /** Fills its elements, which are in the page by now. */
  async start() {
    await this.refresh();
    this.ask("prepare").catch((reason) => console.info(reason));
    await this.follow();
    this.#parts.table.reveal(this.#playback.row);
  }

  /** Closes it. */
  end() {
    this.#ended.abort();
    this.#counting.abort();
    this.#refreshSoon.cancel();
    this.#endParts();
    this.#playback.end();
    this.#client.isShown = false;
    // Those of addresses stay open for a while.
    if (this.place.files) this.#client.end();
  }

  #endParts() {
    this.#parts.table?.end();
    this.#parts.filters?.end();
    this.#map?.end();
    this.#map = undefined;
    this.#hooks.targets.hide();
  }

  // The elements.

  /** Makes its elements, in the language of the page. */
  build() {
    this.#endParts();
    const { columns } = this.#facts;
    const changed = () => this.#changed();
    const search = element("input", {
      type: "search", value: this.#filter.text, placeholder: sentence("search"), "aria-label": sentence("search"), spellcheck: false, autocomplete: "off", enterKeyHint: "search",
      oninput: () => this.#searchFor(search.value), onkeydown: (event) => this.#searchKey(event),
    });
    const toggle = button({ icon: "filter", text: sentence("filters"), "aria-expanded": String(this.#filtersOpen), onclick: () => this.#toggleFilters() });
    const filters = new Filters(columns, this.#filter, changed);
    filters.root.hidden = !this.#filtersOpen;
    const set = new SetFilters(columns, this.#filter, () => {
      filters.update();
      changed();
    });
    const table = new ClipTable({
      play: (row) => this.#play(row),
      put: (row, slot) => this.#playback.put(row, slot),
      sort: (column) => this.#sort(column),
      cells: (rows) => this.ask("cells", { rows }),
      thumbnails: (rows, signal, onPart) => this.ask("thumbnails", { rows }, { signal, onPart }),
      drag: (row) => this.#hooks.targets.show((slot) => this.#playback.put(row, slot)),
      say: (reason) => this.say(reason),
    });
    this.#parts = {
      search, toggle, filters, set, table,
      count: element("p", { class: "count", role: "status" }),
      problem: element("p", { class: "problem", role: "alert" }),
      body: element("div", { class: "view" }, [table.root]),
    };
    const { count, problem, body } = this.#parts;
    return [
      element("div", { class: "tools" }, [element("div", { class: "field" }, [icon("search"), search]), toggle]),
      filters.root, set.root,
      element("div", { class: "status" }, [count]),
      problem, body, this.#playback.build(),
    ];
  }

  /** Makes the choice between table and map. */
  buildViews() {
    const choices = ["table", "map"].map((view) => ({ text: sentence(view), isChosen: this.#view === view, choose: () => this.#choose(view) }));
    this.#parts.views = segments(sentence("view"), choices);
    return this.#parts.views;
  }

  /** Shows its clips in elements that were built again. */
  async rebuilt() {
    this.#showRows();
    await Promise.all([this.#showView(), this.#count()]).catch((reason) => this.say(reason));
    this.#playback.show();
    this.#parts.table.reveal(this.#playback.row);
  }

  /** Shows what went wrong, or nothing any more. */
  say(reason) {
    if (reason?.name === "AbortError" || this.hasEnded) return;
    if (reason) console.info(reason);
    this.#parts.problem.textContent = String(reason?.message ?? reason);
  }

  /** Shows as many columns as there is room for: those first that are looked at. */
  layOut() {
    const { table, body } = this.#parts;
    if (!table) return;
    const hasHits = this.#list?.hits !== undefined;
    const place = { width: body.clientWidth, isPhone: this.#hooks.layout.isPhone, hasHits };
    table.setColumns(shownColumns(this.#facts.columns, this.#filter, place), hasHits ? {} : this.#filter.sort);
  }

  /** Draws again what has colours of the theme. */
  draw() {
    this.#map?.draw();
    this.#parts.filters.draw();
  }

  /** Goes back by a step: to all clips, or to closed filters. Returns false when the next one would be to close it. */
  goBack() {
    if (this.#list) this.#leaveList();
    else if (this.#filtersOpen) {
      this.#toggleFilters();
      this.#parts.toggle.focus();
    } else if (document.activeElement !== this.#parts.search) return false; // Escape there clears the search
    return true;
  }

  // The rows.

  #searchFor(text) {
    this.#filter.text = text;
    this.#changed();
  }

  #searchKey(event) {
    const { search, table } = this.#parts;
    if (event.key === "Escape" && search.value) {
      event.stopPropagation();
      search.value = "";
      this.#searchFor("");
    } else if (event.key === "ArrowDown" || event.key === "Enter") table.focus();
    else return;
    event.preventDefault();
  }

  /** Shows all clips that fit the filter, after it has changed. */
  #changed() {
    this.#list = undefined;
    this.#refreshSoon();
  }

  /** Reads the rows, and shows them. */
  async refresh() {
    const asked = ++this.#refreshes;
    this.#refreshSoon.cancel();
    this.#counting.abort();
    const { hits, near } = this.#list ?? {};
    try {
      // The order of hits is that of the search.
      const filter = near ? { ...this.#filter, text: "", ranges: {}, choices: {}, copies: "all", near } : this.#filter;
      const rows = hits ? Uint32Array.from(hits, ({ row }) => row) : await this.ask("select", { filter });
      if (asked !== this.#refreshes) return;
      this.#rows = rows;
      this.#showRows();
      await this.#count();
    } catch (reason) {
      this.say(reason);
    }
  }

  /** Counts the clips for the histograms. */
  async #count() {
    this.#counting.abort();
    if (!this.#filtersOpen) return;
    this.#counting = new AbortController();
    const [{ signal }, { filters }] = [this.#counting, this.#parts];
    const counts = await this.ask("histograms", { columns: filters.counted, filter: this.#filter, bins: BINS }, { signal });
    signal.throwIfAborted();
    filters.setCounts(counts);
  }

  #showRows() {
    const { table, count, set, toggle, search } = this.#parts;
    const [list, all] = [this.#list, this.#facts.rows];
    this.layOut();
    table.setRows(this.#rows, new Map(list?.hits?.map((hit) => [hit.row, hit])));
    this.#map?.setRows(this.#rows);
    this.mark(this.#playback.row);
    const texts = { count: number(this.#rows.length), all: number(all) };
    const counted = this.#rows.length === 0 ? sentence("noClips") : this.#rows.length === all ? sentence("allClips", { count: texts.all }) : sentence("someClips", texts);
    count.replaceChildren(...(list
      ? [button({ icon: "left", text: sentence("back"), class: "quiet back", onclick: () => this.#leaveList() }), element("b", { textContent: sentence(list.word, list.values) })]
      : [element("span", { textContent: counted })]));
    toggle.classList.toggle("set", set.show(!list, toggle));
    if (search.value !== this.#filter.text) search.value = this.#filter.text;
  }

  /** Marks the row that is on the stage. */
  mark(row) {
    this.#parts.table.setCurrent(row);
    this.#map?.setMarks(row, this.#list?.hits ? [...this.#rows] : []);
  }

  #sort(by) {
    const { sort } = this.#filter;
    // Of numbers, the greatest are looked for first.
    const down = sort.by === by ? !sort.down : by !== "name";
    this.#filter.sort = { by, down };
    if (this.#list?.hits) this.#list = undefined;
    this.refresh();
  }

  #toggleFilters() {
    this.#filtersOpen = !this.#filtersOpen;
    const { filters, toggle, body } = this.#parts;
    filters.root.hidden = !this.#filtersOpen;
    body.parentElement.classList.toggle("filtering", this.#filtersOpen);
    toggle.setAttribute("aria-expanded", String(this.#filtersOpen));
    if (this.#list) {
      this.#list = undefined;
      this.refresh();
    } else {
      this.#count().catch((reason) => this.say(reason));
    }
  }

  /** Shows the moments that a search has found. */
  async showHits(values, hits) {
    await this.#showList({ word: "likeTitle", values, hits });
  }

  /** Shows a clip and its copies. */
  async showCopies({ row, name }) {
    const copies = await this.ask("copiesOf", { row });
    await this.#showList({ word: "copiesOf", values: { name }, near: [row, ...copies] });
  }

  async #showList(list) {
    this.#list = list;
    await this.refresh();
    if (this.#view === "table") this.#parts.table.focus();
  }

  #leaveList() {
    this.#list = undefined;
    this.refresh();
    this.#parts.table.focus();
  }

  // The views.

  async #choose(view) {
    this.#view = view;
    const { views } = this.#parts;
    const hadFocus = views.contains(document.activeElement);
    views.replaceWith(this.buildViews());
    if (hadFocus) this.#parts.views.querySelector("[aria-checked='true']").focus({ preventScroll: true });
    await this.#showView().catch((reason) => this.say(reason));
  }

  async #showView() {
    const { table, body } = this.#parts;
    if (this.#view === "map") {
      this.#points ??= await this.ask("map");
      if (body !== this.#parts.body) return;
      if (!this.#map) {
        this.#map = new ClipMap(this.#points, { play: (row) => this.#play(row), describe: (row) => hintOf(this, row) });
        body.append(this.#map.root);
      }
      this.#map.setRows(this.#rows);
      this.mark(this.#playback.row);
    }
    table.root.hidden = this.#view !== "table";
    if (this.#map) this.#map.root.hidden = this.#view !== "map";
    this.layOut();
  }

  // The stage.

  /** Plays a clip alone, from the moment that a search has found in it. */
  #play(row) {
    return this.#playback.play(row, this.#list?.hits?.find((hit) => hit.row === row)?.seconds);
  }

  /** Follows a change of the app: the clip on its stage. */
  async follow() {
    await this.#playback.follow().catch((reason) => this.say(reason));
  }
}
