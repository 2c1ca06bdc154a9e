// The rest of the app's module, which comes behind the first frames. xtask/src/page.rs names its
// file; tools/bindgen/src/split.rs divides the module.

/** The pauses before each attempt to download it, milliseconds. */
const DOWNLOAD_AFTER_MS = [0, 1000, 4000];

/** The rest of a module whose first part is instantiated. */
export class Rest {
  #address;
  #first;
  #response;
  #compiled;
  #isThere;

  /**
   * @param rest its address; undefined for a module that is not divided
   * @param after a promise after which the download begins
   */
  constructor(rest, after) {
    this.#address = rest;
    this.#isThere = !rest;
    this.#response = rest && after.then(() => fetch(rest, { priority: "low" }));
    this.#response?.catch(() => {}); // compile() shows it
  }

  /** Compiles the rest as it comes, which takes the processor from a start that is under way. */
  compile() {
    if (this.#isThere) return;
    this.#compiled ??= this.#download();
    this.#compiled.catch(() => {}); // complete() shows it
  }

  /**
   * Has the first part ask for the rest where it needs it.
   * @param first the exports of the first part
   */
  follow(first) {
    this.#first = first;
    window.segueFetchRest = () => this.#fetchNow();
  }

  /** Waits until the module is complete. Rejects where the rest cannot be downloaded. */
  async complete() {
    this.compile();
    if (!this.#isThere) this.#join(await this.#compiled);
  }

  async #download() {
    let last;
    for (const wait of DOWNLOAD_AFTER_MS) {
      if (wait) await new Promise((resolve) => setTimeout(resolve, wait));
      try {
        const response = await (last ? fetch(this.#address) : this.#response);
        if (!response.ok) throw new Error(`${this.#address} answered ${response.status}`);
        return await WebAssembly.compileStreaming(response);
      } catch (reason) {
        last = reason;
      }
    }
    throw last;
  }

  /**
   * Fetches the rest while the page stands still: the app is in the middle of a call that needs
   * it.
   */
  #fetchNow() {
    console.warn(new Error("The first part of the app needs the rest (web/rest.txt).").stack);
    try {
      const request = new XMLHttpRequest();
      request.open("GET", this.#address, false);
      // A request that waits gives text alone: each character is a byte.
      request.overrideMimeType("text/plain; charset=x-user-defined");
      request.send();
      if (request.status !== 200) throw new Error(`${this.#address} answered ${request.status}`);
      const bytes = Uint8Array.from(request.responseText, (letter) => letter.charCodeAt(0) & 0xff);
      this.#join(new WebAssembly.Module(bytes));
    } catch (reason) {
      // The call cannot go on, as in a panic.
      throw new WebAssembly.RuntimeError(`A part of Segue could not be downloaded: ${reason?.message ?? reason}`);
    }
  }

  /** Puts the functions of the rest into the tables of the first part, as its instance does. */
  #join(module) {
    if (this.#isThere) return;
    new WebAssembly.Instance(module, { first: this.#first });
    this.#isThere = true;
  }
}
