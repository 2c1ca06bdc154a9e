// The foot of the panel: what is on the stage, a band of its poses with the playhead and a range,
// and searches from its present moment.

import { button, contextOf, delayed, element } from "./elements.js";
import { rounded } from "./address.js";
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
  /** A range that is dragged, or that keys have made, until it is on the stage. */
  #wanted;
  /** A range is cut out once the keys rest. */
  #chooseLater = delayed(() => this.#choose(), 400);
  #resized = new ResizeObserver(() => this.#draw());

  /**
   * @param hooks like(), copies(), put(slot), range([from, to] or undefined): a promise, seek(seconds), time(): seconds, or
   *   undefined while the clip does not play alone
   */
  constructor(hooks) {
    this.#hooks = hooks;
    [this.#title, this.#facts] = [element("b"), element("small")];
    this.#like = button({ icon: "like", text: sentence("likeThis"), title: sentence("likeHelp"), class: "main", onclick: () => hooks.like() });
    this.#copies = button({ icon: "copies", text: " ", class: "quiet", onclick: () => hooks.copies() });
    this.#slots = ["A", "B"].map((slot) => button({ text: slot, class: `slot ${slot.toLowerCase()}`, onclick: () => hooks.put(slot) }));
    this.#whole = button({ text: sentence("whole"), class: "quiet", onclick: () => this.#useWhole() });
    this.#canvas = element("canvas");
    [this.#head, this.#outside] = [element("i", { class: "playhead" }), [element("i", { class: "outside" }), element("i", { class: "outside" })]];
    this.#handles = ["rangeFrom", "rangeTo"].map((word, end) => element("div", {
      class: `handle ${end ? "to" : "from"}`, role: "slider", tabIndex: 0, "aria-label": sentence(word), "aria-orientation": "horizontal", onkeydown: (event) => this.#key(event, end),
    }));
    this.#band = element("div", {
      class: "band", role: "group", "aria-label": sentence("range"),
      onpointerdown: (event) => this.#press(event), onpointermove: (event) => this.#move(event), onpointerup: () => this.#release(), onpointercancel: () => this.#giveUp(),
    }, [this.#canvas, ...this.#outside, this.#head, ...this.#handles]);
    this.root = element("div", { class: "dock", role: "group", "aria-label": sentence("playing") }, [
      element("div", { class: "title" }, [element("div", {}, [this.#title, this.#facts]), this.#whole, ...this.#slots]),
      this.#band,
      element("div", { class: "actions" }, [this.#like, this.#copies]),
    ]);
    this.#resized.observe(this.#canvas);
    this.show({});
  }

  /** Shows what is on the stage. `picture` is the bitmap of a clip's thumbnail. */
  show(clip, picture) {
    // What is being changed of a clip stays while that is on the stage.
    if (clip.row !== this.#clip.row) this.#giveUp();
    [this.#clip, this.#picture] = [clip, picture];
    const isOfCorpus = clip.seconds !== undefined;
    this.#title.textContent = clip.name ?? sentence("nothing");
    this.#band.hidden = !isOfCorpus;
    this.#whole.hidden = !clip.range;
    for (const [at, slot] of this.#slots.entries()) {
      slot.hidden = !isOfCorpus;
      slot.setAttribute("aria-label", sentence(at ? "putB" : "putA", { name: clip.name }));
    }
    this.#like.hidden = !clip.name;
    this.#copies.hidden = !clip.copies;
    if (clip.copies) this.#copies.lastChild.textContent = sentence("nearCopies", { count: clip.copies });
    this.#place();
    this.#draw();
    this.tick();
  }

  /** Ends what is under way. */
  end() {
    this.#giveUp();
    this.#resized.disconnect();
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

  /** Shows the range, in the text and by the handles. */
  #place() {
    const { seconds: all = 1, name } = this.#clip;
    const [from, to] = this.#range();
    const length = `${all.toFixed(2)} s`;
    const isPart = (this.#wanted ?? this.#clip.range) !== undefined;
    this.#facts.textContent = this.#clip.seconds === undefined ? (name ? sentence("playing") : "") : isPart ? `${from} – ${to} s / ${length}` : length;
    const shares = [from / all, to / all].map((share) => 100 * Math.min(Math.max(share, 0), 1));
    this.#handles.forEach((handle, end) => {
      handle.style.left = `${shares[end]}%`;
      for (const [key, value] of [["valuemin", 0], ["valuemax", rounded(all)], ["valuenow", [from, to][end]], ["valuetext", `${[from, to][end]} s`]]) handle.setAttribute(`aria-${key}`, value);
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

  /** Returns the range, in hundredths of a second as addresses have it. */
  #range() {
    return (this.#wanted ?? this.#clip.range ?? [0, this.#clip.seconds ?? 1]).map(rounded);
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
    this.#dragged = distances[near] <= NEAR ? { end: near } : {};
    event.currentTarget.setPointerCapture(event.pointerId);
    event.preventDefault();
    if (this.#dragged.end !== undefined) this.#handles[near].focus({ preventScroll: true });
    else this.#seek(at);
  }

  #move(event) {
    if (!this.#dragged) return;
    const { at } = this.#seconds(event);
    if (this.#dragged.end === undefined) return this.#seek(at);
    this.#wanted = this.#moved(this.#dragged.end, at);
    this.#place();
  }

  #seek(at) {
    const [from, to] = this.#range();
    this.#hooks.seek(Math.min(Math.max(at, from), to));
  }

  /** Returns the range with one end elsewhere. */
  #moved(end, at) {
    const [from, to] = this.#range();
    const all = this.#clip.seconds;
    return (end ? [from, Math.min(Math.max(at, from + MIN_RANGE), all)] : [Math.max(Math.min(at, to - MIN_RANGE), 0), to]).map(rounded);
  }

  #release() {
    this.#dragged = undefined;
    if (this.#wanted) this.#choose();
  }

  /** Cuts out the range that is wanted. */
  async #choose() {
    this.#chooseLater.cancel();
    const wanted = this.#wanted;
    const [from, to] = this.#range();
    const range = from <= 0 && to >= rounded(this.#clip.seconds) ? undefined : [from, to];
    if (String(range) !== String(this.#clip.range)) await this.#hooks.range(range);
    if (this.#wanted !== wanted) return;
    this.#wanted = undefined;
    this.#place();
  }

  #useWhole() {
    this.#giveUp();
    this.#hooks.range(undefined);
  }

  /** Leaves the range as it is on the stage. */
  #giveUp() {
    this.#chooseLater.cancel();
    this.#dragged = this.#wanted = undefined;
    this.#place();
  }

  #key(event, end) {
    const step = { ArrowRight: 0.1, ArrowUp: 0.1, ArrowLeft: -0.1, ArrowDown: -0.1, PageUp: 1, PageDown: -1, Home: -Infinity, End: Infinity }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    const range = this.#moved(end, Math.min(Math.max(this.#range()[end] + step, 0), this.#clip.seconds));
    if (String(range) === String(this.#range())) return;
    this.#wanted = range;
    this.#place();
    this.#chooseLater();
  }
}

/** Returns a length of time as a text. */
export function lengthText(seconds) {
  const minutes = Math.round(seconds / 60);
  return minutes < 60 ? sentence("lengthMinutes", { minutes }) : sentence("length", { hours: number(Math.floor(minutes / 60)), minutes: minutes % 60 });
}
