// The rest of the app's module, which comes behind the first frames. xtask/src/page.rs names its
// file; tools/bindgen/src/split.rs divides the module.

/** The pauses before each attempt to download it, milliseconds. */
const DOWNLOAD_AFTER_MS = [0, 1000, 4000];

/** The number of attempts in the middle of a call. */
const ATTEMPTS = 3;

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
    try {
      const compiled = await this.#compiled;
      if (this.#isThere) return;
      // It puts its functions into the tables of the first part.
      await WebAssembly.instantiate(compiled, this.#imports());
      this.#isThere = true;
    } catch (reason) {
      if (!this.#isThere) throw reason; // fetched in the middle of a call
    }
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
      new WebAssembly.Instance(new WebAssembly.Module(bytesNow(this.#address)), this.#imports());
      this.#isThere = true;
    } catch (reason) {
      // The call cannot go on, as in a panic.
      throw new WebAssembly.RuntimeError(`A part of Segue could not be downloaded: ${reason?.message ?? reason}`);
    }
  }

  #imports() {
    return { first: this.#first };
  }
}

/** Returns the bytes at an address while the page stands still. */
function bytesNow(address) {
  let last;
  for (let attempt = 0; attempt < ATTEMPTS; attempt++) {
    const request = new XMLHttpRequest();
    request.open("GET", address, false);
    // A request that waits gives text alone: each character is a byte.
    request.overrideMimeType("text/plain; charset=x-user-defined");
    try {
      request.send();
      if (request.status === 200) return Uint8Array.from(request.responseText, (letter) => letter.charCodeAt(0) & 0xff);
      last = new Error(`${address} answered ${request.status}`);
    } catch (reason) {
      last = reason;
    }
  }
  throw last;
}

/**
 * Returns whether a module can be compiled in the middle of a call: older browsers refuse to
 * compile one of more than 4 KB.
 */
export function compilesNow() {
  // An empty module, with a section of its own that has a name of no letters.
  const bytes = new Uint8Array(5000);
  const rest = bytes.length - 11;
  bytes.set([0x00, 0x61, 0x73, 0x6d, 0x01, 0x00, 0x00, 0x00, 0x00, 0x80 | (rest & 0x7f), rest >> 7]);
  try {
    new WebAssembly.Module(bytes);
    return true;
  } catch {
    return false;
  }
}
