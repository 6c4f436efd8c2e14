/** Colours and sizes, light and dark, as custom properties that a page may override on the element. */

const light = `
  --background: var(--reprise-background, #f4f3f1);
  --surface: #fcfbfa;
  --raised: #ffffff;
  --ink: #201f1d;
  --muted: #68655f;
  --line: #dedbd6;
  --strip: #ebe9e5;
  --blank: #d9d6d0;
  --arc: #8d8983;
  --accent: var(--reprise-accent, #3558c4);
  --recorded: #1d7f4e;
  --synthetic: #c5382c;
  --behaviour-0: #6a55c2;
  --behaviour-1: #a86a00;
  --behaviour-2: #14788f;
  --behaviour-3: #b0407f;
  --behaviour-4: #5d6b74;
`;

const dark = `
  --background: var(--reprise-background, #161617);
  --surface: #1c1c1e;
  --raised: #29292c;
  --ink: #eeedea;
  --muted: #a19e98;
  --line: #343437;
  --strip: #252528;
  --blank: #38383c;
  --arc: #807d78;
  --accent: var(--reprise-accent, #93abff);
  --recorded: #4cc389;
  --synthetic: #ff7a6b;
  --behaviour-0: #a797f2;
  --behaviour-1: #e0a94a;
  --behaviour-2: #56b9cf;
  --behaviour-3: #e889bd;
  --behaviour-4: #9fb0ba;
`;

export const tokens = `
:host { ${light} color-scheme: light; }
@media (prefers-color-scheme: dark) { :host(:not([theme="light"])) { ${dark} color-scheme: dark; } }
:host([theme="dark"]) { ${dark} color-scheme: dark; }

:host {
  display: block;
  position: relative;
  contain: content;
  inline-size: 100%;
  block-size: 100%;
  min-block-size: 360px;
  background: var(--background);
  color: var(--ink);
  font: 13px/1.4 var(--reprise-font, system-ui, -apple-system, "Segoe UI", Roboto, sans-serif);
  -webkit-tap-highlight-color: transparent;
}
:host([hidden]), [hidden] { display: none !important; }
*, *::before, *::after { box-sizing: border-box; }

.unseen { position: absolute; inline-size: 1px; block-size: 1px; overflow: hidden; clip-path: inset(50%); white-space: nowrap; }
.time, .figures, dd, .tooltip, .status { font-variant-numeric: tabular-nums; }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }

button, select { font: inherit; color: inherit; }
.round {
  flex: none;
  display: grid;
  place-items: center;
  inline-size: 32px;
  block-size: 32px;
  padding: 0;
  border: 0;
  border-radius: 4px;
  background: none;
  cursor: pointer;
}
.round:hover, .speed:hover { background: color-mix(in srgb, var(--ink) 8%, transparent); }
.round[aria-pressed="true"] { color: var(--accent); }
.button {
  padding: 8px 16px;
  border: 0;
  border-radius: 4px;
  background: var(--accent);
  color: var(--raised);
  font-weight: 600;
  cursor: pointer;
}
.button:hover { filter: brightness(1.08); }
`;
