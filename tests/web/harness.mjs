// A shipped server, a shaped link before it, a real browser, and what tests ask of the page.
// Environment: WEB_BIN (folder of the programs), WEB_MODULES (folder with node_modules/playwright-core), WEB_CHROMIUM (default:
// Chromium without windows, which starts sooner, else Chromium), WEB_ANGLE (what draws. gl-egl: the system's own OpenGL, as for
// the native programs; swiftshader: what browsers have where no card is, a third slower).
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import http from 'node:http';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';

export const bin = process.env.WEB_BIN;
const required = createRequire(resolve(process.env.WEB_MODULES, 'x.js'));
const { chromium } = required('playwright-core');
const axe = readFileSync(required.resolve('axe-core/axe.min.js'), 'utf8');
/// Options of a browser that draws with this, unless WEB_ANGLE names something else.
export const drawnBy = (angle) =>
  ['--no-sandbox', '--use-gl=angle', `--use-angle=${process.env.WEB_ANGLE ?? angle}`, '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'];
const programs = ['/usr/bin/chromium-headless-shell', '/usr/bin/chromium'];

export const sleep = (ms) => new Promise((done) => { setTimeout(done, ms); });
export const scratch = () => mkdtempSync(join(tmpdir(), 'mirage-web-'));

export async function until(what, ask, seconds = 20) {
  const end = Date.now() + seconds * 1000;
  for (;;) {
    const answer = await ask();
    if (answer) return answer;
    if (Date.now() > end) throw new Error(`not within ${seconds} s: ${what}`);
    await sleep(50);
  }
}

const running = new Set();
/// Ends what a failed test left behind.
export const stopAll = () => { for (const child of running) child.kill('SIGKILL'); };
process.on('exit', stopAll);

// Starts a program that writes its port into a file once it is ready.
async function start(program, args) {
  const file = join(scratch(), 'port');
  const child = spawn(join(bin, program), [...args, '--port-file', file], { stdio: ['ignore', 'pipe', 'pipe'] });
  const log = [];
  for (const stream of [child.stdout, child.stderr]) stream.on('data', (text) => log.push(String(text)));
  running.add(child);
  child.on('exit', () => running.delete(child));
  const port = await until(`${program} ${args.join(' ')}`, () => {
    if (child.exitCode !== null) throw new Error(`${program} ended: ${log.join('')}`);
    return existsSync(file) && Number(readFileSync(file, 'utf8'));
  }, 120);
  const stop = (signal = 'SIGKILL') => new Promise((done) => {
    if (child.exitCode !== null || child.signalCode !== null) { done(); return; }
    child.on('exit', done);
    child.kill(signal);
  });
  return { port, url: `http://127.0.0.1:${port}/`, log, child, stop };
}

export const serve = (scene, args = [], port = 0) => start('mirage-server', [scene, '--listen', `127.0.0.1:${port}`, ...args]);
export const relay = (to, { rtt, rate }) =>
  start('mirage-relay', ['--to', String(to), '--rtt', String(rtt), '--rate', String(rate)]);

const mediaTypes = { html: 'text/html', js: 'text/javascript', mjs: 'text/javascript', wasm: 'application/wasm', css: 'text/css' };

/// Serves a page of somebody else, on a port of its own: the packed mirage-client as /package/, npm's modules as /modules/, and
/// `files` (address -> file, or folder where the address ends with /). put() adds a page's text.
export async function hostSite(files = {}, headers = {}) {
  const folders = {
    '/package/': join(bin, '../../npm/package'), '/modules/': join(process.env.WEB_MODULES, 'node_modules'), ...files };
  const texts = new Map();
  const find = (path) => {
    const folder = Object.keys(folders).filter((address) => address.endsWith('/') && path.startsWith(address)).sort((a, b) => b.length - a.length)[0];
    return folders[path] ?? (folder && join(folders[folder], path.slice(folder.length)));
  };
  const server = http.createServer((request, response) => {
    const path = new URL(request.url, 'http://x').pathname;
    const file = find(path);
    const body = texts.get(path) ?? (file && statSync(file, { throwIfNoEntry: false })?.isFile() ? readFileSync(file) : null);
    if (body === null) { response.writeHead(404).end(); return; }
    response.writeHead(200, { 'Content-Type': mediaTypes[path.split('.').pop()] ?? 'application/octet-stream', ...headers }).end(body);
  });
  await new Promise((done) => { server.listen(0, '127.0.0.1', done); });
  return { origin: `http://127.0.0.1:${server.address().port}`, put: (path, text) => texts.set(path, text), close: () => server.close() };
}

export const launch = (args = drawnBy('gl-egl')) =>
  chromium.launch({ executablePath: process.env.WEB_CHROMIUM ?? programs.find(existsSync), args });

/// Opens a page that collects what goes wrong in it.
export async function open(browser, url, { width = 640, height = 360, scale = 1, touch = false, before, ...options } = {}) {
  const context = await browser.newContext({
    viewport: { width, height }, deviceScaleFactor: scale, hasTouch: touch, isMobile: touch, ...options });
  const page = await context.newPage();
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(error.message));
  page.on('console', (message) => {
    if (message.type() === 'error' || message.text().startsWith('WebGL: INVALID')) page.problems.push(message.text());
  });
  if (before) await page.addInitScript(before);
  await page.goto(url);
  return page;
}

/// Returns what axe-core, the accessibility checker, finds wrong with the page as it stands.
export async function barriers(page) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ['violations'] }));
  return violations.map(({ impact, id, nodes }) => `${impact} ${id}: ${nodes.map((node) => node.target.join(' ')).join(', ')}`);
}

/// Returns the core's figures, with what the page knows; null before there are any.
export const figures = (page) => page.evaluate(() => (globalThis.mirage?.figures && mirage.viewerThere()
  ? { ...mirage.figures.now(), seen: Boolean(mirage.seen), asleep: mirage.next === 0, connected: mirage.link.connected,
    bare: !document.getElementById('poster') } : null));
export const message = (page) => page.evaluate(() =>
  (document.getElementById('status').hidden ? '' : document.getElementById('message').textContent));
export const pose = (page) => page.evaluate(() => mirage.place.view());
/// Returns the pose once it has not changed for four frames. What a hand has done is then in it: on a busy machine, its
/// last motion may be taken several frames after the first.
export const poseAtRest = async (page) => JSON.parse(await page.evaluate(() => new Promise((done) => {
  let before = '', same = 0;
  const look = () => {
    const now = JSON.stringify(mirage.place.view());
    same = now === before && !mirage.controls.dragged.concat(mirage.controls.panned, mirage.controls.zoom).some(Boolean) ? same + 1 : 0;
    before = now;
    if (same < 4) requestAnimationFrame(look);
    else done(now);
  };
  look();
})));

export const seen = (page, seconds) => until('a picture', async () => (await figures(page))?.seen, seconds);
/// Waits until everything is there and refined, the page sleeps, and its poster has faded away.
export const rested = (page, seconds = 60) => until('rest', async () => {
  const f = await figures(page);
  return f && f.complete && f.connected && f.atRest && f.refined && f.asleep && f.bare && f;
}, seconds);

/// Returns the RGBA of the picture as the core has it. `walked` is how far a walk had come when it was
/// drawn (globalThis.drawnAt): the eye itself is already ahead of it.
export async function picture(page) {
  const { width, height, text, walked } = await page.evaluate(async () => {
    const { pixels } = await import(new URL('core.js', document.querySelector('script[data-wasm-bytes]').src));
    const { width: w, height: h, rgba } = pixels(mirage.core);
    const walked = globalThis.drawnAt;
    let binary = '';
    for (let i = 0; i < rgba.length; i += 32768) binary += String.fromCharCode(...rgba.subarray(i, i + 32768));
    return { width: w, height: h, text: btoa(binary), walked };
  });
  return { width, height, rgba: Buffer.from(text, 'base64'), walked };
}

/// Returns the server's full render of what the page looks at.
export async function truth(page) {
  await page.evaluate(() => { mirage.core._page_ask_reference(4); mirage.wake(); });
  const at = await until('a full render', () => page.evaluate(() => {
    mirage.wake();
    const there = mirage.core._page_reference();
    if (there < 0) throw new Error('the server renders nothing in full');
    return there > 0 && mirage.core._page_reference_pixels();
  }), 60);
  const { width, height, text } = await page.evaluate((pointer) => {
    const [w, h] = [mirage.core._page_width(), mirage.core._page_height()];
    const bytes = mirage.core.HEAPU8.slice(pointer, pointer + 4 * w * h);
    let binary = '';
    for (let i = 0; i < bytes.length; i += 32768) binary += String.fromCharCode(...bytes.subarray(i, i + 32768));
    return { width: w, height: h, text: btoa(binary) };
  }, at);
  return { width, height, rgba: Buffer.from(text, 'base64') };
}

/// Returns the pixels of a PNG, as the browser decodes it.
export async function decode(page, png) {
  const { width, height, text } = await page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes], { type: 'image/png' }), { colorSpaceConversion: 'none' });
    const sheet = new OffscreenCanvas(image.width, image.height);
    const pen = sheet.getContext('2d');
    pen.drawImage(image, 0, 0);
    const { data } = pen.getImageData(0, 0, image.width, image.height);
    let binary = '';
    for (let i = 0; i < data.length; i += 32768) binary += String.fromCharCode(...data.subarray(i, i + 32768));
    return { width: image.width, height: image.height, text: btoa(binary) };
  }, png.toString('base64'));
  return { width, height, rgba: Buffer.from(text, 'base64') };
}

/// Returns what the canvas shows, without what lies over it.
export async function screen(page) {
  await page.addStyleTag({ content: '' }).catch(() => {});
  const hidden = await page.evaluate(() => [...document.body.children].filter((e) => e.tagName !== 'MAIN' && e.style.visibility !== 'hidden')
    .map((e) => { e.style.visibility = 'hidden'; return e.id; }));
  const png = await page.screenshot();
  await page.evaluate((ids) => { for (const id of ids) if (id) document.getElementById(id).style.visibility = ''; }, hidden);
  return decode(page, png);
}

/// Returns the mean FLIP by the core's own measure, in the page's worker.
export const flip = (page, a, b) => page.evaluate(async ({ reference, test, width, height }) => {
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const id = `test-${Math.random()}`;
  const answer = new Promise((done) => {
    mirage.link.worker.addEventListener('message', function once({ data }) {
      if (data.flip?.id !== id) return;
      mirage.link.worker.removeEventListener('message', once);
      done(data.flip.mean);
    });
  });
  mirage.link.worker.postMessage({ flip: { id, reference: bytes(reference), test: bytes(test), width, height } });
  return answer;
}, { reference: a.rgba.toString('base64'), test: b.rgba.toString('base64'), width: a.width, height: a.height });

export function write(file, text) {
  writeFileSync(file, text);
  return file;
}

export const percentile = (values, q) => {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.round(q * (sorted.length - 1)))] : NaN;
};
