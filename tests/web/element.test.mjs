// <mirage-view> of the packed mirage-client, in a page of somebody else.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { join } from 'node:path';
import { barriers, decode, hostSite, launch, open, scratch, serve, stopAll, until, write } from './harness.mjs';

let browser, site, knot;

before(async () => {
  site = await hostSite();
  [browser, knot] = await Promise.all([launch(), serve('builtin:knot', ['--allow-origin', site.origin])]);
});
after(async () => {
  await browser?.close();
  site?.close();
  stopAll();
});

async function show(body, options = {}) {
  site.put('/page.html', `<!doctype html><html lang="en"><title>page</title><link rel="icon" href="data:,">
<style>body { margin: 0 } mirage-view { width: 480px; height: 270px }</style>
<script type="module" src="/package/element.js"></script><main><h1>A page</h1>${body}</main></html>`);
  return open(browser, `${site.origin}/page.html`, options);
}
const rested = (page, which = 'mirage-view') => until('rest', () => page.evaluate((w) => document.querySelector(w).atRest, which), 60);
const reds = async (page, which = 'mirage-view') => {
  const { rgba } = await decode(page, await page.locator(which).screenshot());
  let count = 0;
  for (let i = 0; i < rgba.length; i += 4) count += rgba[i] - rgba[i + 2] > 20 ? 1 : 0;
  return count;
};
const eye = (page) => page.evaluate(() => document.querySelector('mirage-view').camera.eye);

test('element: two lines of HTML show a scene', async () => {
  const page = await show(`<mirage-view src="${knot.url}" alt="A knot" camera-controls></mirage-view>`);
  await rested(page);
  assert.ok(await reds(page) > 2000);
  if (process.env.WEB_SHOW) await page.screenshot({ path: join(process.env.WEB_SHOW, 'element.png') });
  assert.deepEqual((await barriers(page)).filter((line) => /^(serious|critical)/.test(line)), []);
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('element: a hand turns it where camera-controls says so, and nowhere else', async () => {
  const page = await show(`<mirage-view src="${knot.url}"></mirage-view>`);
  await rested(page);
  const before = await eye(page);
  const drag = async () => {
    await page.mouse.move(200, 200);
    await page.mouse.down();
    await page.mouse.move(300, 220, { steps: 5 });
    await page.mouse.up();
    await until('a frame', () => page.evaluate(() => new Promise((done) => { requestAnimationFrame(() => requestAnimationFrame(() => done(true))); })));
  };
  await drag();
  assert.deepEqual(await eye(page), before);
  await page.evaluate(() => document.querySelector('mirage-view').setAttribute('camera-controls', ''));
  await drag();
  await until('the eye moves', async () => Math.hypot(...(await eye(page)).map((v, i) => v - before[i])) > 0.1);
  await page.evaluate(() => document.querySelector('mirage-view').resetCamera());
  await until('home', async () => Math.hypot(...(await eye(page)).map((v, i) => v - before[i])) < 1e-9);
  await page.context().close();
});

test('element: it turns by itself, unless a person wants less motion', async () => {
  const page = await show(`<mirage-view src="${knot.url}" auto-rotate></mirage-view>`);
  await until('loaded', () => page.evaluate(() => document.querySelector('mirage-view').loaded), 60);
  const before = await eye(page);
  await until('it turns', async () => Math.hypot(...(await eye(page)).map((v, i) => v - before[i])) > 0.3);
  await page.context().close();
  const calm = await show(`<mirage-view src="${knot.url}" auto-rotate></mirage-view>`, { reducedMotion: 'reduce' });
  await rested(calm);
  const still = await eye(calm);
  await new Promise((done) => { setTimeout(done, 1000); });
  assert.deepEqual(await eye(calm), still);
  await calm.context().close();
});

test('element: attributes place the camera and the sun, and change while it runs', async () => {
  const page = await show(`<mirage-view src="${knot.url}" camera-eye="0 1 6" camera-target="0 0.5 0" field-of-view="40" sun="200 10"></mirage-view>`);
  await rested(page);
  assert.deepEqual((await eye(page)).map((v) => Math.round(v * 1000) / 1000), [0, 1, 6]);
  const near = await reds(page);
  await page.evaluate(() => document.querySelector('mirage-view').setAttribute('camera-eye', '0 1 14'));
  await until('it is smaller', async () => (await reds(page)) < 0.5 * near, 30);
  await page.context().close();
});

test('element: the poster stays until there is a picture, and without WebGL 2 for good', async () => {
  const poster = 'data:image/svg+xml,<svg xmlns="http://www.w3.org/2000/svg"/>';
  const page = await show(`<mirage-view src="${knot.url}" poster='${poster}'></mirage-view>`);
  await rested(page);
  assert.equal(await page.evaluate(() => document.querySelector('mirage-view').posterBox.hidden), true);
  await page.context().close();
  const without = await show(`<mirage-view src="${knot.url}" poster='${poster}'></mirage-view>`, {
    before: () => { HTMLCanvasElement.prototype.getContext = () => null; } });
  const word = await until('a word', () => without.evaluate(() => document.querySelector('mirage-view').word.textContent));
  assert.match(word, /no WebGL 2/);
  assert.equal(await without.evaluate(() => document.querySelector('mirage-view').posterBox.hidden), false);
  await without.context().close();
});

test('element: hidden it sleeps, removed it lets go, and it comes back', async () => {
  const page = await show(`<mirage-view src="${knot.url}" auto-rotate></mirage-view>`);
  await until('loaded', () => page.evaluate(() => document.querySelector('mirage-view').loaded), 60);
  await page.evaluate(() => { document.querySelector('mirage-view').style.display = 'none'; });
  await until('it sleeps', () => page.evaluate(() => document.querySelector('mirage-view').next === 0));
  await page.evaluate(() => { document.querySelector('mirage-view').style.display = ''; });
  await until('it wakes', () => page.evaluate(() => document.querySelector('mirage-view').next !== 0));
  await page.evaluate(() => { globalThis.kept = document.querySelector('mirage-view'); kept.remove(); });
  assert.equal(await page.evaluate(() => kept.client), null);
  await page.evaluate(() => document.querySelector('main').append(kept));
  await until('loaded again', () => page.evaluate(() => kept.loaded), 60);
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('element: two on one page, and a src that changes', async () => {
  const forest = await serve('builtin:forest?trees=40', ['--allow-origin', site.origin]);
  const page = await show(`<mirage-view id="a" src="${knot.url}"></mirage-view><mirage-view id="b" src="${forest.url}"></mirage-view>`, { height: 640 });
  await rested(page, '#a');
  await rested(page, '#b');
  assert.ok(await reds(page, '#a') > 2000);
  await page.evaluate((url) => document.querySelector('#b').setAttribute('src', url), knot.url);
  await rested(page, '#b');
  assert.ok(await reds(page, '#b') > 2000);
  assert.deepEqual(page.problems, []);
  await page.context().close();
  await forest.stop();
});

test('element: a lost context comes back', async () => {
  const page = await show(`<mirage-view src="${knot.url}"></mirage-view>`);
  await rested(page);
  await page.evaluate(async () => {
    const { canvas } = document.querySelector('mirage-view');
    const lose = canvas.getContext('webgl2').getExtension('WEBGL_lose_context');
    const event = (name) => new Promise((done) => { canvas.addEventListener(name, done, { once: true }); });
    const lost = event('webglcontextlost'), back = event('webglcontextrestored');
    lose.loseContext();
    await lost;
    await new Promise((done) => { setTimeout(done, 100); });
    lose.restoreContext();
    await back;
  });
  await until('not at rest', () => page.evaluate(() => !document.querySelector('mirage-view').atRest));
  await rested(page);
  assert.ok(await reds(page) > 2000);
  await page.context().close();
});

test('element: what goes wrong is said in words, and never as markup', async () => {
  const tokens = write(join(scratch(), 'tokens'), 'secret-of-someone name=someone\n');
  const closed = await serve('builtin:knot', ['--token-file', tokens, '--allow-origin', site.origin]);
  const page = await show(`<mirage-view src="${closed.url}" token="<b>no</b>"></mirage-view>`);
  const word = await until('a word', () => page.evaluate(() => document.querySelector('mirage-view').word.textContent));
  assert.match(word, /does not know this token/);
  await page.evaluate(() => document.querySelector('mirage-view').setAttribute('token', 'secret-of-someone'));
  await rested(page);
  assert.equal(await page.evaluate(() => document.querySelector('mirage-view').word.hidden), true);
  await page.evaluate(() => document.querySelector('mirage-view').setAttribute('src', 'ftp://<i>x</i>'));
  assert.match(await until('a word', () => page.evaluate(() => document.querySelector('mirage-view').word.textContent)), /no address with http/);
  assert.equal(await page.evaluate(() => document.querySelector('mirage-view').shadowRoot.querySelector('i, b')), null);
  await page.context().close();
  await closed.stop();
});

test('element: a page whose policy forbids workers keeps its poster, and says so', async () => {
  const strict = await hostSite({}, { 'Content-Security-Policy': `script-src 'self' 'wasm-unsafe-eval'; worker-src 'none'; connect-src *` });
  strict.put('/page.html', `<!doctype html><html lang="en"><title>page</title><link rel="icon" href="data:,"><script type="module" src="/package/element.js"></script>
<mirage-view style="width: 200px; height: 200px" src="${knot.url}"></mirage-view></html>`);
  const page = await open(browser, `${strict.origin}/page.html`);
  assert.match(await until('a word', () => page.evaluate(() => document.querySelector('mirage-view').word.textContent)), /worker/i);
  await page.context().close();
  strict.close();
});
