// The first script of the page. It is no module, so that it runs before everything else.

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
