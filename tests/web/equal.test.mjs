// The page's dialect, GLSL ES over SwiftShader, draws the picture of the native viewer's, GLSL over
// llvmpipe: the same view at rest, both beside the server's full render.
// WEB_SCENES=all compares all scenes and settings below instead of a few; it takes ten minutes.
// WEB_ANGLE=gl-egl has one rasterizer draw both: what is left is Mirage's.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { bin, decode, drawnBy, flip, launch, open, picture, pose, rested, scratch, serve, stopAll, truth } from './harness.mjs';

const width = 320, height = 180;
const mostApart = 0.02;
const frames = 150;  // 15 s: everything has arrived, and is refined
const assets = join(import.meta.dirname, '../../../shared/assets');

const settings = {
  'as served': [],
  impostors: ['--no-geometry', '--references'],
  'impostors in shadow': ['--no-geometry', '--references', '--shadows', 'on'],
  'tiles alone': ['--no-geometry', '--references', '--no-view'],
};
const few = [['builtin:knot', 'as served'], ['builtin:field?instances=40', 'impostors in shadow'], ['builtin:clutter?objects=40', 'impostors']];
const scenes = ['builtin:knot', 'builtin:forest?trees=60&clutter=20', 'builtin:city?blocks=2', 'builtin:clutter?objects=100',
  'builtin:museum?objects=6&triangles=20000', 'builtin:field?instances=100'];
const models = ['reference/tree', 'objects/glass_table_blend', 'features/alpha_blend_mode_test', 'features/clearcoat_test', 'objects/flight_helmet']
  .map((name) => join(assets, `${name}.glb`)).filter(existsSync);  // layers, blended surfaces, coats, maps
const all = [...scenes.flatMap((scene) => Object.keys(settings).map((setting) => [scene, setting])),
  ...models.flatMap((model) => ['as served', 'impostors'].map((setting) => [model, setting]))];

let browser;
before(async () => { browser = await launch(drawnBy('swiftshader')); });
after(async () => {
  await browser?.close();
  stopAll();
});

// Returns the native viewer's last picture of this view. A picture at rest needs no network's time.
function native(server, { eye, ahead }) {
  const out = scratch();
  const look = eye.map((v, i) => v + ahead[i]);
  execFileSync(join(bin, 'mirage-view'), [`ws://127.0.0.1:${server.port}`, '--offscreen', `${width}x${height}`, '--path', `#eye=${eye}&look=${look}`,
    '--frames', String(frames), '--fps', '10', '--virtual-time', '--frame-ms', '0', '--out', out], { stdio: 'ignore' });
  return readFileSync(join(out, readdirSync(out).filter((name) => name.endsWith('.png')).sort().at(-1)));
}

// Leaves the pictures where a person can look at them.
function keep(pictures) {
  const out = scratch();
  for (const [name, { rgba }] of Object.entries(pictures)) {
    const rgb = Buffer.from(rgba.filter((_, i) => i % 4 !== 3));
    writeFileSync(join(out, `${name}.ppm`), Buffer.concat([Buffer.from(`P6 ${width} ${height} 255\n`), rgb]));
  }
  return out;
}

for (const [scene, setting] of process.env.WEB_SCENES === 'all' ? all : few) {
  const name = `${scene.replace(/.*\//, '')}, ${setting}`;
  test(`${name}: the page draws what the native viewer draws`, async () => {
    const server = await serve(scene, [...settings[setting], '--codec', 'zstd']);  // on a full link, tiles would be lossy
    const page = await open(browser, `${server.url}#budget=0`, { width, height });
    const f = await rested(page, 120);
    const ours = await picture(page), theirs = await decode(page, native(server, await pose(page))), full = await truth(page);
    const apart = await flip(page, theirs, ours);
    const [one, other] = [await flip(page, full, ours), await flip(page, full, theirs)];
    console.log(`${name}: FLIP ${apart.toFixed(4)}; to the full render ${one.toFixed(4)}, native ${other.toFixed(4)}; ${f.impostors} impostors, ${f.meshes} meshes`);
    assert.deepEqual(page.problems, []);
    await page.context().close();
    await server.stop();
    assert.ok(apart <= mostApart, `FLIP ${apart}, pictures in ${keep({ page: ours, native: theirs, full })}`);
  });
}
