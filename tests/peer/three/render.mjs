// node render.mjs OPTIONS.json OUT.png: renders a glTF file with three.js in headless Chromium.
// OPTIONS: model, environment (.hdr, .exr or null), width, height, eye, target (metres),
// fov (vertical, degrees), background (linear r, g, b).
import { createServer } from 'node:http';
import { createReadStream, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, dirname, extname, join, normalize, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

const here = dirname(fileURLToPath(import.meta.url));
const [, , optionsFile, target] = process.argv;
const options = JSON.parse(readFileSync(optionsFile, 'utf8'));
const roots = {
  '/three/': join(here, 'node_modules/three'),
  '/model/': dirname(resolve(options.model)),
};
if (options.environment) roots['/environment/'] = dirname(resolve(options.environment));
const types = { '.mjs': 'text/javascript', '.js': 'text/javascript', '.html': 'text/html',
  '.wasm': 'application/wasm', '.json': 'application/json', '.gltf': 'model/gltf+json' };

function fileOf(url) {
  const path = decodeURIComponent(new URL(url, 'http://localhost').pathname);
  for (const [prefix, root] of Object.entries(roots)) {
    if (!path.startsWith(prefix)) continue;
    const file = normalize(join(root, path.slice(prefix.length)));
    return file.startsWith(root) ? file : null;
  }
  return path === '/page.html' || path === '/page.mjs' ? join(here, path) : null;
}

const server = createServer((request, response) => {
  const file = fileOf(request.url);
  if (!file || !statSync(file, { throwIfNoEntry: false })?.isFile()) {
    response.writeHead(404).end();
    return;
  }
  response.writeHead(200, { 'content-type': types[extname(file)] ?? 'application/octet-stream' });
  createReadStream(file).pipe(response);
});
await new Promise((ready) => server.listen(0, '127.0.0.1', ready));
const profile = mkdtempSync(join(tmpdir(), 'three-'));
const browser = await chromium.launchPersistentContext(profile, {
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  headless: true,
  viewport: { width: options.width, height: options.height },
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader',
    '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run',
    '--disable-background-networking', '--disable-component-update', '--disable-sync'],
});
let failed = null;
try {
  const page = await browser.newPage();
  page.on('console', (line) => { if (line.type() === 'error') console.error(line.text()); });
  const asked = { ...options, model: '/model/' + encodeURIComponent(basename(options.model)),
    environment: options.environment && '/environment/' +
      encodeURIComponent(basename(options.environment)) };
  await page.goto(`http://127.0.0.1:${server.address().port}/page.html#` +
    encodeURIComponent(JSON.stringify(asked)));
  await page.waitForFunction(() => window.drawn, null, { timeout: 120000 });
  const drawn = await page.evaluate(() => window.drawn);
  if (drawn !== 'yes') throw new Error(drawn);
  const data = await page.evaluate(() => document.querySelector('canvas').toDataURL('image/png'));
  writeFileSync(target, Buffer.from(data.slice(data.indexOf(',') + 1), 'base64'));
} catch (error) {
  failed = error;
}
await browser.close();
server.close();
rmSync(profile, { recursive: true, force: true });
if (failed) {
  console.error(`error: ${failed.message ?? failed}`);
  process.exit(1);
}
