/** Vue: the compiler is told which elements are not its own (`isCustomElement`). */

import { createApp } from 'vue';
import 'reprise-player';
import App from './App.vue';

createApp(App).mount('#app');
