// A corpus that is open: its clips, with a search and filters. views.js shows them, and playback.js has
// what is on the stage beside it.

import { button, delayed, element, icon } from "./elements.js";
import { filterOf, filterText, noFilter } from "./filter_link.js";
import { Filters } from "./filters.js";
import { BINS } from "./histogram.js";
import { Playback } from "./playback.js";
import { SetFilters } from "./set_filters.js";
import { Views } from "./views.js";
import { number, sentence } from "./words.js";

export class OpenCorpus {
  /** { address, name } or { files, name } */
  place;
  #client;
  #facts;
  #hooks;
  #playback;
  /** { text, ranges, choices, copies, sort }; changed in place. */
  #filter;
  #rows = new Uint32Array();
  /** A search or copies instead of all clips: { word, values } of its title, and `hits` or `near`. */
  #list;
  /** Of its views: what stays in another language. */
  #viewState = { view: "table" };
  #filtersOpen = false;
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
   * @param hooks api, player, layout, targets, and `filtered`, called when what is shown has changed
   * @param filter what is shown first, as in `filter`
   */
  constructor(place, client, facts, hooks, filter) {
    this.place = place;
    [this.#client, this.#facts, this.#hooks] = [client, facts, hooks];
    this.#filter = filterOf(filter, facts.columns);
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

  /** What is shown, as it stands behind the address of the corpus. */
  get filter() {
    return filterText(this.#filter);
  }

  set filter(text) {
    const filter = filterOf(text, this.#facts.columns);
    if (filterText(filter) === this.filter) return;
    Object.assign(this.#filter, filter);
    this.#parts.filters?.update();
    this.#changed();
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
    this.#parts.views.reveal(this.#playback.row);
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
    this.#parts.views?.end();
    this.#parts.filters?.end();
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
    const views = new Views(this, this.#viewState, {
      play: (row) => this.#play(row),
      put: (row, slot) => this.#playback.put(row, slot),
      sort: (column) => this.#sort(column),
      drag: (row) => this.#hooks.targets.show((slot) => this.#playback.put(row, slot)),
    });
    this.#parts = {
      search, toggle, filters, set, views,
      count: element("p", { class: "count", role: "status" }),
      problem: element("p", { class: "problem", role: "alert" }),
    };
    const { count, problem } = this.#parts;
    return [
      element("div", { class: "tools" }, [element("div", { class: "field" }, [icon("search"), search]), toggle]),
      filters.root, set.root,
      element("div", { class: "status" }, [count]),
      problem, views.root, this.#playback.build(),
    ];
  }

  /** The choice between table and map. */
  get viewChoice() {
    return this.#parts.views.choice;
  }

  /** Shows its clips in elements that were built again. */
  async rebuilt() {
    this.#showRows();
    this.#playback.show();
    this.#parts.views.reveal(this.#playback.row);
    await this.#count().catch((reason) => this.say(reason));
  }

  /** Shows what went wrong, or nothing any more. */
  say(reason) {
    if (reason?.name === "AbortError" || this.hasEnded) return;
    if (reason) console.info(reason);
    this.#parts.problem.textContent = String(reason?.message ?? reason);
  }

  /** Shows as many columns as there is room for: those first that are looked at. */
  layOut() {
    const place = { isPhone: this.#hooks.layout.isPhone, hasHits: this.#list?.hits !== undefined };
    this.#parts.views?.layOut(this.#facts.columns, this.#filter, place);
  }

  /** Draws again what has colours of the theme. */
  draw() {
    this.#parts.views.draw();
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
    const { search, views } = this.#parts;
    if (event.key === "Escape" && search.value) {
      event.stopPropagation();
      search.value = "";
      this.#searchFor("");
    } else if (event.key === "ArrowDown" || event.key === "Enter") views.focus();
    else return;
    event.preventDefault();
  }

  /** Shows all clips that fit the filter, after it has changed. */
  #changed() {
    this.#list = undefined;
    this.#refreshSoon();
    this.#hooks.filtered();
  }

  /** Reads the rows, and shows them. */
  async refresh() {
    const asked = ++this.#refreshes;
    this.#refreshSoon.cancel();
    this.#counting.abort();
    const { hits, near } = this.#list ?? {};
    try {
      // The order of hits is that of the search.
      const filter = near ? { ...noFilter(), sort: this.#filter.sort, near } : this.#filter;
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
    const { views, count, set, toggle, search } = this.#parts;
    const [list, all] = [this.#list, this.#facts.rows];
    this.layOut();
    views.setRows(this.#rows, list?.hits);
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
    this.#parts.views.mark(row);
  }

  #sort(by) {
    const { sort } = this.#filter;
    // Of numbers, the greatest are looked for first.
    const down = sort.by === by ? !sort.down : by !== "name";
    this.#filter.sort = { by, down };
    if (this.#list?.hits) this.#list = undefined;
    this.refresh();
    this.#hooks.filtered();
  }

  #toggleFilters() {
    this.#filtersOpen = !this.#filtersOpen;
    const { filters, toggle, views } = this.#parts;
    filters.root.hidden = !this.#filtersOpen;
    views.root.parentElement.classList.toggle("filtering", this.#filtersOpen);
    toggle.setAttribute("aria-expanded", String(this.#filtersOpen));
    if (this.#list && this.#filtersOpen) {
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
    this.#parts.views.focus();
  }

  #leaveList() {
    this.#list = undefined;
    this.refresh();
    this.#parts.views.focus();
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
