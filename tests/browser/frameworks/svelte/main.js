/** Svelte 5. */

import { mount } from 'svelte';
import 'reprise-player';
import App from './App.svelte';

mount(App, { target: document.getElementById('app') });
