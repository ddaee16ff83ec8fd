// Downloads of the page in a real browser: a view with depth, a bake, a folder.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { inflateSync } from 'node:zlib';
import { barriers, decode, flip, launch, open, picture, rested, scratch, serve, stopAll, until } from './harness.mjs';

let browser, knot;
const view = '#eye=0,1,6&look=0,0.5,0';
const at = (hash) => `${knot.url}${hash}`;

async function fromMenu(page, id) {
  await page.locator('#more').click();
  await page.locator(`#${id}`).click();
}

before(async () => {
  [browser, knot] = await Promise.all([launch(), serve('builtin:knot')]);
});
after(async () => {
  await browser?.close();
  stopAll();
});

/// Unpacks an archive with a program that is not ours. Returns its files by name.
function unpacked(file) {
  const folder = scratch();
  execFileSync('/usr/bin/python3', ['-m', 'zipfile', '-e', file, folder]);
  const names = readdirSync(folder, { recursive: true, withFileTypes: true }).filter((one) => one.isFile());
  return new Map(names.map((one) => [one.name, readFileSync(join(one.parentPath ?? one.path, one.name))]));
}

async function downloaded(page, button, seconds = 120) {
  const [download] = await Promise.all([page.waitForEvent('download', { timeout: seconds * 1000 }), page.locator(button).click()]);
  const file = join(scratch(), 'x.zip');
  await download.saveAs(file);
  return { name: download.suggestedFilename(), files: unpacked(file) };
}

test('a view is saved with its depth', async () => {
  const page = await open(browser, at(view));
  await rested(page);
  await fromMenu(page, 'download-button');
  const { name, files } = await downloaded(page, '#download-view');
  assert.match(name, /^mirage-.*-view\.zip$/);
  const saved = await decode(page, files.get('view.png')), drawn = await picture(page);
  assert.ok(await flip(page, drawn, saved) < 1e-4);
  const facts = JSON.parse(files.get('view.json'));
  const depth = files.get('depth.png');
  assert.deepEqual([facts.width, facts.height], [drawn.width, drawn.height]);
  assert.deepEqual([...depth.subarray(16, 25)], [0, 0, drawn.width >> 8, drawn.width & 255, 0, 0, drawn.height >> 8, drawn.height & 255, 16]);
  // The knot lies within 2 m of the origin, 6.1 m before the eye; a corner shows nothing.
  const rows = inflateSync(depth.subarray(8 + 25 + 8, depth.length - 12 - 4));
  const value = (x, y) => rows.readUInt16BE(y * (1 + 2 * drawn.width) + 1 + 2 * x);
  const metres = (x, y) => facts.depth.near_m * 65535 / value(x, y);
  const seen = [];
  for (let y = 0; y < drawn.height; y += 4) for (let x = 0; x < drawn.width; x += 4) if (value(x, y) > 0) seen.push(metres(x, y));
  assert.ok(seen.length > 500, `${seen.length} points`);
  assert.ok(Math.min(...seen) > 3.5 && Math.min(...seen) < 5.5, `nearest ${Math.min(...seen)}`);
  assert.deepEqual(facts.eye_m.map((v) => Math.round(v * 1000) / 1000), [0, 1, 6]);
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('an object is saved as a bake, a place as a folder', async () => {
  const page = await open(browser, at(view));
  await rested(page);
  await fromMenu(page, 'download-button');
  await page.waitForSelector('#bake:not([hidden])');
  await page.locator('#bake-what').selectOption('whole');
  await page.locator('#bake-target').selectOption('three');
  await page.locator('#bake-size').selectOption('8x1024');
  const bake = await downloaded(page, '#download-bake');
  assert.match(bake.name, /^knot-three\.zip$/);
  assert.ok(bake.files.has('index.json'), [...bake.files.keys()].join());
  assert.match(await page.locator('#download-line').textContent(), /is saved/);
  await page.locator('#folder-mb').selectOption('5');
  const place = await downloaded(page, '#download-folder', 200);
  assert.match(place.name, /^knot-folder\.zip$/);
  assert.ok(place.files.has('index.html') && place.files.has('frozen.bin'));
  assert.deepEqual(await barriers(page), []);
  await page.locator('#download-close').click();
  await until('it is closed', () => page.locator('#download').isHidden());
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('a download that is stopped, or refused, says so', async () => {
  const page = await open(browser, at(view));
  await rested(page);
  await fromMenu(page, 'download-button');
  await page.waitForSelector('#folder:not([hidden])');
  await page.locator('#folder-mb').selectOption('50');
  await page.locator('#download-folder').click();
  await page.waitForSelector('#download-stop:not([hidden])');
  await page.locator('#download-stop').click();
  assert.equal(await page.locator('#download-line').textContent(), 'Stopped.');
  assert.equal(await page.locator('#download-folder').isDisabled(), false);
  await page.route('**/v1/download?*', (route) => route.fulfill({ status: 400, contentType: 'text/plain', body: '<b>no</b>\n' }));
  await page.locator('#download-bake').click();
  await until('the reason', async () => (await page.locator('#download-line').textContent()) === 'It was not made: <b>no</b>');
  await page.context().close();
  const closed = await serve('builtin:knot', ['--no-downloads']);
  const other = await open(browser, closed.url);
  await rested(other);
  await fromMenu(other, 'download-button');
  await other.waitForSelector('#download-none:not([hidden])');
  assert.ok(await other.locator('#bake').isHidden() && await other.locator('#folder').isHidden());
  await other.context().close();
  await closed.stop();
});
