"""What pages look like, and what they may load: nothing."""

POLICY = (
    '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; script-src \'unsafe-inline\'; '
    "style-src 'unsafe-inline'; img-src data: blob:\">\n<link rel=\"icon\" href=\"data:,\">\n"
)
"""The browser itself refuses every request that a page might make."""

STYLE = """
:root { color-scheme: light dark; --text: #1c2024; --soft: #5b6570; --back: #ffffff; --panel: #f6f7f9; --line: #d5dae0;
  --road: #c9cfd6; --mark: #ffffff; --link: #0b57a4; --bad: #b3261e; }
@media (prefers-color-scheme: dark) { :root { --text: #e7eaee; --soft: #a3adb8; --back: #14171a; --panel: #1d2125;
  --line: #3a424b; --road: #48515b; --mark: #6d7782; --link: #7db7f5; --bad: #ff8a80; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 82rem; padding: 1rem 1.5rem 4rem; background: var(--back); color: var(--text);
  font: 15px/1.5 system-ui, -apple-system, "Segoe UI", "Noto Sans", "Liberation Sans", sans-serif; }
h1 { font-size: 1.6rem; margin: .5rem 0 0; overflow-wrap: anywhere; } h2 { font-size: 1.2rem; margin: 2rem 0 .5rem; }
h3 { font-size: 1rem; margin: 1.5rem 0 .3rem; }
header p { margin: .2rem 0 .6rem; } nav { color: var(--soft); } a { color: var(--link); } p { max-width: 60rem; }
.wide { overflow-x: auto; } .long { max-height: 34rem; overflow-y: auto; border: 1px solid var(--line); }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { text-align: left; vertical-align: top; padding: .25rem .7rem; border-bottom: 1px solid var(--line); }
th { position: sticky; top: 0; background: var(--panel); font-weight: 600; }
th:first-child { white-space: nowrap; }
td.number { text-align: right; white-space: nowrap; }
.wide > table > tbody > tr:target { outline: 2px solid var(--link); }
code { font: 12.5px/1.45 ui-monospace, "DejaVu Sans Mono", monospace; background: var(--panel); padding: .1rem .3rem;
  overflow-wrap: anywhere; }
.bad { color: var(--bad); font-weight: 600; } .soft { color: var(--soft); }
.chip { display: inline-block; width: .8em; height: .8em; border-radius: 2px; margin-right: .45em; }
.long td:first-child, .long td:nth-child(2), .near { white-space: nowrap; }
.plot { min-width: 0; border: 1px solid var(--line); margin: .6rem 0; }
.grid { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(34rem, 100%), 1fr)); gap: 0 1rem; }
.views button { font: inherit; color: var(--text); background: var(--panel); border: 1px solid var(--line);
  border-radius: 4px; padding: .1rem .6rem; margin: 0 .3rem .3rem 0; cursor: pointer; }
.plot .infolayer text, .plot [class*="axislayer"] text { fill: var(--text) !important; }
.plot .gridlayer path, .plot .zerolinelayer path { stroke: var(--line) !important; }
.plot .xlines-above, .plot .ylines-above { stroke: var(--line) !important; }
@media print { .long { max-height: none; } }
"""

SCRIPT = """<script>
addEventListener("load", () => {
  for (const plot of document.querySelectorAll(".js-plotly-plot")) Plotly.Plots.resize(plot);
});
for (const button of document.querySelectorAll("button[data-plot]"))
  button.addEventListener("click", () => Plotly.relayout(button.dataset.plot, JSON.parse(button.dataset.view)));
</script>
"""
"""Figures take the width that they have when all is there; a button shows a part of the figure that it names."""
