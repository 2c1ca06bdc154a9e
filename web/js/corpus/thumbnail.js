// Pictures and hints of single clips.

import { element } from "./elements.js";

/** Returns the bitmap of a clip's thumbnail; null if it has none. */
export async function thumbnailOf(corpus, row) {
  let png;
  await corpus.ask("thumbnails", { rows: [row] }, { onPart: ([, bytes]) => { png = bytes; } });
  return png ? createImageBitmap(new Blob([png], { type: "image/png" })) : null;
}

/** Returns the elements of a clip's hint. */
export async function hintOf(corpus, row) {
  const [[cell], picture] = await Promise.all([corpus.ask("cells", { rows: [row] }), thumbnailOf(corpus, row).catch(() => null)]);
  const image = picture && element("canvas", { width: 264, height: 48 });
  image?.getContext("2d").drawImage(picture, 0, 0);
  const facts = [`${cell.seconds?.toFixed(2) ?? "–"} s`, cell.format?.toUpperCase(), cell.labels?.join(", ")].filter(Boolean);
  return [image, element("b", { textContent: cell.name }), element("small", { textContent: facts.join(" · ") })].filter(Boolean);
}
