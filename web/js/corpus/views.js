// The clips of a corpus in a table, and on a map.

import { shownColumns } from "./columns.js";
import { element, segments } from "./elements.js";
import { ClipMap } from "./map.js";
import { ClipTable } from "./table.js";
import { hintOf } from "./thumbnail.js";
import { sentence } from "./words.js";

export class Views {
  root;
  /** The choice between the two. */
  choice;
  #corpus;
  #hooks;
  #state;
  #table;
  #map;
  #rows = new Uint32Array();
  /** Whether the rows are those that a search has found. */
  #areHits = false;
  #current;
  #hasEnded = false;

  /**
   * @param corpus the `OpenCorpus`
   * @param state what stays in another language: the `view` that is shown, and the `points` of the map
   * @param hooks play(row), put(row, slot), sort(column), drag(row)
   */
  constructor(corpus, state, { play, put, sort, drag }) {
    [this.#corpus, this.#state, this.#hooks] = [corpus, state, { play }];
    this.#table = new ClipTable({
      play, put, sort, drag,
      cells: (rows) => corpus.ask("cells", { rows }),
      thumbnails: (rows, signal, onPart) => corpus.ask("thumbnails", { rows }, { signal, onPart }),
      say: (reason) => corpus.say(reason),
    });
    this.root = element("div", { class: "view" }, [this.#table.root]);
    this.choice = this.#makeChoice();
    this.#show();
  }

  /** Ends what is under way. */
  end() {
    this.#hasEnded = true;
    this.#table.end();
    this.#map?.end();
  }

  /** Shows these rows, with the moments that a search has found in them, if that is what they are. */
  setRows(rows, hits) {
    [this.#rows, this.#areHits] = [rows, hits !== undefined];
    this.#table.setRows(rows, new Map(hits?.map((hit) => [hit.row, hit])));
    this.#map?.setRows(rows);
  }

  /** Marks the row that is on the stage, and on the map those that a search has found. */
  mark(row) {
    this.#current = row;
    this.#table.setCurrent(row);
    this.#map?.setMarks(row, this.#areHits ? [...this.#rows] : []);
  }

  /** Scrolls to a row, and takes it for the active one. */
  reveal(row) {
    this.#table.reveal(row);
  }

  focus() {
    if (this.#state.view === "table") this.#table.focus();
    else this.#map?.focus();
  }

  /** Draws again what has colours of the theme. */
  draw() {
    this.#map?.draw();
  }

  /** Shows as many columns as there is room for. */
  layOut(columns, filter, { isPhone, hasHits }) {
    const shown = shownColumns(columns, filter, { width: this.root.clientWidth, isPhone, hasHits });
    this.#table.setColumns(shown, hasHits ? {} : filter.sort);
  }

  #makeChoice() {
    return segments(sentence("view"), ["table", "map"].map((view) => ({ text: sentence(view), isChosen: this.#state.view === view, choose: () => this.#choose(view) })));
  }

  #choose(view) {
    this.#state.view = view;
    const before = this.choice;
    const hadFocus = before.contains(document.activeElement);
    this.choice = this.#makeChoice();
    before.replaceWith(this.choice);
    if (hadFocus) this.choice.querySelector("[aria-checked='true']").focus({ preventScroll: true });
    this.#show();
  }

  async #show() {
    const state = this.#state;
    try {
      if (state.view === "map") state.points ??= await this.#corpus.ask("map");
    } catch (reason) {
      return this.#corpus.say(reason);
    }
    if (this.#hasEnded) return;
    if (state.view === "map" && !this.#map) {
      this.#map = new ClipMap(state.points, { play: this.#hooks.play, describe: (row) => hintOf(this.#corpus, row) });
      this.root.append(this.#map.root);
      this.#map.setRows(this.#rows);
      this.mark(this.#current);
    }
    this.#table.root.hidden = state.view !== "table";
    if (this.#map) this.#map.root.hidden = state.view !== "map";
    this.#table.update();
  }
}
