/** Angular's packages come half compiled: their linker does the rest, as its own build tool has it do. */

import { transformAsync } from '@babel/core';
import linkerPlugin from '@angular/compiler-cli/linker/babel';

/** A plugin for vite. */
export function linker() {
  return {
    name: 'angular-linker',
    async transform(code, id) {
      if (!id.includes('/@angular/') || !code.includes('ɵɵngDeclare')) return null;
      const linked = await transformAsync(code, { filename: id, plugins: [linkerPlugin], compact: false, configFile: false, babelrc: false });
      return { code: linked.code, map: null };
    },
  };
}
