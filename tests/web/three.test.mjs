// mirage-client in a page of three.js, from the packed package: the picture beside the same model drawn by three.js itself, and
// what hosts do to a layer.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { bin, decode, hostSite, launch, open, serve, stopAll, until } from './harness.mjs';

const modules = join(process.env.WEB_MODULES, 'node_modules');
const model = join(import.meta.dirname, '../data/assets/reference/monkey.glb');
let browser, site, server;

before(async () => {
  site = await hostSite({ '/monkey.glb': model, '/host.js': join(import.meta.dirname, 'three_host.js'), '/example/': join(import.meta.dirname, '../../examples/three'),
    '/example/node_modules/': modules, '/example/node_modules/mirage-client/': join(bin, '../../npm/package') });
  [browser, server] = await Promise.all([launch(), serve(model, ['--allow-origin', site.origin])]);
});
after(async () => {
  await browser?.close();
  site?.close();
  stopAll();
});

const hostPage = (three, extra = '') => `<!doctype html><html lang="en"><title>host</title><link rel="icon" href="data:,"><style>body { margin: 0 }</style>
<script type="importmap">{ "imports": { "three": "/modules/${three}/build/three.module.js", "three/addons/": "/modules/${three}/examples/jsm/",
  "mirage-client": "/package/index.js", "mirage-client/three": "/package/three.js", "mirage-client/element": "/package/element.js", "iwer": "/modules/iwer/build/iwer.module.js" } }</script>
${extra}<script type="module" src="/host.js"></script></html>`;

async function host(options = {}, { three = 'three', extra = '', ...size } = {}) {
  site.put('/host.html', hostPage(three, extra));
  const page = await open(browser, `${site.origin}/host.html`, { width: 480, height: 270, ...size });
  await page.waitForFunction(() => globalThis.make);
  await page.evaluate(async (given) => { globalThis.one = await make(given); }, { url: server.url, ...options });
  return page;
}

const rest = (page, name = 'one') => until('rest', () => page.evaluate((n) => { globalThis[n].render(); return globalThis[n].mirage.atRest; }, name), 60);

// The cube's pixels in Mirage's picture are those in three's own picture of the same model, up to tau (1 px) and the pixel itself.
async function agrees(page, most = 2) {
  await rest(page);
  const { apart, count, wrong } = await page.evaluate(() => one.compareCube());
  assert.ok(count > 100, `${count} px of the cube are seen`);
  assert.ok(apart <= most, `a pixel of the cube is ${apart} px from where it should be; ${wrong} are not where they should be, of ${count}`);
  assert.deepEqual(page.problems, []);
  return { apart, wrong, count };
}

for (const [name, options] of Object.entries({
  'a usual picture': {},
  'several samples': { antialias: true },
  'reversed depth': { reversed: true },
  'logarithmic depth': { logarithmic: true },
  'post-processing': { composer: true },
  'a target with many values': { half: true },
  'a scene that is moved, turned and scaled': { placed: true },
})) {
  test(`three.js: a cube before, behind and through the model, ${name}`, async () => {
    const page = await host(options);
    for (const z of [1.6, 0.2, -1.6]) {
      await page.evaluate((at) => one.moveCube(at), z);
      const found = await agrees(page);
      if (process.env.WEB_SHOW) console.log(name, z, found);
    }
    await page.context().close();
  });
}

test('three.js: the oldest version that is promised draws the same', async () => {
  const page = await host({ reversed: true }, { three: 'three-oldest' });
  assert.equal(await page.evaluate(() => version), '180');
  await agrees(page);
  await page.context().close();
});

test('three.js: the host\'s picture is the same before, and after Mirage is gone', async () => {
  const page = await host();
  await rest(page);
  const same = await page.evaluate(() => one.hostPictures());
  assert.deepEqual(same, { without: 0, hidden: 0, disposed: 0 });
  await page.context().close();
});

test('three.js: two scenes of two servers, each where it stands', async () => {
  const knot = await serve('builtin:knot', ['--allow-origin', site.origin]);
  const page = await host({ second: knot.url });
  await rest(page);
  await until('the second', () => page.evaluate(() => { one.render(); return one.second.atRest; }), 60);
  const { left, right } = await page.evaluate(() => one.halves());
  assert.ok(left > 1000 && right > 1000, `${left} px of one, ${right} px of the other`);
  assert.deepEqual(page.problems, []);
  await page.context().close();
  await knot.stop();
});

test('three.js: the window changes its size', async () => {
  const page = await host();
  await agrees(page);
  await page.evaluate(() => one.resize(320, 400, 1.5));
  await agrees(page);
  await page.context().close();
});

test('three.js: a lost context comes back', async () => {
  const page = await host();
  await rest(page);
  await page.evaluate(async () => {
    const lose = one.renderer.getContext().getExtension('WEBGL_lose_context');
    const event = (name) => new Promise((done) => { one.renderer.domElement.addEventListener(name, done, { once: true }); });
    const lost = event('webglcontextlost'), restored = event('webglcontextrestored');
    lose.loseContext();
    await lost;
    await new Promise((done) => { setTimeout(done, 100); });
    lose.restoreContext();
    await restored;
  });
  page.problems.length = 0;  // what three.js says of the loss
  await agrees(page);
  await page.context().close();
});

test('three.js: glass of the host shows what stands behind it', async () => {
  const page = await host({ glass: true });
  await rest(page);
  const behind = await page.evaluate(() => one.throughGlass());
  if (process.env.WEB_SHOW) await page.screenshot({ path: join(process.env.WEB_SHOW, 'three_glass.png') });
  assert.ok(behind > 300, `${behind} px of the model are seen through the glass`);
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('three.js: in XR each eye sees its own picture', async () => {
  const page = await host({ xr: true });
  await page.evaluate(() => one.enterXr());
  const { eyes, truth } = await until('both eyes', () => page.evaluate(() => one.eyes()), 60);
  if (process.env.WEB_SHOW) console.log(eyes, truth);
  assert.equal(eyes.length, 2);
  for (const eye of [0, 1]) {
    assert.ok(truth[eye].count > 300, JSON.stringify(truth));
    assert.ok(Math.abs(eyes[eye].count / truth[eye].count - 1) < 0.05, JSON.stringify({ eyes, truth }));
    assert.ok(Math.abs(eyes[eye].middle - truth[eye].middle) < 0.5, JSON.stringify({ eyes, truth }));
  }
  assert.ok(Math.abs(truth[0].middle - truth[1].middle) > 1, 'the eyes see different pictures');
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('three.js: the point under a click is where three.js says it is', async () => {
  for (const options of [{ placed: true }, { reversed: true }]) {
    const page = await host(options);
    await rest(page);
    const { hits, worst, outside } = await page.evaluate(() => one.points());
    assert.ok(hits > 20, `${hits} places of the model`);
    assert.ok(worst < 2, `the farthest point is ${worst} px beside`);
    assert.equal(outside, null);
    await agrees(page);  // and three.js draws on
    await page.context().close();
  }
});

test('three.js: two views of one frame, each with its own picture', async () => {
  const page = await host();
  const shares = await until('both', () => page.evaluate(() => one.twoViews()), 60);
  for (const [seen, truth] of shares) assert.ok(truth > 200 && Math.abs(seen / truth - 1) < 0.05, JSON.stringify(shares));
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('three.js: a camera or a place that cannot be drawn is told once', async () => {
  const page = await host();
  await rest(page);
  const told = await page.evaluate(() => one.wrongCameras());
  assert.equal(told.orthographic, 'Mirage draws for perspective cameras alone');
  assert.match(told.squeezed, /scale it evenly/);
  assert.equal(told.times, 3, 'a mistake that is mended and made again is told again');
  assert.ok(told.back, 'and the next good one is drawn');
  assert.match(told.option, /frameMs is -1/);
  await page.context().close();
});

test('three.js: a server that does not let the page in, and none at all', async () => {
  const closed = await serve('builtin:knot');
  const page = await host({ url: closed.url });
  const why = await until('a word', () => page.evaluate(() => one.down), 20);
  assert.match(why, /--allow-origin http:/);
  assert.match(await page.evaluate(() => one.warned), /--allow-origin http:/, 'on the console, too');
  await page.context().close();
  await closed.stop();
});

test('the example is short, and its cubes stand among the trees', async () => {
  const source = readFileSync(join(import.meta.dirname, '../../examples/three/index.html'), 'utf8');
  assert.ok(source.split('\n').length <= 61);
  const forest = await serve('builtin:forest?trees=400', ['--allow-origin', site.origin]);
  const page = await open(browser, `${site.origin}/example/index.html?server=${encodeURIComponent(forest.url)}`, { width: 640, height: 360 });
  await until('the trees', () => page.evaluate(() => globalThis.example?.trees.loaded && example.trees.client.pictures.length > 0), 60);
  await until('rest', () => page.evaluate(() => example.trees.atRest), 90);
  assert.deepEqual(page.problems, []);
  const png = await page.screenshot(process.env.WEB_SHOW ? { path: join(process.env.WEB_SHOW, 'three_example.png') } : {});
  const { rgba } = await decode(page, png);
  const count = { red: 0, blue: 0, green: 0 };
  for (let i = 0; i < rgba.length; i += 4) {
    const [r, g, b] = rgba.subarray(i, i + 3);
    if (r > 2 * g && r > 2 * b) ++count.red;
    if (b > 1.6 * r && b > 1.6 * g) ++count.blue;
    if (g > r && g > b) ++count.green;
  }
  assert.ok(count.red > 500 && count.blue > 200 && count.green > 50000, JSON.stringify(count));
  await page.context().close();
  await forest.stop();
});
