// Addresses of corpora and of their clips.
//
//   https://example.org/takes/corpus.json                     a corpus; its folder names it as well
//   https://example.org/takes/corpus.json#3fa9c1d2-0          a clip of it
//   https://example.org/takes/corpus.json#3fa9c1d2-0@1.5-4    its seconds from 1.5 to 4

const MANIFEST = "corpus.json";

/**
 * Returns the full address of a corpus, which ends in `/corpus.json`, given that or the address of
 * its folder; null if it is none.
 */
export function corpusAddress(text) {
  let url;
  try {
    url = new URL(text.trim(), document.baseURI);
  } catch {
    return null;
  }
  if (!text.trim() || !["http:", "https:"].includes(url.protocol)) return null;
  url.hash = "";
  if (!url.pathname.endsWith(`/${MANIFEST}`)) url.pathname = `${url.pathname.replace(/\/$/, "")}/${MANIFEST}`;
  return url.href;
}

/** Returns the name of a corpus: that of its folder, or of its host. */
export function corpusName(address) {
  const { pathname, host } = new URL(address);
  const folder = pathname.split("/").at(-2);
  try {
    return decodeURIComponent(folder) || host;
  } catch {
    return folder || host;
  }
}

/** Returns the address of a clip, or of a range of it, seconds. */
export function clipAddress(corpus, id, range) {
  return `${corpus}#${id}${range ? `@${seconds(range[0])}-${seconds(range[1])}` : ""}`;
}

/** Returns seconds as addresses have them: hundredths. */
export const rounded = (value) => Number(value.toFixed(2));

const seconds = (value) => String(rounded(value));

/** Returns the corpus, the id and the range, if any, of a clip's address; null if it is none. */
export function clipOf(address) {
  const [corpus, clip] = address.split("#");
  const found = /^([^@]+)(?:@(\d+(?:\.\d+)?)-(\d+(?:\.\d+)?))?$/.exec(clip ?? "");
  if (!found || !corpus.split("?")[0].endsWith(`/${MANIFEST}`)) return null;
  const [, id, from, to] = found;
  return { corpus, id, range: from === undefined ? undefined : [Number(from), Number(to)] };
}
