// examples/impostors-three in a browser: bakes beside the mesh that three.js draws itself, and what the loader refuses.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { join } from 'node:path';
import { hostSite, launch, open } from './harness.mjs';
import { bakeOf, hostFiles, hostPage } from './impostor_bench.mjs';

const monkey = join(import.meta.dirname, '../data/assets/reference/monkey.glb');
let browser, site;

before(async () => {
  site = await hostSite({ ...hostFiles([monkey]), '/example/node_modules/': join(process.env.WEB_MODULES, 'node_modules') });
  site.put('/host.html', hostPage);
  browser = await launch();
});
after(async () => {
  await browser?.close();
  site?.close();
});

function put(model, options) {
  const bake = bakeOf(model, options);
  site.put(`/baked/${bake.name}.json`, bake.json);
  for (const [file, bytes] of Object.entries(bake.pictures)) site.put(`/baked/${file}`, bytes);
  return bake;
}

async function measured(model, address, options) {
  const bake = put(model, options);
  const page = await open(browser, `${site.origin}/host.html`);
  await page.waitForFunction(() => globalThis.measure);
  const found = await page.evaluate((o) => measure(o), { bake: `/baked/${bake.name}.json`, model: address, directions: 2 });
  assert.deepEqual(page.problems, []);
  await page.context().close();
  return found;
}

// Published for the three.js package octahedral-impostor, at the same bytes and 4 radii: knot 17.3 dB, monkey 18.0 dB.
test('impostors: a knot is 6 dB and more above the package', async () => {
  const found = await measured('knot', 'knot', ['--grid', '8', '--size', '2048']);
  assert.ok(found.psnr > 30, `${found.psnr} dB`);  // 34.9 over 4 directions
  assert.ok(found.iou > 0.97, `${found.iou}`);
  assert.ok(found.texture_mib <= 42.7, `${found.texture_mib} MiB`);
});

test('impostors: a monkey, with the lattice of the whole sphere', async () => {
  const found = await measured(monkey, '/models/monkey.glb', ['--grid', '8', '--size', '2048', '--layout', 'octahedral']);
  assert.ok(found.psnr > 27, `${found.psnr} dB`);
});

test('impostors: the example draws many, and says what is wrong', async () => {
  const { name, json, pictures } = put('knot', ['--grid', '8', '--size', '512']);
  const page = await open(browser, `${site.origin}/example/index.html?bake=/baked/${name}.json&count=100`, { width: 320, height: 180 });
  await page.waitForFunction(() => globalThis.example);
  assert.match(await page.textContent('#said'), /^100 × knot/);
  assert.deepEqual(page.problems, []);
  const facts = JSON.parse(json), [file] = Object.keys(pictures);
  const wrong = { 'no bake for the target generic': { ...facts, target: 'godot4' }, 'is a ring': { ...facts, layout: 'ring' },
    'px wide': { ...facts, size_px: 1024 }, 'has no map normal': { ...facts, maps: facts.maps.filter((map) => map.file === file) } };
  for (const [text, bake] of Object.entries(wrong)) {
    site.put('/baked/wrong.json', JSON.stringify(bake));
    await page.goto(`${site.origin}/example/index.html?bake=/baked/wrong.json`);
    await page.waitForFunction((part) => document.getElementById('said').textContent.includes(part), text);
  }
  await page.context().close();
});
