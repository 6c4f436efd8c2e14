/** The tools: their bar, their docks under the stage, and what they put on it; the dialog of keys. */

export const toolStyles = `
:host(:not([controls])) :is(.bar .toolbar, .clips, .families) { display: none; }
.player[data-state="failed"] .toolbar, .player[data-state="loading"] .toolbar { visibility: hidden; }
.toolbar { display: flex; align-items: center; gap: 2px; margin-inline-start: auto; }
.tools { display: flex; gap: 2px; margin-inline-end: 8px; }
.tool { min-block-size: 32px; }
button:disabled { opacity: 0.38; cursor: default; }
.clips { position: absolute; inset: 8px auto auto 10px; display: flex; flex-wrap: wrap; gap: 6px; }
.clip { display: flex; border-radius: 4px; background: linear-gradient(var(--accent) 0 0) 0 100% / var(--done, 0) 2px no-repeat color-mix(in srgb, var(--surface) 80%, transparent); }
.clip .chip { color: var(--ink); }
.share { position: relative; }
.menu { position: absolute; inset: 36px 0 auto auto; display: grid; inline-size: max-content; padding: 4px; border-radius: 4px; background: var(--raised); box-shadow: 0 2px 12px rgb(0 0 0 / 0.16); }
.menu .chip { min-block-size: 32px; color: var(--ink); text-align: start; }

.player[data-state="loading"] .dock { visibility: hidden; }
.dock { padding: 10px 16px 2px; }
.dock:has(.pose-dock) { padding-block: 2px 0; padding-inline: 6px 16px; }
.tool-dock { display: grid; gap: 8px; min-inline-size: 0; }
.row { display: flex; flex-wrap: wrap; align-items: center; gap: 4px 8px; min-inline-size: 0; }
.space { flex: 1; }
.choice { display: flex; flex-wrap: wrap; gap: 2px; }
.dot { display: inline-block; inline-size: 9px; block-size: 9px; margin-inline-end: 6px; border-radius: 2px; background: var(--b); }
.b0 { --b: var(--behaviour-0); } .b1 { --b: var(--behaviour-1); } .b2 { --b: var(--behaviour-2); } .b3 { --b: var(--behaviour-3); } .b4 { --b: var(--behaviour-4); }
.outcome[data-busy] { color: var(--muted); }
.go-row { display: flex; align-items: center; gap: 12px; min-inline-size: 0; }
.outcome { flex: 1; min-inline-size: 0; margin: 0; color: var(--ink); }
.go { padding: 6px 18px; margin-inline-start: auto; }
.field { display: flex; align-items: center; gap: 6px; color: var(--muted); }
.field input { inline-size: 64px; padding: 4px 6px; border: 1px solid var(--line); border-radius: 4px; background: none; color: var(--ink); font: inherit; font-variant-numeric: tabular-nums; }
.field select { max-inline-size: 120px; padding: 4px 6px; border: 1px solid var(--line); border-radius: 4px; background: none; color: var(--ink); font: inherit; }
.field option { background: var(--raised); }

.path-dock .field span:first-child { display: none; }

.path-strip { position: relative; block-size: 44px; margin-block-end: 18px; border-radius: 4px; background: var(--strip); touch-action: pan-y; cursor: crosshair; }
.path-strip canvas { position: absolute; inset: 0; border-radius: 4px; pointer-events: none; }
.painted span {
  position: absolute;
  inset-block: 0;
  padding: 2px 6px;
  border-radius: 4px;
  border-block-end: 4px solid var(--b);
  background: color-mix(in srgb, var(--b) 24%, var(--surface));
  font-size: 12px;
  overflow: hidden;
  text-overflow: ellipsis;
  white-space: nowrap;
  pointer-events: none;
}
.brush-mark { position: absolute; inset: -2px auto -2px 0; inline-size: 2px; margin-inline-start: -1px; background: var(--accent); opacity: 0; pointer-events: none; }
.path-strip:focus-visible .brush-mark, .path-strip:hover .brush-mark { opacity: 1; }
.scale { position: absolute; inset: 100% 0 auto; block-size: 16px; color: var(--muted); font-size: 11px; pointer-events: none; }
.scale span { position: absolute; inset-block-start: 2px; translate: -50%; white-space: nowrap; }
.scale span:first-child { translate: 0; }
.scale span::before { content: ""; position: absolute; inset: -4px auto auto 50%; inline-size: 1px; block-size: 4px; background: var(--line); }
.scale span:first-child::before { inset-inline-start: 0; }

.ruler { position: relative; block-size: 52px; margin: 2px 12px 18px; border-radius: 4px; background: var(--strip); }
.lane { position: absolute; inset: 0; }
.key-pose { position: absolute; inset-block-start: 2px; inline-size: 36px; block-size: 48px; margin-inline-start: -18px; padding: 0; border: 0; border-radius: 4px; background: none; cursor: ew-resize; touch-action: none; }
.key-pose::after { content: ""; position: absolute; inset: auto auto -6px 50%; inline-size: 2px; margin-inline-start: -1px; block-size: 8px; background: var(--accent); }
.key-pose canvas, .pose canvas, .ruler .shadow { display: block; inline-size: 36px; block-size: 48px; pointer-events: none; }
.key-pose:hover, .key-pose:focus-visible { background: color-mix(in srgb, var(--accent) 16%, transparent); z-index: 1; }
.ruler .shadow { position: absolute; inset-block-start: 2px; margin-inline-start: -18px; opacity: 0.55; }
.marks span { position: absolute; inset-block: auto 0; block-size: 4px; min-inline-size: 3px; border-radius: 2px; background: var(--synthetic); }
.marks span[data-late="false"] { background: var(--recorded); }
.shelf { display: flex; align-items: center; gap: 12px; overflow: auto hidden; scrollbar-width: thin; scrollbar-color: var(--line) transparent; }
.shelf-part { display: flex; align-items: center; flex: none; }
.shelf .label { margin: 0; padding-inline-end: 6px; }
.pose { flex: none; padding: 0; border: 0; border-radius: 4px; background: none; cursor: grab; touch-action: pan-x; }
.pose:hover { background: color-mix(in srgb, var(--ink) 8%, transparent); }
.timing-dock { grid-template-columns: minmax(0, 1fr) auto; }
.times { grid-area: 1 / 2 / 3; max-block-size: 132px; padding-inline: 12px 2px; overflow: auto; scrollbar-width: thin; font-size: 12px; }
.times table { min-inline-size: 232px; border-spacing: 0; }
.times th { position: sticky; inset-block-start: 0; background: var(--surface); }
.timing-dock .ruler, .timing-dock .shelf { grid-column: 1; }
.timing-dock .outcome[data-busy] { color: var(--muted); }
.pose-dock { display: flex; align-items: center; gap: 4px 8px; min-block-size: 32px; }
.pose-dock > .choice { flex: 0 1 auto; flex-wrap: nowrap; min-inline-size: 0; overflow: auto hidden; scrollbar-width: none; }
.pose-dock .chip { flex: none; }
.pose-dock .field { margin-inline-start: auto; }
.pose-dock [role="toolbar"]:empty ~ * { visibility: hidden; }
.queue:empty, .families:empty { display: none; }
.families { display: flex; flex: none; flex-wrap: wrap; gap: 4px 12px; }
.families.on-stage { position: absolute; inset: auto auto 44px 16px; }
.family output { min-inline-size: 60px; }
.family[data-performed] { color: var(--ink); }
.waits::before { content: "›"; margin-inline-end: 6px; color: var(--muted); }
.waits { color: var(--ink); cursor: grab; touch-action: pan-x; }
.waits[data-held] { background: color-mix(in srgb, var(--accent) 16%, transparent); }
.waits::after { content: "×"; margin-inline-start: 6px; color: var(--muted); }
.go-row { grid-column: 1 / -1; }
.times th { color: var(--muted); font-weight: 400; }
.times th, .times td { padding: 1px 0 1px 16px; text-align: end; }
.times th:first-child, .times td:first-child { padding-inline-start: 0; text-align: start; }

.weights { display: grid; grid-template-columns: repeat(auto-fill, minmax(250px, 1fr)); gap: 4px 24px; max-block-size: 120px; overflow: auto; }
.weight { display: grid; grid-template-columns: 84px 1fr 44px; align-items: center; gap: 8px; }
.weight span { overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
.weight input { accent-color: var(--accent); min-inline-size: 0; margin: 0; }
.exact { display: flex; align-items: center; gap: 8px; color: var(--muted); }
.toolbar .exact { margin-inline: 8px 6px; }
.exact input { accent-color: var(--accent); inline-size: 72px; margin: 0; }
.weight output { color: var(--muted); text-align: end; }

.handle { position: absolute; inset: 0 auto auto 0; inline-size: 28px; block-size: 28px; margin: -14px; padding: 0; border: 0; border-radius: 50%; background: none; pointer-events: auto; cursor: move; touch-action: none; }
.handle::before { content: ""; position: absolute; inset: 8px; border: 2px solid var(--accent); border-radius: 50%; background: var(--surface); }
.handle:hover::before, .handle:focus-visible::before { inset: 6px; background: var(--accent); }
.handles[data-brush] .handle { pointer-events: none; opacity: 0.5; }
.handle.turn::before { border-radius: 2px; rotate: 45deg; inset: 9px; }
.handle.chosen::before { background: var(--accent); }
.part-mark { position: absolute; inset: 0 auto auto 0; inline-size: 18px; block-size: 18px; margin: -9px; border: 2px solid var(--accent); border-radius: 50%; box-shadow: 0 0 0 1px var(--surface); }
.part-mark[data-picking] { border-radius: 0; border-color: transparent; background: linear-gradient(var(--accent) 0 0) 50% / 2px 100% no-repeat, linear-gradient(var(--accent) 0 0) 50% / 100% 2px no-repeat; box-shadow: none; }
.air { position: absolute; inset: 0; inline-size: 100%; block-size: 100%; fill: none; }
.air .posts { stroke: var(--muted); stroke-width: 1; stroke-dasharray: 3 3; }
.air .taken { stroke: var(--ink); stroke-width: 1.5; opacity: 0.6; }
.air .wanted { stroke: var(--accent); stroke-width: 3; opacity: 0.9; }
.ground-labels { position: absolute; inset: 0; }
.ground-label { position: absolute; inset: 0 auto auto 0; padding: 0 6px; border-radius: 3px; background: color-mix(in srgb, var(--b) 22%, var(--surface)); border-inline-start: 4px solid var(--b); font-size: 12px; margin: 10px 0 0 -20px; white-space: nowrap; }
.view[data-drawing] { cursor: crosshair; }
.view[data-tool="place"] { cursor: crosshair; }

.edit-marks { position: absolute; inset: 0; }
.pin { position: absolute; inset: 0 auto auto 0; inline-size: 28px; block-size: 28px; margin: -14px; padding: 0; border: 0; background: none; pointer-events: auto; cursor: pointer; }
.pin::before { content: ""; position: absolute; inset: 7px; border: 2px solid var(--accent); border-radius: 50% 50% 50% 0; rotate: -45deg; background: var(--surface); }
.pin[aria-pressed="true"]::before { background: var(--accent); }
.pin:hover::before, .pin:focus-visible::before { inset: 5px; }
.view[data-over-actor] { cursor: grab; }
.edits { flex: 0 1 auto; flex-wrap: nowrap; min-inline-size: 0; overflow: auto hidden; scrollbar-width: none; }
.edits .chip { flex: none; }
.edits .off { text-decoration: line-through; }
.edit-ruler { block-size: 32px; }
.edit-ruler .lane { cursor: text; touch-action: pan-y; }
.edit-bars span { position: absolute; inset-block: 8px; border-radius: 4px; background: color-mix(in srgb, var(--accent) 22%, transparent); pointer-events: none; }
.edit-bars span[data-chosen] { background: color-mix(in srgb, var(--accent) 44%, transparent); }
.edit-bars span[data-off] { background: color-mix(in srgb, var(--muted) 22%, transparent); }
.edit-bars i { position: absolute; inset-block: -4px; inline-size: 2px; margin-inline-start: -1px; background: var(--accent); }
.edit-end { position: absolute; inset-block: 0; inline-size: 16px; margin-inline-start: -8px; padding: 0; border: 0; background: none; cursor: ew-resize; touch-action: none; }
.edit-end::before { content: ""; position: absolute; inset: 6px 5px; border-radius: 3px; background: var(--accent); }
.edit-end.key::before { inset: 11px 3px; border-radius: 2px; rotate: 45deg; }
.edit-end:hover::before, .edit-end:focus-visible::before { outline: 2px solid var(--surface); }
.edit-ruler .playhead { opacity: 1; background: var(--ink); }

.keys {
  inline-size: min(460px, calc(100vw - 32px));
  max-block-size: calc(100vh - 32px);
  padding: 16px 24px 24px;
  border: 0;
  border-radius: 4px;
  background: var(--raised);
  color: var(--ink);
  font: inherit;
}
.keys::backdrop { background: rgb(0 0 0 / 0.32); }
.keys header { margin-block-end: 8px; display: flex; justify-content: space-between; align-items: center; }
.keys h2 { margin: 0; font-size: 17px; }
.keys h3 { margin: 18px 0 6px; font-size: 13px; color: var(--muted); font-weight: 400; }
.keys dl { margin: 0; display: grid; gap: 6px; }
.keys dl > div { display: grid; grid-template-columns: 104px 1fr; gap: 12px; }
.keys dd { margin: 0; }
.keys kbd { font: inherit; font-weight: 600; }
@media (width >= 900px) {
  .keys { inline-size: 840px; columns: 2; column-gap: 40px; }
  .keys header { column-span: all; }
  .keys dl { break-inside: avoid; }
  .keys h3 { break-after: avoid; }
}

@media (pointer: coarse) {
  .handle { inline-size: 44px; block-size: 44px; margin: -22px; }
  .handle::before, .handle.turn::before { inset: 15px; }
  .handle:hover::before, .handle:focus-visible::before { inset: 13px; }
}
@container player (width < 640px) {
  .bar { flex-wrap: wrap; gap: 0; padding-inline: 12px 4px; }
  .toolbar { inline-size: 100%; gap: 0; }
  .tools { flex: 1; gap: 0; margin: 0; }
  .tool { min-block-size: 40px; padding: 0 7px; }
  .toolbar .round { inline-size: 34px; }
  .toolbar .exact { display: none; }
  .go-row { position: sticky; inset-block-end: 0; background: var(--surface); }
  .go-row:has(> :nth-child(3)) { flex-wrap: wrap; gap: 8px; }
  .go-row:has(> :nth-child(3)) .outcome { order: -1; flex-basis: 100%; }
  .pose-dock { flex-wrap: wrap; gap: 0 4px; }
  .pose-dock .choice:first-child { flex-basis: 100%; }
  .pose-dock .field { margin: 0; padding-inline-start: 10px; }
  .pose-dock .queue { flex: 1; }
  .row { gap: 0 4px; }
  .row .chip { padding: 0 8px; }
  .row > .choice { flex-basis: 100%; }
  .field { gap: 4px; }
  .field input { inline-size: 54px; }
  .dock:has(.pose-dock) { padding-inline: 2px 8px; }
  .dock { padding: 8px 12px 0; max-block-size: 46cqh; overflow: auto; }
  .score[data-closed] .dock { display: none; }
  .choice { flex-wrap: nowrap; overflow: auto; max-inline-size: 100%; scrollbar-width: none; }
  .choice .chip { flex: none; }
  .space { display: none; }
  .timing-dock { grid-template-columns: minmax(0, 1fr); }
  .times { grid-area: auto; max-block-size: 96px; padding: 0; }
  .times table { inline-size: 100%; }
  .weights { max-block-size: 200px; }
  .weight { min-block-size: 36px; }
}
@container player (width < 380px) {
  .tool { padding: 0 4px; }
  .toolbar .round { inline-size: 31px; }
}
`;
