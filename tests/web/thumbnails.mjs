// Times of a page with 100 thumbnails of one scene, each from another place: bytes, and seconds until
// all are there, first while the server draws them and then again. Run by hand on a machine that does
// nothing else:
//   WEB_BIN=build/release/bin WEB_MODULES=build/web-tests node tests/web/thumbnails.mjs [SCENE] [SIZE] [SAMPLES]
import http from 'node:http';
import { launch, serve } from './harness.mjs';

const [scene = 'builtin:forest', size = '160x90', samples = '2'] = process.argv.slice(2);
const count = 100;
const server = await serve(scene);
const [width, height] = size.split('x');
const images = Array.from({ length: count }, (_, i) => {
  const turn = 2 * Math.PI * i / count;
  const look = [-20 + Math.cos(turn), 1.7, Math.sin(turn)].map((v) => v.toFixed(3)).join(',');
  return `<img width="${width}" height="${height}" src="${server.url}v1/picture?eye=-20,1.7,0&amp;look=${look}&amp;size=${size}&amp;samples=${samples}">`;
});
const portal = http.createServer((_, reply) => reply.writeHead(200, { 'content-type': 'text/html' }).end(images.join('\n')));
await new Promise((done) => { portal.listen(0, '127.0.0.1', done); });
const browser = await launch();
for (const state of ['cold', 'warm']) {
  const context = await browser.newContext();  // with an empty cache
  const page = await context.newPage();
  let bytes = 0, failed = 0;
  page.on('response', (answer) => {
    if (!answer.url().includes('/v1/picture')) return;
    if (answer.ok()) bytes += Number(answer.headers()['content-length']);
    else ++failed;
  });
  const began = Date.now();
  await page.goto(`http://127.0.0.1:${portal.address().port}/`, { timeout: 120000 });
  const seconds = (Date.now() - began) / 1000;
  const drawn = await page.evaluate(() => [...document.images].filter((image) => image.naturalWidth > 0).length);
  console.log(`${state}: ${drawn} of ${count} thumbnails of ${scene} at ${size}, ${(bytes / 1e6).toFixed(2)} MB, ${seconds.toFixed(2)} s; ${failed} refused`);
  await context.close();
}
await browser.close();
process.exit(0);
