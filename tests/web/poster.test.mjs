// The poster in a real browser: a right picture before the program, which takes over without a jump;
// and impostors in pages of other sites.
import assert from 'node:assert/strict';
import http from 'node:http';
import { after, before, test } from 'node:test';
import { decode, figures, flip, launch, open, pose, scratch, screen, seen, serve, sleep, stopAll, until, write } from './harness.mjs';

const scene = 'builtin:knot?tubular=60&radial=12';
let browser, server, portal;

const phone = { width: 390, height: 844, isMobile: true, hasTouch: true,
  userAgent: 'Mozilla/5.0 (Linux; Android 10; K) AppleWebKit/537.36 (KHTML, like Gecko) Chrome/120.0.0.0 Mobile Safari/537.36' };
const page_of = async (url, agent = '') => (await fetch(url, { headers: { 'User-Agent': agent } })).text();
/// Waits until the server's page has its poster.
const poster_made = (one, agent) => until('a poster', async () => (await page_of(one.url, agent)).includes('id="poster"'));

before(async () => {
  [browser, server] = await Promise.all([launch(), serve(scene)]);
  await Promise.all([poster_made(server), poster_made(server, phone.userAgent)]);
});
after(async () => {
  await browser?.close();
  portal?.close();
  stopAll();
});

/// Opens the page with its program held back, until `release()`.
async function hold(hash = '', options = {}) {
  const { width = 640, height = 360, ...others } = options;
  const context = await browser.newContext({ viewport: { width, height }, ...others });
  const page = await context.newPage();
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(error.message));
  page.on('console', (text) => { if (text.type() === 'error') page.problems.push(text.text()); });
  let release;
  const free = new Promise((done) => { release = done; });
  await page.route('**/mirage.wasm', async (route) => { await free; await route.continue(); });
  await page.goto(server.url + hash, { waitUntil: 'commit' });
  await page.waitForFunction(() => document.readyState !== 'loading');
  return { page, release };
}
const shown = (page) => page.evaluate(() => Boolean(document.querySelector('#poster:not([hidden], .leaving)')));
const canvas = (page) => page.evaluate(() => Boolean(document.querySelector('#poster canvas')));
const knot = ({ rgba }) => {  // px of it: it is red
  let out = 0;
  for (let i = 0; i < rgba.length; i += 4) out += rgba[i] - rgba[i + 2] > 20 ? 1 : 0;
  return out;
};

for (const [device, options] of [['a desktop', {}], ['a wide window', { width: 720, height: 360 }], ['a phone', phone]]) {
  test(`on ${device} a picture is there before the program, which goes on from the same place`, async () => {
    const { page, release } = await hold('', options);
    await until('the poster', () => shown(page));
    const before = await screen(page);
    assert.ok(knot(before) > 2000, `${knot(before)} px of a knot`);
    release();
    await seen(page);
    await until('the poster to be gone', () => page.evaluate(() => !document.getElementById('poster')));
    await until('rest', async () => (await figures(page)).complete);
    const difference = await flip(page, before, await screen(page));
    assert.ok(difference < 0.1, `FLIP ${difference}`);
    assert.deepEqual(page.problems, []);
    await page.context().close();
  });
}

test('it moves under the pointer, without holes, and lies still without it', async () => {
  const { page } = await hold('', { width: 720, height: 360 });  // which shows its edges
  await until('the poster', () => shown(page));
  const still = await screen(page);
  assert.equal(await canvas(page), false);
  await page.mouse.move(10, 180);
  await until('a canvas', () => canvas(page));
  await sleep(1200);
  const moved = await screen(page);
  assert.ok(await page.evaluate(() => {
    const [one, other] = [...document.querySelectorAll('#poster > *')].map((e) => e.getBoundingClientRect());
    return one.x === other.x && one.y === other.y && one.width === other.width && one.height === other.height;
  }), 'the canvas lies over the image');
  let differ = 0, black = 0;
  for (let i = 0; i < still.rgba.length; i += 4) {
    differ += Math.abs(still.rgba[i] - moved.rgba[i]) > 24 ? 1 : 0;
    black += moved.rgba[i] + moved.rgba[i + 1] + moved.rgba[i + 2] === 0 ? 1 : 0;
  }
  assert.ok(differ > 1000, `${differ} px differ`);
  assert.equal(black, 0, 'holes');
  await page.evaluate(() => document.getElementById('mirage').dispatchEvent(new PointerEvent('pointerleave')));
  await until('the canvas to be gone', async () => !await canvas(page));
  await page.context().close();
});

test('a phone that is held across shows no poster that was made for it upright', async () => {
  const { page } = await hold('', { ...phone, width: 844, height: 390 });
  await sleep(300);
  assert.equal(await shown(page), false);
  await page.context().close();
});

test('where less motion is preferred it does not move', async () => {
  const { page } = await hold('', { reducedMotion: 'reduce' });
  await until('the poster', () => shown(page));
  await page.mouse.move(10, 180);
  await sleep(500);
  assert.equal(await canvas(page), false);
  await page.context().close();
});

test('a link to another view does not show the home view first', async () => {
  for (const hash of ['#eye=0,1,6&look=0,0.5,0', '#light=90,20', '#fov=30', '#bg=ff0000']) {
    const { page } = await hold(hash);
    await sleep(300);
    assert.equal(await shown(page), false, hash);
    await page.context().close();
  }
});

test('a drag that began on the poster goes on in the program, from the home view', async () => {
  const other = await open(browser, server.url);
  await seen(other);
  const home = await pose(other);
  await other.context().close();
  const { page, release } = await hold();
  await until('the poster', () => shown(page));
  // The scene is known, its first picture has yet to be shown.
  await page.evaluate(() => { mirage.show = () => mirage.wake(); });
  release();
  await until('the scene', () => page.evaluate(() => mirage.viewerThere() && mirage.core._page_home_known()));
  await page.mouse.move(320, 180);
  await page.mouse.down();
  await page.mouse.move(420, 180, { steps: 4 });
  await sleep(300);
  await page.evaluate(() => { delete mirage.show; mirage.wake(); });
  await seen(page);
  await sleep(300);
  assert.deepEqual((await pose(page)).eye, home.eye, 'what was dragged on the poster turns nothing');
  await page.mouse.move(520, 180, { steps: 4 });
  await until('a turn', async () => (await pose(page)).eye.some((v, i) => Math.abs(v - home.eye[i]) > 0.1));
  await page.mouse.up();
  await page.context().close();
});

test('a server with tokens puts nothing of its scene into the page', async () => {
  const closed = await serve(scene, ['--token-file', write(`${scratch()}/tokens`, 'a-token-that-is-long-enough\n')]);
  await page_of(closed.url);
  await sleep(2000);
  const text = await page_of(closed.url);
  assert.doesNotMatch(text, /id="poster"|og:image/);
  await closed.stop();
});

// A page of another origin with the two lines of the guide.
test('an image of another site moves under the pointer, and stays an image without WebGL', async () => {
  portal = http.createServer((request, reply) => reply.writeHead(200, { 'content-type': 'text/html' }).end(`<!doctype html>
    <script type="module" src="${server.url}impostor.js"></script>
    <div style="padding: 40px"><img src="${server.url}v1/impostor?size=320x180" data-mirage-impostor width="320" height="180" alt="a knot"></div>`));
  await new Promise((done) => { portal.listen(0, '127.0.0.1', done); });
  const url = `http://127.0.0.1:${portal.address().port}/`;
  const page = await open(browser, url);
  const overlay = () => page.evaluate(() => Boolean(document.querySelector('img + canvas')));
  await until('the image', () => page.evaluate(() => document.images[0].naturalWidth === 320));
  assert.equal(await overlay(), false);
  const still = await decode(page, await page.screenshot());
  await page.mouse.move(60, 130);
  await until('a canvas', overlay);
  await sleep(1000);
  const moved = await decode(page, await page.screenshot());
  const box = await page.evaluate(() => {
    const [a, b] = [document.images[0], document.querySelector('canvas')].map((e) => e.getBoundingClientRect());
    return [b.x - a.x, b.y - a.y, b.width - a.width, b.height - a.height];
  });
  assert.deepEqual(box, [0, 0, 0, 0]);
  let differ = 0;
  for (let i = 0; i < still.rgba.length; i += 4) differ += Math.abs(still.rgba[i] - moved.rgba[i]) > 24 ? 1 : 0;
  assert.ok(differ > 300, `${differ} px differ`);
  await page.mouse.move(600, 350);
  await until('the image alone', async () => !await overlay());
  assert.deepEqual(page.problems, []);
  await page.context().close();

  const bare = await open(browser, url, { before: () => {
    const real = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function none(kind, ...rest) { return kind.startsWith('webgl') ? null : real.call(this, kind, ...rest); };
  } });
  await until('the image', () => bare.evaluate(() => document.images[0].naturalWidth === 320));
  await bare.mouse.move(60, 130);
  await sleep(500);
  assert.equal(await bare.evaluate(() => Boolean(document.querySelector('canvas'))), false);
  assert.deepEqual(bare.problems, []);
  await bare.context().close();
});
