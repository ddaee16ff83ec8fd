#include "client/report/page_style.h"

namespace mirage {

const char* const kPageStyle = R"css(
:root { color-scheme: light dark; --ink: #1b1f24; --paper: #ffffff; --faint: #59636e;
  --line: #d0d7de; --mark: #fff3c4; --code: #f3f4f6; --card: #f6f8fa; --bad: #b42318;
  --bad-paper: #fef3f2; --link: #0b57d0; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e6e6; --paper: #15181c; --faint: #9aa4ae;
  --line: #3a414a; --mark: #4a4014; --code: #23272e; --card: #1d2127; --bad: #ff8a7a;
  --bad-paper: #3a1512; --link: #8ab4f8; } }
* { box-sizing: border-box; }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper);
  max-width: 1240px; margin: 1.5rem auto; padding: 0 1rem; }
a { color: var(--link); }
h1, h2, h3 { line-height: 1.2; } h2 { margin-top: 3rem; border-bottom: 1px solid var(--line); }
p, li { max-width: 80ch; }
nav ul { display: flex; flex-wrap: wrap; gap: .25rem 1.25rem; list-style: none; padding: 0; }
code, pre { background: var(--code); font-size: 90%; }
pre { padding: .5rem; white-space: pre-wrap; overflow-wrap: anywhere; }
.findings { display: grid; grid-template-columns: repeat(auto-fill, minmax(190px, 1fr)); gap: .75rem;
  margin: 1rem 0; padding: 0; list-style: none; }
.findings li { background: var(--card); border: 1px solid var(--line); border-radius: 8px;
  padding: .6rem .8rem; max-width: none; }
.findings a { color: inherit; text-decoration: none; display: block; }
.findings b { display: block; font-size: 1.5rem; line-height: 1.25; overflow-wrap: anywhere; }
.findings span { color: var(--faint); font-size: 90%; }
.findings .short { background: var(--bad-paper); border-color: var(--bad); }
.findings .short b { color: var(--bad); }
.shortfalls { color: var(--bad); background: var(--bad-paper); border-left: 4px solid var(--bad);
  padding: .5rem .75rem; margin: 1rem 0; } .shortfalls ul { margin: .25rem 0; padding-left: 1.2rem; }
figure { margin: 1rem 0; } figcaption { color: var(--faint); font-size: 90%; max-width: 80ch; }
figure.plot > div { background: #fff; padding: .5rem; overflow-x: auto; }
figure.plot svg { max-width: 100%; height: auto; }
.wide { overflow-x: auto; max-width: 100%; margin: 1rem 0; }
table { border-collapse: collapse; font-size: 80%; line-height: 1.35; }
th, td { border-bottom: 1px solid var(--line); padding: .2rem .5rem; text-align: left;
  vertical-align: top; }
th { vertical-align: bottom; max-width: 8.5rem; } th[title] { text-decoration: underline dotted; cursor: help; }
td { max-width: 26rem; overflow-wrap: break-word; }
td.number { text-align: right; font-variant-numeric: tabular-nums; overflow-wrap: normal; }
tr.marked td { background: var(--mark); }
details { margin: 1rem 0; } summary { cursor: pointer; color: var(--link); }
.look { display: grid; grid-template-columns: 1fr 1fr; gap: 6px; align-items: start; }
.pair { position: relative; line-height: 0; --at: 50%; }
.pair img, .heat img, .strip img { width: 100%; height: auto; display: block; }
.pair .drawn { position: absolute; inset: 0; clip-path: inset(0 calc(100% - var(--at)) 0 0); }
.pair::after { content: ""; position: absolute; top: 0; bottom: 0; left: var(--at); width: 2px;
  margin-left: -1px; background: #fff; box-shadow: 0 0 3px #000; pointer-events: none; }
.pair input { position: absolute; inset: 0; width: 100%; height: 100%; margin: 0; opacity: 0;
  cursor: ew-resize; touch-action: pan-y; }
.pair input:focus-visible + .focus { outline: 3px solid var(--link); position: absolute; inset: 0; }
.tag { position: absolute; bottom: 6px; padding: 0 .4em; line-height: 1.5; font-size: 80%;
  color: #fff; background: rgb(0 0 0 / .6); pointer-events: none; }
.tag.left { left: 6px; } .tag.right { right: 6px; }
.scale { height: 10px; background: linear-gradient(to right, #000004, #51127c, #b73779, #fc8961, #fcfdbf); }
.ends { display: flex; justify-content: space-between; font-size: 80%; color: var(--faint); }
.strip { display: grid; grid-auto-flow: column; grid-auto-columns: 240px; gap: 4px;
  overflow-x: auto; font-size: 85%; }
.origin { color: var(--faint); font-size: 90%; }
@media (max-width: 640px) { body { margin: .5rem auto; } .look { grid-template-columns: 1fr; }
  .findings { grid-template-columns: 1fr 1fr; } .findings b { font-size: 1.2rem; }
  th:first-child, td:first-child { position: sticky; left: 0; background: var(--paper); } }
)css";

const char* const kPageScript = R"js(
for (const input of document.querySelectorAll('.pair input'))
  input.addEventListener('input', () => input.parentNode.style.setProperty('--at', input.value + '%'));
)js";

}  // namespace mirage
