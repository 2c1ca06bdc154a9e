// The first script of the page. It is no module, so that it runs before everything else: it begins
// to download the app. Its element names the files (Trunk.toml; xtask/src/page.rs).

// A promise of the page's API, for pages that embed or drive this one.
window.segueReady = new Promise((resolve, reject) => { window.segueSettle = { resolve, reject }; });
window.segueReady.catch(() => {}); // a panel shows a failure, so it is not an unhandled rejection

// Sets the language of the link, or that of the browser. The app sets it again when it shows
// another.
document.documentElement.lang = ((asked) => {
  const chinese = (tag) => /^zh\b.*\b(hant|tw|hk|mo)\b/i.test(tag);
  const known = asked === "en" || asked === "zh-Hant" ? asked : navigator.languages.find((tag) => /^en\b/i.test(tag) || chinese(tag));
  return chinese(known) ? "zh-Hant" : "en";
})(new URLSearchParams(location.search).get("lang"));

// The app comes as one or two modules: with WebGL 2, and, a fifth smaller, with WebGPU alone. The
// latter is begun before it is known whether there is an adapter: most browsers that could have one
// do, and find it soon. One without an adapter may take a third of a second to say so. After
// `MAX_ADAPTER_MS` a first visit takes the module with WebGL 2, which draws with WebGPU, too, if an
// adapter comes later. Later visits take the module that the service worker keeps, because it is
// there without a network. boot.js takes the module that is downloaded here, or, if the adapter has
// no device, stops that and takes `withWebgl2()`. As deployed, `wasm` is the first part of a
// module, and rest.js downloads the rest.
window.segueDownload = (({ js, wasm, rest, webgpuJs, webgpuWasm, webgpuRest }) => {
  const begin = (js, wasm, rest, hasWebgl2) => {
    const abort = new AbortController();
    const response = fetch(wasm, { signal: abort.signal });
    response.catch(() => {}); // boot.js shows it
    document.head.append(Object.assign(document.createElement("link"), { rel: "modulepreload", href: js }));
    return { js, wasm, rest, hasWebgl2, response, stop: () => abort.abort() };
  };
  const withWebgl2 = () => begin(js, wasm, rest, true);
  const withWebgpu = () => begin(webgpuJs, webgpuWasm, webgpuRest, false);
  const MAX_ADAPTER_MS = 100;
  const asked = new URLSearchParams(location.search).get("backend");
  const worker = navigator.serviceWorker?.controller?.scriptURL;
  const keptModule = worker && new URL(worker).searchParams.get("module");
  const choose = async () => {
    if (!webgpuWasm || !navigator.gpu || keptModule === "webgl2" || ["webgl2", "fallback"].includes(asked)) return withWebgl2();
    const module = withWebgpu();
    if (asked === "webgpu") return module;
    // Begun before the request, during which the page may stand still while the browser starts its
    // graphics process: that time counts as well.
    const late = new Promise((resolve) => setTimeout(resolve, MAX_ADAPTER_MS));
    const adapter = navigator.gpu.requestAdapter().catch(() => null);
    if (await (keptModule ? adapter : Promise.race([adapter, late]))) return module;
    module.stop();
    return withWebgl2();
  };
  return { module: choose(), withWebgl2 };
})(document.currentScript.dataset);
