/** The score and the transport under it. The first tool's dock has room before it is there, so that nothing jumps when it comes. */

export const scoreStyles = `
.score { position: relative; background: var(--surface); }
.player[data-state="loading"] .transport, .player[data-state="loading"] .chips { visibility: hidden; }
.player[data-state="failed"] .score, .player[data-state="failed"] .chips { display: none; }
:host(:not([controls])) .score, :host(:not([controls])) .chips { display: none; }
.dock:empty { block-size: 34px; }

.strips {
  position: relative;
  max-block-size: max(148px, 24cqh);
  padding-inline: 16px;
  overflow: hidden auto;
  overscroll-behavior: contain;
  scroll-padding-block: 28px 10px;
  scrollbar-width: thin;
  scrollbar-color: var(--line) transparent;
}
.sheet { position: relative; min-block-size: 144px; touch-action: pan-y; user-select: none; -webkit-user-select: none; cursor: pointer; }
.sheet > * { position: absolute; inset: 0 auto auto 0; }
.blank { block-size: 48px; inline-size: 100%; border-radius: 4px; background: var(--strip); opacity: 0.6; }
.blank:first-child { inset-block-start: 22px; }
.blank:last-child { inset-block-start: 92px; inline-size: 78%; }

.label {
  block-size: 18px;
  margin-block-start: 15px;
  line-height: 18px;
  font-size: 12px;
  color: var(--muted);
  background: color-mix(in srgb, var(--surface) 84%, transparent);
  overflow: hidden;
  text-overflow: ellipsis;
  white-space: nowrap;
  pointer-events: none;
}
.strip { border-radius: 4px; background: var(--strip); }
.strip canvas { display: block; pointer-events: none; }
.strip:focus-visible { outline-offset: 1px; }
.graph, .walk { pointer-events: none; }

.cursor { inline-size: 0; block-size: 48px; pointer-events: none; }
.cursor::before { content: ""; position: absolute; inset: 0 -18px; border-radius: 4px; background: color-mix(in srgb, var(--ink) 9%, transparent); }
.cursor::after { content: ""; position: absolute; inset: 0 -0.75px; background: var(--ink); }

.playhead { inline-size: 0; block-size: 48px; pointer-events: none; }
.playhead::before { content: ""; position: absolute; inset: -2px -1px; border-radius: 1px; background: var(--accent); }
.playhead .grip {
  position: absolute;
  inset: -13px -12px auto;
  block-size: 22px;
  touch-action: none;
  pointer-events: auto;
  cursor: ew-resize;
}
.playhead .grip::before {
  content: "";
  position: absolute;
  inset: 6px 7px auto;
  block-size: 7px;
  background: var(--accent);
  clip-path: polygon(0 0, 100% 0, 50% 100%);
}

.flag { inline-size: 0; block-size: 0; color: var(--accent); pointer-events: none; }
.flag .icon { position: absolute; inset-block-start: -17px; inset-inline-start: -3.5px; inline-size: 18px; block-size: 18px; }
.flag::after { content: ""; position: absolute; inset: -3px auto auto -0.5px; inline-size: 1.4px; block-size: 51px; background: currentColor; }
.flag[data-arrived] .icon { inset-block-start: -19px; inset-inline-start: -9px; animation: settle 180ms ease-out; }
.flag[data-arrived]::after { display: none; }
@keyframes settle { from { transform: scale(0.4); opacity: 0; } }

.transport { display: flex; align-items: center; gap: 4px; block-size: 40px; padding-inline: 10px 16px; }
.where { display: flex; align-items: baseline; gap: 8px; min-inline-size: 150px; padding-inline: 4px; white-space: nowrap; }
.where .name { color: var(--muted); overflow: hidden; text-overflow: ellipsis; }
.speed { field-sizing: content; block-size: 28px; padding: 0 4px; border: 0; border-radius: 4px; background: none; cursor: pointer; }
.speed option { background: var(--raised); }
.status { flex: 1; min-inline-size: 0; padding-inline: 12px; color: var(--muted); text-align: end; overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
.status[data-kind="going"], .status[data-kind="arrived"] { color: var(--ink); }
.drawer { display: none; }

.walk-bar { position: relative; flex: none; inline-size: clamp(140px, 28cqw, 380px); block-size: 16px; }
.walk-bar .legs { position: absolute; inset: 5px 0; display: flex; gap: 1px; border-radius: 3px; overflow: hidden; }
.leg { flex: 1 1 0; min-inline-size: 2px; }
.leg.recorded { background: var(--recorded); }
.leg.synthetic {
  background: repeating-linear-gradient(-55deg, var(--synthetic) 0 3px, color-mix(in srgb, var(--synthetic) 25%, var(--surface)) 3px 5.5px);
}
.walk-bar .mark { position: absolute; inset-block: 0; inline-size: 3px; margin-inline-start: -1.5px; border-radius: 1.5px; background: var(--ink); box-shadow: 0 0 0 1.5px var(--surface); }

@container player (width < 640px) {
  .strips { max-block-size: 32cqh; padding-inline: 12px; }
  .score[data-closed] .strips { display: none; }
  .drawer { display: grid; transition: transform 180ms; }
  .score[data-closed] .drawer { transform: rotate(180deg); }
  .transport { block-size: auto; display: grid; grid-template: "play where speed loop drawer" 48px "status status status status status" auto / auto 1fr auto auto auto; padding-inline: 8px; }
  .where { min-inline-size: 0; }
  .status { grid-area: status; padding: 0 8px 10px; text-align: start; min-block-size: 28px; }
  .score:not(:has(.pose-dock)) .status:empty { display: none; }
  .walk-bar { position: absolute; inset: -8px 0 auto; inline-size: 100%; }
  .walk-bar .legs { border-radius: 0; }
  .round { inline-size: 40px; block-size: 40px; }
}
`;
