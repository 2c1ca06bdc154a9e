// The place of the panel: beside the stage, with an edge that is dragged, or on a phone over it.

import { element, icon } from "./elements.js";
import { readStored, writeStored } from "./stored.js";
import { sentence } from "./words.js";

const WIDTHS = { least: 380, usual: 540, most: 1100 };
/** The least width of the stage beside the panel, pixels. */
const MIN_STAGE = 420;
const WIDTH_KEY = "segue corpus width";
/** A page on which panel and stage have no room beside each other, as in panel.css. */
const PHONE = window.matchMedia("(max-width: 800px), (max-height: 480px)");

export class Layout {
  #root;
  /** The way back to the panel from the stage of a phone. */
  #back;
  #resizer;
  #changed;
  #width = Number(readStored(WIDTH_KEY)) || WIDTHS.usual;

  /**
   * @param root the panel
   * @param changed called when the panel may have another width
   */
  constructor(root, changed) {
    [this.#root, this.#changed] = [root, changed];
    this.#back = element("button", { type: "button", class: "corpus corpus-back", hidden: true, onclick: () => this.showPanel(true) });
    PHONE.addEventListener("change", () => this.update());
    window.addEventListener("resize", () => this.update());
  }

  get isPhone() {
    return PHONE.matches;
  }

  /** Whether the stage of a phone hides the panel. */
  get isHidden() {
    return this.#root.hidden;
  }

  /** The elements beside the panel that have its theme. */
  get elements() {
    return [this.#back];
  }

  /** Puts the panel into the page, with other elements beside it. */
  attach(...others) {
    if (!this.#root.isConnected) document.getElementById("segue").before(this.#root, this.#back, ...others);
    this.showPanel(true);
  }

  /** Takes the panel out of the page. */
  detach(...others) {
    for (const each of [this.#root, this.#back, ...others]) each.remove();
    this.update();
  }

  /** Makes the edge that resizes the panel, and the text of the way back, in the language of the page. */
  build() {
    this.#back.replaceChildren(icon("left"), element("span", { textContent: sentence("corpus") }));
    this.#resizer = element("div", {
      class: "resizer", role: "separator", tabIndex: 0, "aria-orientation": "vertical", "aria-label": sentence("resize"), "aria-valuemin": WIDTHS.least, "aria-valuemax": WIDTHS.most,
      onpointerdown: (event) => this.#grip(event), onkeydown: (event) => this.#key(event),
    });
    return this.#resizer;
  }

  /** On a phone, shows the panel or the stage behind it. */
  showPanel(isShown) {
    if (!PHONE.matches && !isShown) return;
    this.#root.hidden = !isShown;
    this.update();
    if (!isShown) this.#back.focus({ preventScroll: true });
  }

  /** Gives the canvas the room beside the panel. */
  update() {
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
    this.#resizer?.setAttribute("aria-valuenow", width);
    this.#changed();
  }

  #resize(width) {
    this.#width = Math.min(Math.max(width, WIDTHS.least), WIDTHS.most);
    this.update();
  }

  #grip(event) {
    if (event.button !== 0) return;
    event.preventDefault();
    const grip = event.currentTarget;
    grip.setPointerCapture(event.pointerId);
    const [start, before] = [event.clientX, this.#root.offsetWidth];
    let [frame, wanted] = [0, before];
    const move = ({ clientX }) => {
      wanted = before + clientX - start;
      cancelAnimationFrame(frame);
      frame = requestAnimationFrame(() => this.#resize(wanted));
    };
    const end = () => {
      grip.removeEventListener("pointermove", move);
      cancelAnimationFrame(frame);
      this.#resize(wanted);
      writeStored(WIDTH_KEY, String(this.#width));
    };
    grip.addEventListener("pointermove", move);
    grip.addEventListener("lostpointercapture", end, { once: true });
  }

  #key(event) {
    const step = { ArrowLeft: -20, ArrowRight: 20, Home: -Infinity, End: Infinity }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    // A narrow page shows less than the width that is kept.
    this.#resize(this.#root.offsetWidth + step);
    writeStored(WIDTH_KEY, String(this.#width));
  }
}
