// What exists from the first moment on: no module, so that it runs before anything else of the page.

// Whoever embeds or drives the page awaits it.
window.segueReady = new Promise((resolve, reject) => { window.segueSettle = { resolve, reject }; });
window.segueReady.catch(() => {}); // the page itself tells of a failure in a panel; it is no unhandled rejection

// The language that the link asks for, else the reader's; the app sets it again to the one that it speaks.
document.documentElement.lang = ((asked) => {
  const chinese = (tag) => /^zh\b.*\b(hant|tw|hk|mo)\b/i.test(tag);
  const known = asked === "en" || asked === "zh-Hant" ? asked : navigator.languages.find((tag) => /^en\b/i.test(tag) || chinese(tag));
  return chinese(known) ? "zh-Hant" : "en";
})(new URLSearchParams(location.search).get("lang"));
