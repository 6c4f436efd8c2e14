/** The bar, the stage and what lies on it: chips, facts, progress, errors, tooltip. */

export const stageStyles = `
.player {
  position: absolute;
  inset: 0;
  display: grid;
  grid-template: auto minmax(0, 1fr) auto / minmax(0, 1fr);
  container: player / size;
  overflow: hidden;
}
.bar { position: relative; z-index: 3; display: flex; align-items: center; gap: 12px; min-block-size: 40px; padding-inline: 16px 8px; }
:host(:not([controls])) .bar { min-block-size: 0; }
.bar ::slotted(*) { min-inline-size: 0; }
.stage { position: relative; min-block-size: 0; overflow: hidden; }
.handles { position: absolute; inset: 0; overflow: hidden; pointer-events: none; }
:host(:not([controls])) .handles { display: none; }
.view { position: absolute; inset: 0; touch-action: none; user-select: none; -webkit-user-select: none; cursor: grab; }
.view:active { cursor: grabbing; }
.view[data-over-ghost] { cursor: pointer; }
.view:focus-visible { outline-offset: -2px; }
.view canvas { position: absolute; inset: 0; inline-size: 100%; block-size: 100%; opacity: 0; transition: opacity 180ms; pointer-events: none; }
.view[data-shown] canvas { opacity: 1; }
.poster { position: absolute; inset: 0; inline-size: 100%; block-size: 100%; object-fit: contain; }

slot[name="poster"], slot[name="progress"], slot[name="error"] { display: contents; }
.player[data-state="shown"] ::slotted([slot="poster"]),
.player:not(:has(.progress:not([hidden]))) ::slotted([slot="progress"]),
.player:not(:has(.error:not([hidden]))) ::slotted([slot="error"]) { display: none !important; }
::slotted([slot="poster"]) { position: absolute; inset: 0; inline-size: 100%; block-size: 100%; object-fit: contain; }

.chips { position: absolute; inset-block-end: 12px; display: flex; gap: 4px; }
.chips.left { inset-inline-start: 12px; }
.chips.right { inset-inline-end: 12px; }
.chip, .tool {
  min-block-size: 28px;
  padding: 0 10px;
  border: 0;
  border-radius: 4px;
  background: none;
  color: var(--muted);
  cursor: pointer;
}
.chip:hover, .tool:hover { color: var(--ink); background: color-mix(in srgb, var(--ink) 7%, transparent); }
:is(.chip, .tool):is([aria-pressed="true"], [aria-expanded="true"], [aria-checked="true"]) { color: var(--accent); background: color-mix(in srgb, var(--accent) 11%, transparent); }
.choices { position: absolute; inset-inline-end: 12px; inset-block-end: 48px; display: grid; padding: 4px; border-radius: 4px; background: color-mix(in srgb, var(--surface) 90%, transparent); }
.choices .chip { text-align: start; }

.legend { position: absolute; inset-inline-end: 12px; inset-block-start: 12px; display: grid; gap: 2px; margin: 0; padding: 8px 12px; border-radius: 4px; background: color-mix(in srgb, var(--surface) 90%, transparent); list-style: none; pointer-events: none; }
.legend li { display: flex; align-items: center; gap: 8px; }
.swatch { inline-size: 10px; block-size: 10px; border-radius: 2px; }

.facts {
  position: absolute;
  inset-inline-start: 12px;
  inset-block-end: 48px;
  max-block-size: calc(100% - 60px);
  overflow: auto;
  padding: 10px 14px 12px;
  border-radius: 4px;
  background: color-mix(in srgb, var(--surface) 90%, transparent);
}
.facts dl { margin: 0; display: grid; gap: 2px; }
.facts .group { margin-block: 8px 2px; color: var(--muted); font-size: 12px; }
.facts .group:first-child { margin-block-start: 0; }
.facts dl > div:not(.group) { display: grid; grid-template-columns: 112px auto; gap: 12px; }
.facts dt { color: var(--muted); }
.facts dd { margin: 0; }

.progress { position: absolute; inset-inline: 0; inset-block-end: 0; pointer-events: none; }
.progress .rail { block-size: 2px; background: var(--line); overflow: hidden; }
.progress .bar { block-size: 100%; background: var(--accent); transition: inline-size 120ms linear; }
.progress[data-unknown] .bar { inline-size: 30% !important; animation: wander 1.2s ease-in-out infinite alternate; }
@keyframes wander { from { transform: translateX(0); } to { transform: translateX(233%); } }
.progress .figures { position: absolute; inset-block-end: 14px; inset-inline: 0; text-align: center; color: var(--muted); }

.error {
  position: absolute;
  inset: 0;
  display: grid;
  align-content: center;
  justify-items: center;
  padding: 24px;
  text-align: center;
  background: var(--background);
}
.error[data-over] {
  inset: auto 0 52px;
  grid-template: "happened button" auto "todo button" auto / 1fr auto;
  justify-items: start;
  column-gap: 24px;
  inline-size: fit-content;
  max-inline-size: calc(100% - 32px);
  margin-inline: auto;
  padding: 12px 16px;
  border-radius: 4px;
  text-align: start;
  background: color-mix(in srgb, var(--surface) 94%, transparent);
}
.error .icon { inline-size: 72px; block-size: 72px; margin-block-end: 16px; color: var(--muted); opacity: 0.6; }
.error .icon path { stroke-dasharray: 0.8 1.5; }
.error[data-over] .icon { display: none; }
.error p { margin: 0; max-inline-size: 44ch; text-wrap: balance; }
.error .happened { font-size: 17px; font-weight: 600; }
.error .todo { margin-block: 6px 18px; color: var(--muted); font-size: 14px; }
.error[data-over] .happened { font-size: 14px; }
.error[data-over] .todo { margin: 0; font-size: 13px; }
.error[data-over] .button { grid-area: button; align-self: center; }

.tooltip {
  position: absolute;
  inset: 0 auto auto 0;
  z-index: 2;
  display: grid;
  max-inline-size: calc(100% - 16px);
  padding: 5px 10px 6px;
  border-radius: 4px;
  background: var(--ink);
  color: var(--background);
  pointer-events: none;
  white-space: nowrap;
}
.tooltip strong { font-weight: 600; }
.tooltip span { opacity: 0.82; }

@container player (width < 640px) {
  .facts { font-size: 12px; inset-inline: 8px; inset-block-end: 48px; max-block-size: 62%; }
  .chips { inset-block-end: 8px; }
  .chips.left { inset-inline-start: 4px; }
  .chips.right { inset-inline-end: 4px; }
  .chip { min-block-size: 36px; }
}
@media (prefers-reduced-motion: reduce) {
  *, *::before, *::after { animation: none !important; transition: none !important; }
}
`;
