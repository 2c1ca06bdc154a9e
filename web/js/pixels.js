// The size of the canvas under emulation. The app sizes its canvas by what a ResizeObserver tells in device pixels, and lays the
// page out by `devicePixelRatio`. On a screen both agree. A browser that emulates another device (its developer tools, or a
// test) tells the former in the pixels of the real screen, and everything would be drawn too large by the ratio.

/** The difference that rounding makes, and a fraction of zoom, in device pixels. */
const ROUNDING = 2;

/** Makes ResizeObservers tell sizes in device pixels that agree with `devicePixelRatio`. Call it before the app starts. */
export function agreePixels() {
  const entry = window.ResizeObserverEntry?.prototype;
  const told = entry && Object.getOwnPropertyDescriptor(entry, "devicePixelContentBoxSize");
  if (!told?.get) return; // the app then multiplies by the ratio itself
  Object.defineProperty(entry, "devicePixelContentBoxSize", {
    ...told,
    get() {
      const sizes = told.get.call(this);
      const [size, css] = [sizes[0], this.contentBoxSize[0]];
      const [inline, block] = [css.inlineSize, css.blockSize].map((pixels) => pixels * window.devicePixelRatio);
      if (Math.abs(size.inlineSize - inline) <= ROUNDING && Math.abs(size.blockSize - block) <= ROUNDING) return sizes;
      // A size by its prototype: the app asks for it.
      const values = { inlineSize: { value: Math.round(inline) }, blockSize: { value: Math.round(block) } };
      return [Object.create(ResizeObserverSize.prototype, values)];
    },
  });
}
