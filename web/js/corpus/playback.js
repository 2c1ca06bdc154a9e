// What is on the stage beside an open corpus: its clips, one of them at the foot of the panel, and searches from its moments.

import { clipAddress, clipOf } from "./address.js";
import { clipsRead, isRead, readClip } from "./client.js";
import { Dock } from "./dock.js";
import { addresses } from "./player.js";
import { thumbnailOf } from "./thumbnail.js";
import { sentence } from "./words.js";

/** The number of moments that a search finds. */
const HITS = 40;
/** The time between two positions of the playhead, milliseconds: it leaves the time to the stage. */
const TICK_MS = 100;

export class Playback {
  #corpus;
  #api;
  #player;
  #layout;
  #dock;
  /** The clip of the corpus on the stage: { row, id, name, seconds, range, clipId, copies, picture }. */
  #current;

  /**
   * @param corpus the `OpenCorpus`
   * @param hooks api, player and layout
   */
  constructor(corpus, { api, player, layout }) {
    [this.#corpus, this.#api, this.#player, this.#layout] = [corpus, api, player, layout];
    this.#tick();
  }

  /** Makes the foot of the panel, in the language of the page. */
  build() {
    this.#dock?.end();
    this.#dock = new Dock({
      like: () => this.#like(),
      copies: () => this.#corpus.showCopies(this.#current).catch((reason) => this.#corpus.say(reason)),
      put: (slot) => this.put(this.#current.row, slot, this.#current.range),
      range: (range) => this.#load(this.#current.row, { range }),
      seek: (seconds) => this.#api.seek(Math.max(seconds - (this.#current.range?.[0] ?? 0), 0)),
      time: () => this.#time(),
    });
    this.#showDock();
    return this.#dock.root;
  }

  /** Ends what is under way. */
  end() {
    this.#dock?.end();
  }

  /** The row of the clip on the stage; undefined if that is of elsewhere. */
  get row() {
    return this.#isPlaying ? this.#current.row : undefined;
  }

  /** Plays a clip alone, from a moment of it. */
  async play(row, seconds) {
    // On a phone, the stage lies behind the panel.
    this.#layout.showPanel(false);
    await this.#load(row, { seconds });
  }

  /** Puts a clip, or a range of it, into A or B of the open lab. */
  async put(row, slot, range) {
    if (await this.#load(row, { slot, range })) this.#layout.showPanel(false);
  }

  /** Loads a clip, and returns whether it was. What goes wrong is shown. */
  async #load(row, { slot, range, seconds }) {
    const corpus = this.#corpus;
    corpus.say("");
    let name = "";
    try {
      const [cell] = await corpus.ask("cells", { rows: [row] });
      ({ name } = cell);
      if (!slot) corpus.mark(row);
      const read = async () => {
        const { bytes } = await corpus.ask("clip", { id: cell.id, range });
        return [`${name.replaceAll("/", " ")}.npz`, bytes];
      };
      const { address } = corpus.place;
      await this.#player.put(address ? { corpus: address, id: cell.id, range } : { read }, { slot, seconds });
      if (corpus.hasEnded) return false;
      if (!slot) await this.#setCurrent({ row, id: cell.id, name, seconds: cell.seconds, range, clipId: this.#api.params().a });
      return true;
    } catch (reason) {
      if (reason?.name === "AbortError" || corpus.hasEnded) return false;
      this.show();
      this.#layout.showPanel(true);
      corpus.say(new Error(sentence("noRead", { name, reason: String(reason?.message ?? reason) })));
      return false;
    }
  }

  async #setCurrent(current) {
    this.#current = current;
    this.show();
    const [copies, picture] = await Promise.all([this.#corpus.ask("copiesOf", { row: current.row }), thumbnailOf(this.#corpus, current.row).catch(() => null)]);
    Object.assign(current, { copies: copies.length, picture });
    if (this.#current === current) this.show();
  }

  /** Whether the clip at the foot is on the stage. */
  get #isPlaying() {
    return this.#current !== undefined && this.#current.clipId === this.#api.params().a;
  }

  /** Shows in the table, on the map and at the foot what is on the stage. */
  show() {
    this.#corpus.mark(this.row);
    this.#showDock();
  }

  #showDock() {
    if (this.#isPlaying) return this.#dock.show(this.#current, this.#current.picture);
    const { a } = this.#api.params();
    this.#dock.show({ name: this.#api.clips().find(({ id }) => id === a)?.name });
  }

  /** Follows a change of the clip on the stage. */
  async follow() {
    const { address } = this.#corpus.place;
    const before = this.#current;
    if (address) {
      await this.#learn(address);
      const playing = this.#player.playing(address);
      if (playing && !this.#isKnown(playing)) {
        const { id, range, clipId } = playing;
        const row = clipsRead.get(clipAddress(address, id, range))?.row ?? (await this.#corpus.ask("find", { id }));
        const [cell] = row === undefined ? [] : await this.#corpus.ask("cells", { rows: [row] });
        // A click may have come first.
        if (this.#current !== before) return;
        if (cell) return this.#setCurrent({ row, id: cell.id, name: cell.name, seconds: cell.seconds, range, clipId });
      }
    }
    this.show();
  }

  #isKnown({ id, range, clipId }) {
    const current = this.#current;
    // An address may have the beginning of an id.
    return current !== undefined && current.id.startsWith(id) && String(current.range) === String(range) && current.clipId === clipId;
  }

  /**
   * Learns the SHA-256 of the link's clips that came from the browser's storage: a name alone may be
   * that of another clip. They are read for that, once.
   */
  async #learn(corpus) {
    for (const source of addresses(this.#api.params())) {
      const clip = clipOf(source);
      if (clip?.corpus !== corpus || isRead(source)) continue;
      const row = await this.#corpus.ask("find", { id: clip.id });
      if (row === undefined) continue;
      const [{ name }] = await this.#corpus.ask("cells", { rows: [row] });
      if (this.#player.hasNamed(name) && !isRead(source)) await readClip(source, this.#corpus.signal).catch((reason) => console.info(reason));
      this.#corpus.signal.throwIfAborted();
    }
  }

  /** Returns the time in the clip on the stage, seconds; undefined while it does not play alone. */
  #time() {
    const { lab, a } = this.#api.params();
    if (lab !== "view" || a !== this.#current?.clipId) return undefined;
    return (this.#current.range?.[0] ?? 0) + this.#api.time();
  }

  /** Moves the playhead until the corpus is closed. */
  #tick() {
    if (this.#corpus.hasEnded) return;
    if (!this.#layout.isHidden) this.#dock?.tick();
    setTimeout(() => requestAnimationFrame(() => this.#tick()), TICK_MS);
  }

  /** Searches for the moments that are most like the present one on the stage. */
  async #like() {
    const [corpus, dock] = [this.#corpus, this.#dock];
    dock.setSearching(true);
    try {
      const seconds = this.#time();
      const of = seconds === undefined ? undefined : this.#current;
      const [{ a }, time] = [this.#api.params(), this.#api.time()];
      const name = of?.name ?? this.#api.clips().find(({ id }) => id === a)?.name ?? "";
      const question = of ? { row: of.row, seconds } : { name: "stage.npz", bytes: await this.#api.export("result", "npz"), seconds: time };
      const hits = await corpus.ask("like", { ...question, count: HITS + 1 });
      corpus.say("");
      await corpus.showHits({ name, seconds: (seconds ?? time).toFixed(2) }, hits.filter(({ row }) => row !== of?.row).slice(0, HITS));
    } catch (reason) {
      corpus.say(reason);
    } finally {
      dock.setSearching(false);
    }
  }
}
