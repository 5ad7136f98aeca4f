// The figures of a page: the plotting library is unpacked when the text is there to be read, and draws them in turn.
"use strict";
const unpacked = (text) => new Response(new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))]).stream()
  .pipeThrough(new DecompressionStream("gzip")));
const stored = (kind) => [...document.querySelectorAll(`script[data-kind="${kind}"]`)];
const figuresDrawn = (async () => {
  if (document.readyState !== "complete") await new Promise((done) => addEventListener("load", done, { once: true }));
  const library = document.createElement("script");
  library.textContent = await unpacked(stored("library")[0].textContent).text();
  document.head.append(library);
  for (const text of stored("figure")) {
    const { data, layout, config } = JSON.parse(text.textContent);
    await Plotly.newPlot(text.previousElementSibling, data, layout, config);
  }
  for (const button of document.querySelectorAll("button[data-plot]"))
    button.addEventListener("click", () => Plotly.relayout(button.dataset.plot, JSON.parse(button.dataset.view)));
})();
