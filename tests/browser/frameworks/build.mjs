/**
 * Builds the pages beside this file, each as users of its framework build theirs: `node build.mjs PAGES PLAYER OUT`, in a folder
 * that holds this folder's packages. PAGES is this folder, PLAYER the npm package (dist/), OUT where the pages go.
 */

import { execFileSync } from 'node:child_process';
import { cp, mkdir, readFile, rm, symlink, writeFile } from 'node:fs/promises';
import { join, resolve } from 'node:path';
import { linker } from './linker.mjs';

const [pages, player, out] = process.argv.slice(2).map((path) => resolve(path));
const here = process.cwd();

/** What a page is built with, and the script that it begins with. */
const PAGES = {
  react: { script: 'main.jsx', plugins: async () => [] },
  vue: {
    script: 'main.js',
    plugins: async () => [(await import('@vitejs/plugin-vue')).default({ template: { compilerOptions: { isCustomElement: (tag) => tag === 'reprise-player' } } })],
  },
  svelte: { script: 'main.js', plugins: async () => [(await import('@sveltejs/vite-plugin-svelte')).svelte({ configFile: false })] },
  angular: { script: 'compiled/main.js', plugins: async () => [linker()] },
};

const html = (name, script) => `<!doctype html>
<html lang="en">
  <head>
    <meta charset="utf-8">
    <title>${name}</title>
    <link rel="icon" href="/favicon.svg">
    <script type="module" src="./${script}"></script>
  </head>
  <body><div id="app"></div></body>
</html>
`;

/** The player as npm would install it. */
async function install() {
  const link = join(here, 'node_modules/reprise-player');
  await rm(link, { force: true, recursive: true });
  await symlink(player, link);
}

async function page(name) {
  const { script, plugins } = PAGES[name];
  const root = join(here, 'pages', name);
  await rm(root, { force: true, recursive: true });
  await mkdir(root, { recursive: true });
  await cp(join(pages, name), root, { recursive: true });
  await writeFile(join(root, 'index.html'), html(name, script));
  // Templates are compiled beforehand: in the browser that would need eval.
  if (name === 'angular') execFileSync(process.execPath, [join(here, 'node_modules/@angular/compiler-cli/bundles/src/bin/ngc.js'), '-p', root], { stdio: 'inherit' });
  const { build } = await import('vite');
  await build({
    root,
    base: `/frameworks/${name}/`,
    configFile: false,
    logLevel: 'error',
    plugins: await plugins(),
    build: { outDir: join(out, name), emptyOutDir: true, target: 'es2022' },
  });
}

await install();
for (const name of Object.keys(PAGES)) {
  const start = performance.now();
  await page(name);
  console.log(`${name}: ${((performance.now() - start) / 1000).toFixed(1)} s`);
}
const { version } = JSON.parse(await readFile(join(here, 'node_modules/vite/package.json'), 'utf8'));
console.log(`with vite ${version}`);
