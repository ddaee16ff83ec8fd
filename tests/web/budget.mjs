// A walk within a budget, browser beside native: FLIP to the server's full render of the same views. Run by hand:
//   WEB_BIN=build/release/bin WEB_MODULES=build/web-tests node tests/web/budget.mjs [SCENE] [MS]
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { bin, drawnBy, flip, launch, open, percentile, picture, pose, scratch, seen, serve, sleep, truth, until, figures } from './harness.mjs';

const [scene = 'builtin:forest', budget = '50'] = process.argv.slice(2);
const speed = 1.4, seconds = 12, every = 1.5;  // m/s on the level, s, s

const server = await serve(scene);
const browser = await launch(drawnBy('swiftshader'));
const first = await open(browser, server.url);
await seen(first, 60);
const { eye, ahead: [ax, , az] } = await pose(first);
await first.context().close();
const level = Math.hypot(ax, az), ahead = [ax / level, 0, az / level];
const at = (t) => eye.map((v, i) => v + ahead[i] * speed * t);

async function browserWalk() {
  const page = await open(browser, `${server.url}#eye=${eye.join(',')}&look=${eye.map((v, i) => v + ahead[i]).join(',')}&budget=${budget}`);
  await seen(page, 60);
  await page.evaluate(({ from, to, metres }) => {
    const tick = mirage.tick.bind(mirage);
    let began = 0;
    globalThis.walked = globalThis.drawnAt = 0;
    mirage.tick = (now) => {
      began ||= now;
      globalThis.walked = metres * (now - began) / 1000;
      const here = from.map((v, i) => v + to[i] * walked);
      mirage.core._page_look(...here, ...here.map((v, i) => v + to[i]));
      const before = mirage.core._page_drawn_frames();
      tick(now);
      if (mirage.core._page_drawn_frames() !== before) globalThis.drawnAt = walked;
    };
    mirage.wake();
  }, { from: eye, to: ahead, metres: speed });
  const seenThen = [];
  for (let t = every; t < seconds; t += every) {
    await until('the next place', () => page.evaluate((metres) => walked >= metres, speed * t), 60);
    const drawn = await picture(page);
    seenThen.push({ drawn, from: at(drawn.walked / speed), scale: (await figures(page)).scale });
  }
  await page.evaluate(() => { mirage.frames.splice(0, mirage.frames.length >> 2); });
  const frames = await page.evaluate(() => mirage.frames);
  await page.context().close();
  const out = [];
  for (const { drawn, from, scale } of seenThen) {
    const still = await open(browser, `${server.url}#eye=${from.join(',')}&look=${from.map((v, i) => v + ahead[i]).join(',')}`);
    await seen(still, 60);
    const mean = await flip(still, await truth(still), drawn);
    console.log(`browser, ${Math.hypot(...from.map((v, i) => v - eye[i])).toFixed(1)} m: FLIP ${mean.toFixed(4)} at scale ${scale}`);
    out.push(mean);
    await still.context().close();
  }
  return { out, frames };
}

function nativeWalk() {
  const yaw = Math.atan2(-ahead[0], -ahead[2]) * 180 / Math.PI;
  const line = (t) => `${at(t).join(' ')} 0 ${yaw} 0 ${1000 * t}`;
  const folder = scratch(), path = join(folder, 'path'), stats = join(folder, 'stats.json');
  writeFileSync(path, `${line(0)}\n${line(seconds)}\n`);
  execFileSync(join(bin, 'mirage-view'), [`ws://127.0.0.1:${server.port}`, '--offscreen', '640x360', '--gles', '--path', path, '--frame-ms', budget,
    '--fps', '20', '--frames', String(20 * seconds), '--reference', String(20 * every), '--reference-samples', '4', '--stats', stats], { stdio: 'ignore' });
  return JSON.parse(readFileSync(stats, 'utf8'));
}

await browserWalk();  // so that the server has rendered everything before
const ours = await browserWalk();
const native = nativeWalk();
const mean = ours.out.reduce((a, b) => a + b) / ours.out.length;
console.log(`browser: FLIP ${mean.toFixed(4)}, frames p50 ${percentile(ours.frames, 0.5).toFixed(1)}, p95 ${percentile(ours.frames, 0.95).toFixed(1)} ms`);
console.log(`native on GLES: FLIP ${native.quality.flip.mean.toFixed(4)}, frames p50 ${native.frame_ms.p50.toFixed(1)}, p95 ${native.frame_ms.p95.toFixed(1)} ms`);
await browser.close();
process.exit(0);
