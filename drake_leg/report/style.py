"""The page's style sheet: on a phone, on a wide screen, on paper, light and dark."""

STYLE_SHEET = """
:root { color-scheme: light dark; --text: #1d1d1f; --page: #ffffff; --soft: #5b5b60;
  --line: #d9d9de; --note: #fff6e5; --note-line: #d98e04; --code: #f2f2f5; }
@media (prefers-color-scheme: dark) { :root { --text: #e8e8ea; --page: #17181a; --soft: #a5a5ad;
  --line: #3a3b40; --note: #2d2614; --note-line: #d9a441; --code: #26272b; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--text);
  font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, sans-serif; }
main { max-width: 52rem; margin: 0 auto; padding: 1.5rem 1rem 4rem; }
h1 { font-size: 1.7rem; line-height: 1.25; }
h2 { font-size: 1.3rem; margin: 3rem 0 .5rem; padding-top: .6rem;
  border-top: 1px solid var(--line); }
h3 { font-size: 1.05rem; margin: 2rem 0 .4rem; }
figure { margin: 0; }
img { display: block; width: 100%; height: auto; background: #ffffff; border-radius: 6px; }
figcaption { margin-top: .4rem; }
code { background: var(--code); border-radius: 4px; padding: .1em .35em; font-size: .87em; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
.wide > .data { width: 100%; }
.data code { white-space: normal; }
th, td { padding: .3rem .6rem; text-align: left; border-bottom: 1px solid var(--line);
  white-space: nowrap; }
th { color: var(--soft); font-weight: 600; font-size: .87em; }
.matrix { display: flex; flex-wrap: wrap; align-items: center; gap: .3rem .4rem;
  padding: .6rem 0; border-bottom: 1px solid var(--line); }
.matrix .name { min-width: 2.2rem; font-style: italic; }
.grid { display: inline-table; vertical-align: middle; margin: 0 .2rem; font-size: .87em;
  border-left: 1.5px solid var(--text); border-right: 1.5px solid var(--text); }
.grid td { border: 0; padding: .1rem .5rem; text-align: center; }
.proof { color: var(--soft); font-size: .87em; }
.matrix .proof { margin-left: auto; white-space: nowrap; }
.correction { background: var(--note); border-left: 3px solid var(--note-line);
  border-radius: 4px; padding: .45rem .8rem; font-size: .93em; }
.errata h3 { margin-top: 1.6rem; }
.errata dl { display: grid; grid-template-columns: 4.5rem 1fr; gap: .2rem .6rem; margin: 0; }
.errata dt { color: var(--soft); font-size: .87em; padding-top: .1rem; }
.errata dd { margin: 0; overflow-wrap: anywhere; }
.errata sub { line-height: 0; }
@media (max-width: 34rem) { .errata dl { display: block; } .errata dd { margin-bottom: .4rem; } }
footer { margin-top: 3rem; color: var(--soft); font-size: .87em; }
@media print { main { max-width: none; padding: 0; } section { break-inside: avoid; }
  .wide { overflow: visible; } body { font-size: 11pt; } }
"""
