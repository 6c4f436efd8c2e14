/**
 * Defines `<reprise-player>`. Importing this file is all a page has to do:
 *
 *     <script type="module" src="reprise-player.js"></script>
 *     <reprise-player src="actor.reprise" controls></reprise-player>
 *
 * On a server there is no custom element registry; there the import only gives the class.
 */
import { ReprisePlayer } from './player/element.js';

if (globalThis.customElements && !customElements.get('reprise-player')) {
  customElements.define('reprise-player', ReprisePlayer);
}

export { ReprisePlayer };
