// Stillness: a page at its home view, with default settings and shadows, asks for nothing after 10 s.
// The first visit waits for rest, so that the server holds all tiles; the second one is measured.
// WEB_SCENES=all watches all scenes and models below instead of a few; it takes ten minutes.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { figures, launch, open, serve, sleep, stopAll, until } from './harness.mjs';

const assets = join(import.meta.dirname, '../../../shared/assets');
const few = ['builtin:forest?trees=60', 'builtin:city?blocks=2', 'builtin:clutter'];
const all = ['builtin:forest', 'builtin:clutter', 'builtin:city', 'builtin:museum?objects=12', 'builtin:knot', 'builtin:field',
  ...['objects/flight_helmet', 'objects/cornell_box', 'objects/diamond', 'objects/glass_table_blend', 'objects/love_neon_blend',
    'objects/steampunk_robot', 'reference/tree', 'features/clearcoat_test', 'features/alpha_blend_mode_test', 'features/normal_tangent_test']
    .map((name) => join(assets, `${name}.glb`)).filter(existsSync)];
const stillMs = 10000, watchedMs = 5000;  // after the connection

let browser;
before(async () => { browser = await launch(); });
after(async () => {
  await browser?.close();
  stopAll();
});

async function visit(url) {
  const page = await open(browser, url, { width: 320, height: 180 });
  await until('a connection', () => page.evaluate(() => globalThis.mirage?.marks.connected !== undefined), 60);
  return page;
}

async function close(page) {
  assert.deepEqual(page.problems, []);
  await page.context().close();
}

// Watches the page from its connection on. Returns when it last asked for a tile, ms, and how often.
async function watch(page) {
  const began = Date.now();
  let last = 0, asked = 0, late = 0, f;
  while (Date.now() - began < stillMs + watchedMs) {
    await sleep(100);
    f = await figures(page);
    const more = (f?.tilesAsked ?? 0) - asked;
    if (more === 0) continue;
    last = Date.now() - began;
    asked += more;
    if (last > stillMs) late += more;
  }
  return { last, asked, late, rests: f.atRest, shown: f.impostors + f.meshes };
}

const seconds = (ms) => (ms / 1000).toFixed(1);

for (const scene of process.env.WEB_SCENES === 'all' ? all : few) {
  const name = scene.replace(/.*\//, '');
  test(`${name}: nothing is asked for after ${seconds(stillMs)} s`, async () => {
    const server = await serve(scene, ['--shadows', 'on']);
    const first = await visit(server.url), began = Date.now();
    await until('rest', async () => (await figures(first))?.atRest, 120);
    const firstMs = Date.now() - began;
    await close(first);
    const page = await visit(server.url);
    const seen = await watch(page);
    await close(page);
    await server.stop();
    console.log(`${name}: at rest after ${seconds(firstMs)} s; then ${seen.asked} tiles, the last after ${seconds(seen.last)} s, ${seen.late} late`);
    assert.ok(seen.shown > 0, 'it shows the scene');
    assert.equal(seen.late, 0);
    assert.ok(seen.rests, 'it rests');
  });
}
