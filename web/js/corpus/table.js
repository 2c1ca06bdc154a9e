// The table of clips: a grid that has elements only for the rows in sight.

import { button, delayed, element, icon } from "./elements.js";
import { columnName, number, sentence, translated } from "./words.js";

/** The rows beyond either edge that have elements. */
const BEYOND = 4;
/** The greatest height of the list, pixels: browsers limit it. Of a longer one, a pixel is more than that. */
const MAX_HEIGHT = 8_000_000;
/** The time without scrolling after which thumbnails are read, milliseconds. */
const REST_MS = 80;
const MAX_CELLS = 4000;
const MAX_THUMBNAILS = 800;
/** The longest name that is not cut in the middle, and the number of letters behind the cut: takes differ at the end. */
const MAX_WHOLE_NAME = 14;
const NAME_END = 7;

export class ClipTable {
  root;
  #hooks;
  #scroller;
  #head;
  #body;
  #rows = new Uint32Array();
  #hits = new Map();
  #columns = [];
  #sort = {};
  #active = 0;
  #current;
  #elements = new Map();
  #cells = new Map();
  #asked = new Set();
  #thumbnails = new Map();
  /** Requests of thumbnails under way: their rows, and how to stop them. */
  #batches = new Set();
  #frame = 0;
  #isDue = false;
  #rested = delayed(() => this.#readThumbnails(), REST_MS);
  #resized = new ResizeObserver(() => this.#later());
  #hasEnded = false;

  /**
   * @param hooks play(row), put(row, slot), sort(column), cells(rows), thumbnails(rows, signal, onPart), drag(row),
   *   say(reason)
   */
  constructor(hooks) {
    this.#hooks = hooks;
    this.#head = element("div", { class: "head", role: "row" });
    this.#body = element("div", { class: "body", role: "rowgroup" });
    this.#scroller = element("div", {
      class: "grid", role: "grid", tabIndex: 0, "aria-label": sentence("clips"), "aria-keyshortcuts": "Enter A B", onkeydown: (event) => this.#key(event), onscroll: () => this.#later(),
    }, [this.#head, this.#body]);
    this.root = this.#scroller;
    this.#resized.observe(this.#scroller);
  }

  /** Shows these rows, with the moments that a search has found in them. */
  setRows(rows, hits = new Map()) {
    const before = this.#rows[this.#active];
    const areSame = rows.length === this.#rows.length && hits.size === 0 && this.#hits.size === 0 && rows.every((row, at) => row === this.#rows[at]);
    this.#scroller.setAttribute("aria-rowcount", rows.length + 1);
    if (areSame) return;
    [this.#rows, this.#hits] = [rows, hits];
    this.#active = Math.max(rows.indexOf(before), 0);
    this.#scroller.scrollTop = 0;
    this.#clear();
    this.#soon();
  }

  /** Shows these columns of numbers beside the names. `sort` is { by, down }. */
  setColumns(columns, sort) {
    if (this.#columns.map(({ name }) => name).join() !== columns.map(({ name }) => name).join()) this.#clear();
    [this.#columns, this.#sort] = [columns, sort];
    this.#scroller.style.setProperty("--numbers", columns.length);
    this.#scroller.setAttribute("aria-colcount", columns.length + 3);
    const header = (column, sortable = true) => {
      const { name, unit } = column;
      const isSorted = sort.by === name;
      const text = [element("span", { textContent: columnName(column) }), unit ? element("small", { textContent: translated(unit) }) : null, isSorted ? icon(sort.down ? "down" : "up") : null];
      return element("div", {
        role: "columnheader", class: name === "name" ? "name" : "number", title: column.help ? translated(column.help) : undefined,
        "aria-sort": sortable ? (isSorted ? (sort.down ? "descending" : "ascending") : "none") : undefined,
      }, sortable ? [element("button", { type: "button", onclick: () => this.#hooks.sort(name) }, text)] : text);
    };
    const focused = [...this.#head.children].findIndex((cell) => cell.contains(document.activeElement));
    this.#head.replaceChildren(
      element("div", { role: "columnheader", class: "strip" }, [element("span", { textContent: sentence("thumbnail") })]),
      header({ name: "name", label: "" }),
      ...columns.map((column) => header(column, column.name !== "distance")),
      element("div", { role: "columnheader", class: "acts" }, [element("span", { class: "unseen", textContent: sentence("putInto") })]),
    );
    if (focused >= 0) this.#head.children[focused]?.querySelector("button")?.focus({ preventScroll: true });
    this.#soon();
  }

  /** Marks the row that is on the stage. */
  setCurrent(row) {
    this.#current = row;
    for (const [index, shown] of this.#elements) this.#mark(shown, index);
  }

  /** Scrolls to a row, and takes it for the active one. */
  reveal(row) {
    const index = this.#rows.indexOf(row);
    if (index >= 0) this.#activate(index, "center");
  }

  focus() {
    this.#scroller.focus({ preventScroll: true });
  }

  /** Shows the rows in sight, after the table was hidden. */
  update() {
    this.#later();
  }

  /** Ends what is under way, and releases what is kept. */
  end() {
    this.#hasEnded = true;
    this.#rested.cancel();
    this.#resized.disconnect();
    for (const { controller } of this.#batches) controller.abort();
    for (const url of this.#thumbnails.values()) if (url) URL.revokeObjectURL(url);
    this.#thumbnails.clear();
    cancelAnimationFrame(this.#frame);
  }

  #clear() {
    for (const { root } of this.#elements.values()) root.remove();
    this.#elements.clear();
    this.#scroller.removeAttribute("aria-activedescendant");
  }

  /** Shows the rows in sight with the next frame, once for all that is scrolled until then. */
  #later() {
    if (this.#hasEnded) return;
    cancelAnimationFrame(this.#frame);
    this.#frame = requestAnimationFrame(() => this.#show());
  }

  /**
   * Shows the rows in sight at the end of this task. To wait for a frame before their texts are requested, and for
   * another before these are shown, would cost two frames, which are long beside a stage that draws slowly.
   */
  #soon() {
    if (this.#isDue) return;
    this.#isDue = true;
    queueMicrotask(() => {
      this.#isDue = false;
      if (this.#hasEnded) return;
      cancelAnimationFrame(this.#frame);
      this.#show();
    });
  }

  get #rowHeight() {
    return parseFloat(getComputedStyle(this.#scroller).getPropertyValue("--row")) || 56;
  }

  /** Returns the height of the list, and that of all rows. */
  #heights() {
    const all = this.#rows.length * this.#rowHeight;
    return { all, height: Math.min(all, MAX_HEIGHT), view: Math.max(this.#scroller.clientHeight - this.#head.offsetHeight, 1) };
  }

  /** Returns how far all rows are scrolled, pixels. */
  #top({ all, height, view }) {
    const { scrollTop } = this.#scroller;
    return height < all ? scrollTop * ((all - view) / (height - view)) : scrollTop;
  }

  #show() {
    // A table that is hidden would go to its top.
    if (!this.#scroller.clientHeight) return;
    const heights = this.#heights();
    const [row, top] = [this.#rowHeight, this.#top(heights)];
    this.#body.style.height = `${heights.height}px`;
    const first = Math.max(Math.floor(top / row) - BEYOND, 0);
    const last = Math.min(Math.ceil((top + heights.view) / row) + BEYOND, this.#rows.length);
    for (const [index, { root }] of this.#elements) {
      if (index >= first && index < last) continue;
      root.remove();
      this.#elements.delete(index);
    }
    const unknown = [];
    for (let index = first; index < last; index++) {
      let shown = this.#elements.get(index);
      if (!shown) {
        shown = this.#make(index);
        this.#elements.set(index, shown);
        const next = [...this.#elements.keys()].filter((other) => other > index).sort((one, other) => one - other)[0];
        this.#body.insertBefore(shown.root, this.#elements.get(next)?.root ?? null);
      }
      shown.root.style.transform = `translateY(${Math.round(index * row - top + this.#scroller.scrollTop)}px)`;
      if (!this.#cells.has(this.#rows[index])) unknown.push(this.#rows[index]);
      else if (!shown.isFilled) this.#fill(shown, index);
    }
    this.#name();
    this.#readCells(unknown);
    this.#rested();
  }

  /** Tells screen readers which row is active. */
  #name() {
    const shown = this.#elements.get(this.#active);
    if (shown) this.#scroller.setAttribute("aria-activedescendant", shown.root.id);
    else this.#scroller.removeAttribute("aria-activedescendant");
  }

  async #readCells(rows) {
    const wanted = rows.filter((row) => !this.#asked.has(row));
    if (!wanted.length) return;
    for (const row of wanted) this.#asked.add(row);
    try {
      for (const cell of await this.#hooks.cells(wanted)) this.#cells.set(cell.row, cell);
    } catch (reason) {
      return this.#hooks.say(reason);
    } finally {
      for (const row of wanted) this.#asked.delete(row);
    }
    for (const oldest of this.#cells.keys()) {
      if (this.#cells.size <= MAX_CELLS) break;
      this.#cells.delete(oldest);
    }
    this.#soon();
  }

  async #readThumbnails() {
    const inSight = new Set([...this.#elements.keys()].map((index) => this.#rows[index]));
    for (const batch of this.#batches) {
      if (batch.rows.some((row) => inSight.has(row))) continue;
      batch.controller.abort();
      this.#batches.delete(batch);
    }
    const underWay = new Set([...this.#batches].flatMap(({ rows }) => rows));
    const rows = [...inSight].filter((row) => !this.#thumbnails.has(row) && !underWay.has(row));
    if (!rows.length) return;
    const batch = { rows, controller: new AbortController() };
    this.#batches.add(batch);
    try {
      await this.#hooks.thumbnails(rows, batch.controller.signal, ([row, png]) => this.#keep(row, png));
    } catch (reason) {
      // The table is of use without its pictures.
      if (reason?.name !== "AbortError") console.info(reason);
    } finally {
      this.#batches.delete(batch);
    }
  }

  #keep(row, png) {
    if (this.#hasEnded) return;
    this.#thumbnails.set(row, png && URL.createObjectURL(new Blob([png], { type: "image/png" })));
    for (const [oldest, url] of this.#thumbnails) {
      if (this.#thumbnails.size <= MAX_THUMBNAILS) break;
      if (url) URL.revokeObjectURL(url);
      this.#thumbnails.delete(oldest);
    }
    for (const [index, shown] of this.#elements) if (this.#rows[index] === row) this.#picture(shown, row);
  }

  #picture({ image }, row) {
    const url = this.#thumbnails.get(row);
    if (url && image.getAttribute("src") !== url) image.src = url;
    image.hidden = !url;
  }

  #make(index) {
    const row = this.#rows[index];
    const image = element("img", { alt: "", width: 264, height: 48, decoding: "async", draggable: false, hidden: true });
    const [start, end, more] = [element("span"), element("span"), element("small")];
    const header = element("div", { role: "rowheader", class: "name" }, [element("b", {}, [start, end]), more]);
    const numbers = this.#columns.map(() => element("div", { role: "gridcell", class: "number" }));
    const letter = (slot) => button({
      text: slot, class: `slot ${slot.toLowerCase()}`, tabIndex: -1, onclick: (event) => {
        event.stopPropagation();
        this.#hooks.put(row, slot);
      },
    });
    const slots = ["A", "B"].map(letter);
    const root = element("div", {
      class: "row", role: "row", id: `corpus-row-${index}`, draggable: true, "aria-rowindex": index + 2,
      onclick: () => {
        this.#activate(index);
        this.#hooks.play(row);
      },
      ondragstart: (event) => {
        event.dataTransfer.setData("text/plain", this.#cells.get(row)?.name ?? "");
        event.dataTransfer.effectAllowed = "copy";
        this.#hooks.drag(row);
      },
    }, [
      element("div", { role: "gridcell", class: "strip" }, [image]),
      header,
      ...numbers,
      element("div", { role: "gridcell", class: "acts" }, slots),
    ]);
    const shown = { root, image, header, start, end, more, numbers, slots, isFilled: false };
    this.#mark(shown, index);
    this.#picture(shown, row);
    return shown;
  }

  #fill(shown, index) {
    const row = this.#rows[index];
    const [cell, hit] = [this.#cells.get(row), this.#hits.get(row)];
    const { name, path, labels = [], format, status, message, copyOf, isMirrored, values = {} } = cell;
    shown.isFilled = true;
    const [start, end] = inTwo(name);
    shown.start.textContent = start;
    shown.end.textContent = end;
    shown.root.title = path ?? "";
    const isWrong = status !== "ok";
    const folder = path?.split("/").slice(0, -1).join("/");
    const copy = copyOf !== undefined && copyOf !== null ? sentence(isMirrored ? "mirrored" : "copy") : "";
    const facts = isWrong
      ? [message || sentence(status)]
      : [hit && sentence("at", { seconds: hit.seconds.toFixed(2) }), copy, format?.toUpperCase(), labels.join(", ") || folder];
    shown.more.textContent = facts.filter(Boolean).join(" · ");
    // The parts of the name would be read as two words.
    shown.header.setAttribute("aria-label", [name, shown.more.textContent].filter(Boolean).join(", "));
    shown.root.classList.toggle("wrong", isWrong);
    this.#columns.forEach((column, at) => {
      const value = column.name === "distance" ? hit?.distance : (cell[column.name] ?? values[column.name]);
      shown.numbers[at].textContent = typeof value === "number" ? written(value, column) : "–";
    });
    shown.slots.forEach((slot, at) => {
      slot.setAttribute("aria-label", sentence(at ? "putB" : "putA", { name }));
      slot.disabled = isWrong;
    });
  }

  #mark({ root }, index) {
    root.setAttribute("aria-selected", String(index === this.#active));
    root.classList.toggle("active", index === this.#active);
    const isCurrent = this.#rows[index] === this.#current;
    root.classList.toggle("current", isCurrent);
    if (isCurrent) root.setAttribute("aria-current", "true");
    else root.removeAttribute("aria-current");
  }

  #activate(index, place = "nearest") {
    this.#active = Math.min(Math.max(index, 0), Math.max(this.#rows.length - 1, 0));
    const heights = this.#heights();
    const [row, top] = [this.#rowHeight, this.#top(heights)];
    const at = this.#active * row;
    let wanted = top;
    if (place === "center") wanted = at - (heights.view - row) / 2;
    else if (at < top) wanted = at;
    else if (at + row > top + heights.view) wanted = at + row - heights.view;
    wanted = Math.min(Math.max(wanted, 0), Math.max(heights.all - heights.view, 0));
    if (wanted !== top) {
      this.#body.style.height = `${heights.height}px`;
      this.#scroller.scrollTop = heights.height < heights.all ? wanted * ((heights.height - heights.view) / (heights.all - heights.view)) : wanted;
    }
    for (const [shown, each] of this.#elements) this.#mark(each, shown);
    this.#later();
  }

  #key(event) {
    if (event.target !== this.#scroller || event.ctrlKey || event.metaKey || event.altKey) return;
    const page = Math.max(Math.floor(this.#heights().view / this.#rowHeight) - 1, 1);
    const steps = { ArrowDown: 1, ArrowUp: -1, PageDown: page, PageUp: -page, Home: -this.#rows.length, End: this.#rows.length };
    const row = this.#rows[this.#active];
    if (event.key in steps) this.#activate(this.#active + steps[event.key]);
    else if (row === undefined) return;
    else if (event.key === "Enter" || event.key === " ") this.#hooks.play(row);
    else if (/^[ab]$/i.test(event.key)) this.#hooks.put(row, event.key.toUpperCase());
    else return;
    event.preventDefault();
  }
}

/** Writes a value with as many decimals as its column needs. */
export function written(value, { max, name }) {
  if (name === "frames") return number(Math.round(value));
  const most = Math.abs(max ?? 1);
  const decimals = name === "seconds" || name === "distance" ? 2 : most >= 100 ? 0 : most >= 10 ? 1 : 2;
  return value.toFixed(decimals).replace(/^-(0(\.0*)?)$/, "$1");
}

/** Returns the beginning of a name, which may be cut, and its end, which is not. */
function inTwo(name) {
  const letters = [...name];
  const at = letters.length > MAX_WHOLE_NAME ? letters.length - NAME_END : letters.length;
  return [letters.slice(0, at).join(""), letters.slice(at).join("")];
}
