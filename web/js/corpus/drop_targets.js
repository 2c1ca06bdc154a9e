// Where a dragged row can be dropped: over the halves of the stage.

import { element } from "./elements.js";
import { sentence } from "./words.js";

export class DropTargets {
  root = element("div", { class: "corpus corpus-targets", hidden: true });
  /** Called with the letter on which a row is dropped. */
  #drop;
  /** A row that is taken out of the page while it is dragged has no `dragend`, but then the pointer moves again. */
  #end = (event) => {
    if (event.type === "dragend" || event.buttons === 0) this.hide();
  };

  /** Shows the targets of a drag. */
  show(drop) {
    this.#drop = drop;
    this.root.replaceChildren(this.#target("A"), this.#target("B"));
    this.root.hidden = false;
    for (const type of ["dragend", "pointermove"]) window.addEventListener(type, this.#end, true);
  }

  /** Hides them after it. */
  hide() {
    this.#drop = undefined;
    this.root.hidden = true;
    for (const type of ["dragend", "pointermove"]) window.removeEventListener(type, this.#end, true);
  }

  #target(slot) {
    return element("div", {
      class: `target ${slot.toLowerCase()}`,
      ondragover: (event) => {
        event.preventDefault();
        event.dataTransfer.dropEffect = "copy";
      },
      ondragenter: (event) => event.currentTarget.classList.add("hot"),
      ondragleave: (event) => event.currentTarget.classList.remove("hot"),
      ondrop: (event) => {
        event.preventDefault();
        const drop = this.#drop;
        this.hide();
        drop?.(slot);
      },
    }, [element("b", { textContent: slot }), element("span", { textContent: sentence(slot === "A" ? "dropA" : "dropB") })]);
  }
}
