/**
 * What a page's main thread does, turn by turn: how long each took by the clock, and how much of that the thread itself ran.
 * The two differ where other threads have the processor, as those that draw in software do.
 */

const CATEGORIES = ['toplevel', 'devtools.timeline'];

/**
 * Milliseconds of every turn of the main thread while `work` is going on, the longest by its own time first.
 * @param {import('playwright-core').Browser} chromium
 * @param {import('playwright-core').Page} page
 * @param {() => Promise<void>} work
 * @returns {Promise<{own: number, clock: number}[]>}
 */
export async function turnsDuring(chromium, page, work) {
  await chromium.startTracing(page, { categories: CATEGORIES });
  await work();
  const { traceEvents } = JSON.parse(await chromium.stopTracing());
  const thread = ({ pid, tid }) => `${pid} ${tid}`;
  const mains = new Set(traceEvents.filter(({ name, args }) => name === 'thread_name' && args.name === 'CrRendererMain').map(thread));
  const turns = traceEvents.filter((event) => event.name === 'ThreadControllerImpl::RunTask' && mains.has(thread(event)) && event.tdur >= 0);
  return turns.map(({ tdur, dur }) => ({ own: tdur / 1000, clock: dur / 1000 })).sort((a, b) => b.own - a.own);
}
