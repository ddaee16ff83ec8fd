// Browser beside native, at rest, the same view, size and budget (none): FLIP of the two. Run by hand:
//   WEB_BIN=build/release/bin WEB_MODULES=build/web-tests node tests/web/equal.mjs [SCENE…]
// Prints a line a view, and leaves the pair in the folder it names (browser.ppm, and native as the last PNG).
// WEB_ANGLE=gl-egl has both drawn by the same rasterizer: what is left is Mirage's.
import { execFileSync } from 'node:child_process';
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { bin, decode, flip, launch, open, picture, pose, rested, scratch, seen, serve } from './harness.mjs';

const scenes = process.argv.slice(2);
if (!scenes.length) scenes.push('builtin:knot', 'builtin:forest', 'builtin:clutter', 'builtin:city');
const frames = 150;  // 15 s: everything has arrived, and is refined

// Returns five views around the scene's own: home, turned to both sides, nearer, higher.
function views({ eye, ahead }, reach) {
  const turned = (angle) => [ahead[0] * Math.cos(angle) - ahead[2] * Math.sin(angle), ahead[1], ahead[0] * Math.sin(angle) + ahead[2] * Math.cos(angle)];
  const from = (e, a) => `#eye=${e.map((v) => v.toFixed(4)).join(',')}&look=${e.map((v, i) => (v + a[i]).toFixed(5)).join(',')}`;
  const near = eye.map((v, i) => v + 0.3 * reach * ahead[i]);
  const high = [eye[0], eye[1] + 0.2 * reach, eye[2]];
  return [from(eye, ahead), from(eye, turned(0.5)), from(eye, turned(-0.7)), from(near, ahead), from(high, [ahead[0], ahead[1] - 0.2, ahead[2]])];
}

const browser = await launch();
let worst = -1;
for (const scene of scenes) {
  const server = await serve(scene);
  const first = await open(browser, server.url);
  await seen(first, 120);
  const home = await pose(first);
  const reach = await first.evaluate(() => mirage.core._page_home_distance());
  await first.context().close();
  for (const [index, hash] of views(home, reach).entries()) {
    const page = await open(browser, `${server.url}${hash}&budget=0`);
    await rested(page, 300);
    const ours = await picture(page);
    const out = scratch();
    execFileSync(join(bin, 'mirage-view'), [`ws://127.0.0.1:${server.port}`, '--offscreen', '640x360', '--gles', '--path', hash,
      '--frames', String(frames), '--fps', '10', '--virtual-time', '--frame-ms', '0', '--out', out], { stdio: 'ignore' });
    const native = await decode(page, readFileSync(join(out, readdirSync(out).filter((name) => name.endsWith('.png')).sort().at(-1))));
    writeFileSync(join(out, 'browser.ppm'), Buffer.concat([Buffer.from(`P6 ${ours.width} ${ours.height} 255\n`),
      Buffer.from(ours.rgba.filter((_, i) => i % 4 !== 3))]));
    const mean = await flip(page, native, ours);
    console.log(`${scene} ${index} FLIP ${mean.toFixed(5)} ${hash} ${out}`);
    worst = Math.max(worst, mean);
    await page.context().close();
  }
  await server.stop();
}
console.log(`worst ${worst.toFixed(5)}`);
await browser.close();
process.exit(worst <= 0.01 ? 0 : 1);
