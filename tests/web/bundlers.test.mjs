// The packed mirage-client, installed from its file by npm, in what people build pages with: Vite (dev and build) and webpack. The
// import map of pages without a bundler is in three.test.mjs and element.test.mjs.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { execFileSync } from 'node:child_process';
import { createRequire } from 'node:module';
import { mkdirSync, readFileSync, readdirSync, symlinkSync } from 'node:fs';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';
import { bin, hostSite, launch, open, scratch, serve, stopAll, until, write } from './harness.mjs';

const modules = join(process.env.WEB_MODULES, 'node_modules');
const packed = join(bin, '../../npm');
const required = createRequire(join(modules, 'x.js'));
let browser, knot, folder;

const script = `
import * as THREE from 'three';
import { MirageScene } from 'mirage-client/three';
import 'mirage-client/element';
const renderer = new THREE.WebGLRenderer();
renderer.setSize(320, 180);
document.body.append(renderer.domElement);
const camera = new THREE.PerspectiveCamera(50, 16 / 9, 0.1, 100);
camera.position.set(0, 0, 9);
const scene = new THREE.Scene();
const url = new URLSearchParams(location.search).get('server');
const mirage = new MirageScene({ renderer, url });
scene.add(mirage);
renderer.setAnimationLoop(() => { mirage.update(camera); renderer.render(scene, camera); });
const element = document.createElement('mirage-view');
element.setAttribute('src', url);
document.body.append(element);
globalThis.both = { mirage, element };
`;

before(async () => {
  folder = scratch();
  mkdirSync(join(folder, 'node_modules'));
  const tarball = readdirSync(packed).find((name) => name.endsWith('.tgz'));
  execFileSync('tar', ['-xzf', join(packed, tarball), '-C', folder]);
  execFileSync('mv', [join(folder, 'package'), join(folder, 'node_modules/mirage-client')]);
  symlinkSync(join(modules, 'three'), join(folder, 'node_modules/three'));
  write(join(folder, 'package.json'), '{ "type": "module", "private": true }');
  write(join(folder, 'main.js'), script);
  write(join(folder, 'index.html'), '<!doctype html><html lang="en"><title>x</title><link rel="icon" href="data:,"><body><script type="module" src="./main.js"></script></body></html>');
  browser = await launch();
});
after(async () => {
  await browser?.close();
  stopAll();
});

/// The scene in three.js and the element both come to rest on the page at `url`.
async function draws(origin, path = '') {
  knot = await serve('builtin:knot', ['--allow-origin', origin]);
  const page = await open(browser, `${origin}/${path}?server=${encodeURIComponent(knot.url)}`);
  await until('rest', () => page.evaluate(() => globalThis.both?.mirage.atRest && both.element.atRest), 90);
  assert.deepEqual(page.problems, []);
  await page.context().close();
  await knot.stop();
}

const vite = () => import(join(modules, 'vite/dist/node/index.js'));
// The README's line: Vite's pre-bundling would move the modules away from worker and program.
const settings = (more) => ({ root: folder, configFile: false, logLevel: 'error', base: './', optimizeDeps: { exclude: ['mirage-client'] }, resolve: { preserveSymlinks: true }, ...more });

test('bundlers: Vite while one develops', async () => {
  const server = await (await vite()).createServer(settings({ server: { port: 0, host: '127.0.0.1', fs: { strict: false } } }));
  await server.listen();
  await draws(`http://127.0.0.1:${server.httpServer.address().port}`);
  await server.close();
});

test('bundlers: what Vite builds', async () => {
  const out = join(folder, 'vite-out');
  await (await vite()).build(settings({ build: { outDir: out } }));
  const site = await hostSite({ '/': out });
  await draws(site.origin, 'index.html');
  site.close();
});

test('bundlers: what webpack builds', async () => {
  const webpack = required('webpack');
  const out = join(folder, 'webpack-out');
  const stats = await new Promise((done, fail) => {
    webpack({ mode: 'production', context: folder, entry: './main.js', output: { path: out, filename: 'main.js' }, performance: false },
      (error, result) => (error ? fail(error) : done(result)));
  });
  assert.equal(stats.hasErrors(), false, stats.toString('errors-only'));
  write(join(out, 'index.html'), '<!doctype html><html lang="en"><title>x</title><link rel="icon" href="data:,"><body><script src="./main.js"></script></body></html>');
  const site = await hostSite({ '/': out });
  await draws(site.origin, 'index.html');
  site.close();
});

test('the package is small, its modules import nothing of the web at once, and everything in it is meant to be', () => {
  const own = join(folder, 'node_modules/mirage-client');
  const sent = ['index.js', 'three.js', 'mirage.js', 'worker.js', 'mirage.wasm'];
  const bytes = sent.reduce((sum, name) => sum + gzipSync(readFileSync(join(own, name)), { level: 9 }).length, 0);
  assert.ok(bytes <= 400000, `${bytes} bytes; the aim is 350,000`);
  assert.deepEqual(readdirSync(own).sort(), ['LICENSE', 'NOTICE', 'README.md', 'controls.js', 'element.d.ts', 'element.js', 'index.d.ts', 'index.js',
    'mirage.js', 'mirage.wasm', 'package.json', 'three.d.ts', 'three.js', 'worker.js']);
  for (const name of ['index.js', 'three.js']) {
    execFileSync(process.execPath, ['--input-type=module', '-e', `await import(${JSON.stringify(join(own, name))})`], { cwd: folder });
  }
});
