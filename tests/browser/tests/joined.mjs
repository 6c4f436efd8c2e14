/**
 * The scripts in dist/ against the modules that they are joined from, by their syntax trees: every module is there once, with
 * the same statements, bound to the same names of the same modules. So neither joining nor stripping changes a meaning.
 */

import assert from 'node:assert/strict';
import { readFile, readdir } from 'node:fs/promises';
import { dirname, join, relative, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parse } from 'acorn';
import { dist } from '../browser.mjs';

const www = fileURLToPath(new URL('../../../www/', import.meta.url));
const [ENTRY, LATER] = ['reprise-player.js', 'reprise-tools.js'];

const parsed = (text) => parse(text, { ecmaVersion: 'latest', sourceType: 'module' }).body;
const read = async (path) => parsed(await readFile(path, 'utf8'));

/** A syntax tree without the places of its nodes, to be compared. */
function tree(node) {
  return JSON.parse(JSON.stringify(node, (key, value) => {
    if (typeof value === 'bigint') return `${value}n`;
    if (value instanceof RegExp) return String(value);
    // How a literal is written (quotes) is part of it; where is not.
    return key === 'start' || key === 'end' ? undefined : value;
  }));
}

/** The modules of `www/` by their paths from there, entry and all: what they import, what they export, what else they do. */
async function sources() {
  const modules = new Map();
  const add = async (path) => {
    if (modules.has(path)) return;
    const module = { imports: [], exports: [], statements: [] };
    modules.set(path, module);
    for (const statement of await read(join(www, path))) {
      const from = statement.source && relative(www, resolve(www, dirname(path), statement.source.value));
      if (statement.type === 'ImportDeclaration') {
        for (const { type, imported, local } of statement.specifiers) assert.ok(type === 'ImportSpecifier' && imported.name === local.name, path);
        module.imports.push({ from, names: statement.specifiers.map(({ local }) => local.name) });
      } else if (statement.type === 'ExportNamedDeclaration') {
        assert.equal(statement.source, null, path);
        const { declaration } = statement;
        if (declaration) module.statements.push(tree(declaration));
        const declared = declaration?.declarations ?? (declaration ? [declaration] : []);
        module.exports.push(...declared.map(({ id }) => id.name), ...statement.specifiers.map(({ local }) => local.name));
      } else {
        assert.doesNotMatch(statement.type, /^(Import|Export)/, path);
        module.statements.push(tree(statement));
      }
    }
    for (const { from } of module.imports) await add(from);
  };
  await add(ENTRY);
  await add('player/tools/tools.js');
  return modules;
}

/** What a joined module does: `const m3=(()=>{const{a}=m1; ... return{b};})();` */
function joinedModule(statement) {
  const [{ id, init }] = statement.declarations;
  const { body } = init.callee.body;
  return { id: id.name, ...split(body) };
}

/** The imports (`const{a}=m1;`) that statements begin with, the names that they return or export, and the rest. */
function split(body) {
  const imports = [];
  let at = 0;
  for (; body[at]?.declarations?.[0].id.type === 'ObjectPattern' && /^m\d+$/.test(body[at].declarations[0].init?.name ?? ''); at += 1) {
    const [{ id, init }] = body[at].declarations;
    for (const { key, value } of id.properties) assert.equal(key.name, value.name);
    imports.push({ from: init.name, names: id.properties.map(({ key }) => key.name) });
  }
  const end = body.at(-1);
  const exports = end.type === 'ReturnStatement' ? end.argument.properties.map(({ key }) => key.name) : end.specifiers.map(({ local }) => local.name);
  return { imports, exports, statements: body.slice(at, -1) };
}

/** Undoes what joining does to paths: they start at the folder, and the tools' script is called with the modules that it takes. */
function unbound(statements, path) {
  const back = (target) => {
    const from = relative(dirname(path), target);
    return from.startsWith('.') ? from : `./${from}`;
  };
  return JSON.parse(JSON.stringify(tree(statements)), (_, node) => {
    if (node?.type === 'ImportExpression') return { ...node, source: literal(back(node.source.value)) };
    if (node?.type === 'NewExpression' && node.callee.name === 'URL' && node.arguments[1]?.object?.type === 'MetaProperty') {
      return { ...node, arguments: [literal(back(node.arguments[0].value)), node.arguments[1]] };
    }
    const awaited = node?.type === 'CallExpression' && node.callee.type === 'MemberExpression' && node.callee.object.type === 'AwaitExpression' && node.callee.object.argument;
    if (awaited?.type === 'ImportExpression' && awaited.source.value.endsWith(LATER)) {
      return { ...node.callee.object, argument: { ...awaited, source: literal(back('player/tools/tools.js')) } };
    }
    return node;
  });
}

/** The style sheets that statements declare: templates whose names say so. Expressions in them stand for any value. */
function sheets(statements) {
  const found = [];
  for (const { declarations } of statements) {
    for (const { id, init } of declarations ?? []) {
      if (!id.name?.endsWith('Styles') || init?.type !== 'TemplateLiteral') continue;
      found.push([id.name, init.quasis.map(({ value }) => value.cooked).join('0')]);
    }
  }
  return found;
}

/** Statements whose style sheets have no white space, nor semicolons that nothing follows: what that changes is looked at apart. */
function packed(statements) {
  const pack = (text) => text.replace(/\s+/g, '').replaceAll(';}', '}');
  return JSON.parse(JSON.stringify(statements), (key, node) => {
    if (node?.type !== 'VariableDeclarator' || !node.id.name?.endsWith('Styles') || node.init?.type !== 'TemplateLiteral') return node;
    const quasis = node.init.quasis.map((quasi) => ({ ...quasi, value: { cooked: pack(quasi.value.cooked), raw: pack(quasi.value.raw) } }));
    return { ...node, init: { ...node.init, quasis } };
  });
}

/** The rules of style sheets, as the browser understands them. */
const rules = (browser, texts) => onAPage(browser, (page) => page.evaluate((all) => all.map((text) => {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(text);
  // Values that hold variables are kept as they were written.
  return [...sheet.cssRules].map(({ cssText }) => cssText.replace(/,\s+/g, ','));
}), texts));

async function onAPage(browser, look) {
  const page = await browser.chromium.newPage();
  try {
    return await look(page);
  } finally {
    await page.close();
  }
}

const literal = (value) => ({ type: 'Literal', value, raw: `'${value}'` });

export const tests = {
  'the joined scripts are the modules, each once': async (browser) => {
    const modules = await sources();
    const first = await read(join(dist, ENTRY));
    const [later] = await read(join(dist, LATER));
    const [{ id: stamp, init: tools }] = later.declaration.declarations;
    const isModule = (statement) => /^m\d+$/.test(statement.declarations?.[0].id.name ?? '');
    const all = [...first.filter(isModule), ...tools.body.body.filter(isModule)].map(joinedModule);
    const own = split(first.filter((statement) => !isModule(statement)));

    // Which of them is which: by what they import, in the order in which they are evaluated.
    const numbers = new Map();
    const number = (path) => {
      if (numbers.has(path)) return;
      for (const { from } of modules.get(path).imports) number(from);
      if (path !== ENTRY) numbers.set(path, `m${numbers.size}`);
    };
    number(ENTRY);
    const atOnce = numbers.size;
    number('player/tools/tools.js');
    assert.deepEqual(all.map(({ id }) => id), [...numbers.values()]);
    assert.equal(first.filter(isModule).length, atOnce);

    const [styles, stripped] = [[], []];
    for (const [path, { imports, exports, statements }] of modules) {
      const joined = path === ENTRY ? own : all.find(({ id }) => id === numbers.get(path));
      const bound = imports.filter(({ names }) => names.length > 0).map(({ from, names }) => ({ from: numbers.get(from), names }));
      assert.deepEqual(joined.imports, bound, `what ${path} imports`);
      assert.deepEqual(joined.exports, exports, `what ${path} exports`);
      const does = unbound(joined.statements, path);
      assert.deepEqual(packed(does), packed(statements), `what ${path} does`);
      styles.push(...sheets(statements));
      stripped.push(...sheets(does));
    }
    assert.ok(styles.length > 2, 'there are style sheets');
    const [meant, made] = [await rules(browser, styles.map(([, text]) => text)), await rules(browser, stripped.map(([, text]) => text))];
    styles.forEach(([name], at) => assert.deepEqual(made[at], meant[at], `the rules of ${name}`));
    assert.ok(meant.every((one) => one.length > 0));

    // The tools are handed what they use of the first script, and by a name that only scripts of one build have.
    const used = new Set(all.slice(atOnce).flatMap(({ imports }) => imports.map(({ from }) => from)).filter((from) => Number(from.slice(1)) < atOnce));
    const taken = tools.params.map(({ name }) => name);
    assert.deepEqual([...taken].sort(), [...used].sort());
    const call = `(await import('./${LATER}')).${stamp.name}(${taken.join(',')})`;
    assert.equal((await readFile(join(dist, ENTRY), 'utf8')).split(call).length, 2, call);
    assert.equal(tools.body.body.at(-1).argument.name, numbers.get('player/tools/tools.js'));
  },

  'stripping a script changes nothing but its looks': async () => {
    for (const folder of ['.', 'examples']) {
      const scripts = (await readdir(join(www, folder))).filter((name) => name.endsWith('.js') && name !== ENTRY);
      assert.ok(scripts.length > 0);
      for (const name of scripts) assert.deepEqual(tree(await read(join(dist, folder, name))), tree(await read(join(www, folder, name))), name);
    }
  },

  'every module of the player is in one of the scripts': async () => {
    const modules = await sources();
    const files = (await readdir(join(www, 'player'), { recursive: true })).filter((name) => name.endsWith('.js'));
    assert.deepEqual(files.map((name) => join('player', name)).sort(), [...modules.keys()].filter((path) => path !== ENTRY).sort());
  },

  'the joined scripts are loaded on a server, and by themselves do nothing': async () => {
    const { ReprisePlayer, ...rest } = await import(`file://${join(dist, ENTRY)}`);
    assert.deepEqual(Object.keys(rest), []);
    assert.equal(typeof ReprisePlayer.prototype.goTo, 'function');
    const tools = await import(`file://${join(dist, LATER)}`);
    assert.equal(Object.keys(tools).length, 1);
    assert.match(Object.keys(tools)[0], /^build[0-9a-f]{8}$/);
  },
};
