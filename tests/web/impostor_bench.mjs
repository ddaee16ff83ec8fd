// Bakes, and the page that draws them, for impostors.test.mjs and impostor_error.mjs.
import { execFileSync } from 'node:child_process';
import { readFileSync, rmSync } from 'node:fs';
import { basename, join } from 'node:path';
import { bin, scratch } from './harness.mjs';

const here = import.meta.dirname;

export const hostPage = `<!doctype html><html lang="en"><title>impostors</title><link rel="icon" href="data:,">
<script type="importmap">{ "imports": { "three": "/modules/three/build/three.module.js", "three/addons/": "/modules/three/examples/jsm/" } }</script>
<script type="module" src="/host.js"></script></html>`;

/// Returns the addresses of a site that serves the page and these models.
export const hostFiles = (models) => ({
  '/host.js': join(here, 'impostor_host.js'), '/example/': join(here, '../../examples/impostors-three'),
  ...Object.fromEntries(models.filter((model) => model !== 'knot').map((model) => [`/models/${basename(model)}`, model])) });

/// Bakes a model: 'knot' or a file. Returns its JSON and its pictures by file.
export function bakeOf(model, options = []) {
  const out = scratch();
  try {
    execFileSync(join(bin, 'mirage-bake'), [model === 'knot' ? 'builtin:knot' : model, '--whole', '--maps', 'color,normal', '--measure', 'none', '--out', out, ...options],
      { stdio: ['ignore', 'ignore', 'pipe'] });
    const index = JSON.parse(readFileSync(join(out, 'index.json'), 'utf8')), name = index.objects[0].object;
    const json = readFileSync(join(out, `${name}.json`), 'utf8');
    const pictures = Object.fromEntries(JSON.parse(json).maps.map(({ file }) => [file, readFileSync(join(out, file))]));
    return { name, json, pictures };
  } finally {
    rmSync(out, { recursive: true, force: true });
  }
}
