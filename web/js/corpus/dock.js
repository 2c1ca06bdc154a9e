// The foot of the panel: what is on the stage, a band of its poses with the playhead and a range,
// and searches from its present moment.

import { button, contextOf, delayed, element } from "./elements.js";
import { seconds as secondsText } from "./address.js";
import { number, sentence } from "./words.js";

const FIGURES = 6;
/** Width and height of a figure in a thumbnail, pixels. */
const CELL = [44, 48];
/** The shortest range, seconds. */
const MIN_RANGE = 0.2;
/** How near the pointer takes an end of the range, pixels. */
const NEAR = 12;

export class Dock {
  root;
  #hooks;
  #title;
  #facts;
  #like;
  #copies;
  #slots;
  #whole;
  #band;
  #canvas;
  #head;
  #outside;
  #handles;
  #picture;
  /** The clip on the stage: { name, seconds, range, copies }; `seconds` only where it is of the corpus. */
  #clip = {};
  #dragged;
  /** A range is cut out once the keys rest. */
  #chooseLater = delayed((range) => this.#choose(range), 400);

  /**
   * @param hooks like(), copies(), put(slot), range([from, to] or undefined), seek(seconds), time(): seconds, or undefined while
   *   the clip does not play alone
   */
  constructor(hooks) {
    this.#hooks = hooks;
    [this.#title, this.#facts] = [element("b"), element("small")];
    this.#like = button({ icon: "like", text: sentence("likeThis"), title: sentence("likeHelp"), class: "main", onclick: () => hooks.like() });
    this.#copies = button({ icon: "copies", text: " ", class: "quiet", onclick: () => hooks.copies() });
    this.#slots = ["A", "B"].map((slot) => button({ text: slot, class: `slot ${slot.toLowerCase()}`, onclick: () => hooks.put(slot) }));
    this.#whole = button({ text: sentence("whole"), class: "quiet", onclick: () => hooks.range(undefined) });
    this.#canvas = element("canvas");
    [this.#head, this.#outside] = [element("i", { class: "playhead" }), [element("i", { class: "outside" }), element("i", { class: "outside" })]];
    this.#handles = ["rangeFrom", "rangeTo"].map((word, end) => element("div", {
      class: `handle ${end ? "to" : "from"}`, role: "slider", tabIndex: 0, "aria-label": sentence(word), "aria-orientation": "horizontal", onkeydown: (event) => this.#key(event, end),
    }));
    this.#band = element("div", {
      class: "band", role: "group", "aria-label": sentence("range"),
      onpointerdown: (event) => this.#press(event), onpointermove: (event) => this.#move(event), onpointerup: () => this.#release(), onpointercancel: () => { this.#dragged = undefined; },
    }, [this.#canvas, ...this.#outside, this.#head, ...this.#handles]);
    this.root = element("div", { class: "dock", role: "group", "aria-label": sentence("playing") }, [
      element("div", { class: "title" }, [element("div", {}, [this.#title, this.#facts]), this.#whole, ...this.#slots]),
      this.#band,
      element("div", { class: "actions" }, [this.#like, this.#copies]),
    ]);
    new ResizeObserver(() => this.#draw()).observe(this.#canvas);
    this.show({});
  }

  /** Shows what is on the stage. `picture` is the bitmap of a clip's thumbnail. */
  show(clip, picture) {
    [this.#clip, this.#picture] = [clip, picture];
    const isOfCorpus = clip.seconds !== undefined;
    this.#title.textContent = clip.name ?? sentence("nothing");
    const { range } = clip;
    this.#facts.textContent = isOfCorpus ? (range ? `${secondsText(range[0])} – ${secondsText(range[1])} s / ${clip.seconds.toFixed(2)} s` : `${clip.seconds.toFixed(2)} s`) : clip.name ? sentence("playing") : "";
    this.#band.hidden = !isOfCorpus;
    this.#whole.hidden = !range;
    for (const [at, slot] of this.#slots.entries()) {
      slot.hidden = !isOfCorpus;
      slot.setAttribute("aria-label", sentence(at ? "putB" : "putA", { name: clip.name }));
    }
    this.#like.hidden = !clip.name;
    this.#copies.hidden = !clip.copies;
    if (clip.copies) this.#copies.lastChild.textContent = sentence("nearCopies", { count: clip.copies });
    this.#place(range ?? [0, clip.seconds ?? 1]);
    this.#draw();
    this.tick();
  }

  /** Shows that a search is under way, or that it has ended. */
  setSearching(isSearching) {
    this.#like.disabled = isSearching;
    this.#like.lastChild.textContent = sentence(isSearching ? "searching" : "likeThis");
  }

  /** Moves the playhead to the present time. */
  tick() {
    const time = this.#clip.seconds === undefined ? undefined : this.#hooks.time();
    this.#head.hidden = time === undefined;
    if (time !== undefined) this.#head.style.left = `${(100 * Math.min(Math.max(time / this.#clip.seconds, 0), 1)).toFixed(2)}%`;
  }

  #place([from, to]) {
    const all = this.#clip.seconds ?? 1;
    const shares = [from / all, to / all].map((share) => 100 * Math.min(Math.max(share, 0), 1));
    this.#handles.forEach((handle, end) => {
      handle.style.left = `${shares[end]}%`;
      for (const [key, value] of [["valuemin", 0], ["valuemax", all], ["valuenow", [from, to][end]], ["valuetext", `${secondsText([from, to][end])} s`]]) handle.setAttribute(`aria-${key}`, value);
    });
    this.#outside[0].style.width = `${shares[0]}%`;
    this.#outside[1].style.width = `${100 - shares[1]}%`;
  }

  #draw() {
    const canvas = this.#canvas;
    if (!canvas.isConnected || !canvas.clientWidth || this.#band.hidden) return;
    const context = contextOf(canvas);
    if (!this.#picture) return;
    const { clientWidth: width, clientHeight: height } = canvas;
    context.imageSmoothingQuality = "high";
    for (let figure = 0; figure < FIGURES; figure++) {
      const middle = ((2 * figure + 1) / (2 * FIGURES)) * width;
      const own = (CELL[0] * height) / CELL[1];
      context.drawImage(this.#picture, figure * CELL[0], 0, ...CELL, middle - own / 2, 0, own, height);
    }
  }

  #range() {
    return this.#clip.range ?? [0, this.#clip.seconds];
  }

  #seconds(event) {
    const { left, width } = this.#canvas.getBoundingClientRect();
    return { at: Math.min(Math.max((event.clientX - left) / width, 0), 1) * this.#clip.seconds, width };
  }

  #press(event) {
    if (event.button !== 0) return;
    const { at, width } = this.#seconds(event);
    const distances = this.#range().map((end) => (Math.abs(end - at) / this.#clip.seconds) * width);
    const near = distances[0] <= distances[1] ? 0 : 1;
    this.#dragged = distances[near] <= NEAR ? { end: near, range: [...this.#range()] } : {};
    event.currentTarget.setPointerCapture(event.pointerId);
    event.preventDefault();
    if (this.#dragged.range) this.#handles[near].focus({ preventScroll: true });
    else this.#seek(at);
  }

  #move(event) {
    if (!this.#dragged) return;
    const { at } = this.#seconds(event);
    if (!this.#dragged.range) return this.#seek(at);
    this.#dragged.range = this.#moved(this.#dragged.range, this.#dragged.end, at);
    this.#place(this.#dragged.range);
  }

  #seek(at) {
    const [from, to] = this.#range();
    this.#hooks.seek(Math.min(Math.max(at, from), to));
  }

  /** Returns a range with one end elsewhere. */
  #moved([from, to], end, at) {
    const all = this.#clip.seconds;
    return end ? [from, Math.min(Math.max(at, from + MIN_RANGE), all)] : [Math.max(Math.min(at, to - MIN_RANGE), 0), to];
  }

  #release() {
    const range = this.#dragged?.range;
    this.#dragged = undefined;
    if (range && String(range) !== String(this.#range())) this.#choose(range);
  }

  #choose([from, to]) {
    const isWhole = from <= 0.005 && to >= this.#clip.seconds - 0.005;
    this.#hooks.range(isWhole ? undefined : [from, to]);
  }

  #key(event, end) {
    const step = { ArrowRight: 0.1, ArrowUp: 0.1, ArrowLeft: -0.1, ArrowDown: -0.1, PageUp: 1, PageDown: -1, Home: -Infinity, End: Infinity }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    const range = this.#moved(this.#range(), end, Math.min(Math.max(this.#range()[end] + step, 0), this.#clip.seconds));
    if (String(range) === String(this.#range())) return;
    this.#clip = { ...this.#clip, range };
    this.#place(range);
    this.#chooseLater(range);
  }
}

/** Returns a length of time as a text. */
export function lengthText(seconds) {
  const minutes = Math.round(seconds / 60);
  return minutes < 60 ? sentence("lengthMinutes", { minutes }) : sentence("length", { hours: number(Math.floor(minutes / 60)), minutes: minutes % 60 });
}
