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

const literal = (value) => ({ type: 'Literal', value, raw: `'${value}'` });

export const tests = {
  'the joined scripts are the modules, each once': async () => {
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

    for (const [path, { imports, exports, statements }] of modules) {
      const joined = path === ENTRY ? own : all.find(({ id }) => id === numbers.get(path));
      const bound = imports.filter(({ names }) => names.length > 0).map(({ from, names }) => ({ from: numbers.get(from), names }));
      assert.deepEqual(joined.imports, bound, `what ${path} imports`);
      assert.deepEqual(joined.exports, exports, `what ${path} exports`);
      assert.deepEqual(unbound(joined.statements, path), statements, `what ${path} does`);
    }

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
