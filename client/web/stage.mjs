// Stages the page as a server serves it: index.html, and everything else under a name that changes
// with any of it; impostor.js, which pages of other sites use, also beside index.html. What the first
// picture needs stands in index.html itself: style.css and first.js. Everything is also compressed in
// advance.
//   node stage.mjs SITE_FOLDER BUILT_FOLDER TARGET_FOLDER
import { createHash } from 'node:crypto';
import { mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { brotliCompressSync, constants, gzipSync } from 'node:zlib';

const [site, built, target] = process.argv.slice(2);
const parts = new Map();
const inside = ['style.css', 'first.js'];
for (const name of readdirSync(site).sort()) if (name !== 'index.html' && !inside.includes(name)) parts.set(name, readFileSync(join(site, name)));
for (const name of ['mirage.js', 'mirage.wasm']) parts.set(name, readFileSync(join(built, name)));

// Comments stay out of the page. A script of its own block keeps its names to itself.
const [style, first] = inside.map((name) => readFileSync(join(site, name), 'utf8').replace(/^\/\/.*\n/gm, ''));
const page = readFileSync(join(site, 'index.html'), 'utf8')
  .replace('@style', () => `<style>${style}</style>`).replace('@first', () => `<script>{\n${first}}</script>`);
const hash = createHash('sha256').update(page);
for (const [name, bytes] of parts) hash.update(name).update(bytes);
const folder = `w-${hash.digest('hex').slice(0, 16)}`;

rmSync(target, { recursive: true, force: true });
mkdirSync(join(target, folder), { recursive: true });
let raw = 0, gzip = 0, brotli = 0;
function put(name, bytes) {
  const small = gzipSync(bytes, { level: 9 });
  const smaller = brotliCompressSync(bytes, { params: { [constants.BROTLI_PARAM_QUALITY]: 11, [constants.BROTLI_PARAM_LGWIN]: 22 } });
  writeFileSync(join(target, name), bytes);
  writeFileSync(join(target, `${name}.gz`), small);
  writeFileSync(join(target, `${name}.br`), smaller);
  raw += bytes.length;
  gzip += small.length;
  brotli += smaller.length;
}
for (const [name, bytes] of parts) put(join(folder, name), bytes);
put('impostor.js', parts.get('impostor.js'));
// The page asks for all modules at once, not as one finds the next; but for these, which it does not need at first.
const later = ['viewer.js', 'socket_worker.js', 'download.js', 'archive.js'];
const modules = [...parts.keys()].filter((name) => name.endsWith('.js') && !later.includes(name))
  .map((name) => `<link rel="modulepreload" href="@/${name}">`).join('\n');
put('index.html', Buffer.from(page.replace('@modules', modules).replaceAll('@wasm-bytes', String(parts.get('mirage.wasm').length)).replaceAll('@/', `${folder}/`)));
const kb = (bytes) => `${(bytes / 1000).toFixed(0)} KB`;
console.log(`${target}: ${parts.size + 1} files, ${kb(raw)}, gzip ${kb(gzip)}, brotli ${kb(brotli)}`);
