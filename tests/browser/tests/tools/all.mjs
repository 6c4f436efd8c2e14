/** The tests of the tools: with the pointer, with fingers and with the keyboard. */

import { tests as path } from './path.mjs';
import { tests as air } from './air.mjs';
import { tests as place } from './place.mjs';
import { tests as timing } from './timing.mjs';
import { tests as wander } from './wander.mjs';
import { tests as families } from './families.mjs';
import { tests as edit } from './edit.mjs';
import { tests as drive } from './drive.mjs';
import { tests as queue } from './queue.mjs';
import { tests as share } from './share.mjs';
import { tests as search } from './search.mjs';
import { tests as accessibility } from './accessibility.mjs';

export const tests = { ...path, ...air, ...place, ...timing, ...wander, ...families, ...edit, ...drive, ...queue, ...share, ...search, ...accessibility };
