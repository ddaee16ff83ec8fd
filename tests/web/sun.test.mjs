// The sun sweeps over relit impostors in a browser: with shadows, without, and in the full render.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { figures, launch, open, picture, serve, sleep, stopAll, truth, until } from './harness.mjs';

const scene = 'builtin:city?blocks=2';
const width = 480, height = 270;
const view = '#eye=0,42,78&look=8,12,0&budget=0';
const suns = [[140, 50], [170, 35], [200, 50], [230, 30]];  // azimuth, elevation, degrees; the eye looks along azimuth 0
// Left, top, right, bottom of five things there, px.
const things = { 'left tower': [0, 60, 40, 200], 'right tower': [75, 75, 150, 250], 'glass tower': [140, 14, 185, 95], offices: [238, 78, 282, 140], ground: [400, 120, 470, 170] };
const mostApart = 0.03;
const sameShare = 0.02;  // a place is lit if shadows change its luminance by less than this share

let browser;
before(async () => { browser = await launch(); });
after(async () => {
  await browser?.close();
  stopAll();
});

// Returns an sRGB pixel's luminance under Rec. 709, 0 to 1.
function luminance(rgba, i) {
  const linear = (byte) => { const v = byte / 255; return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; };
  return 0.2126 * linear(rgba[i]) + 0.7152 * linear(rgba[i + 1]) + 0.0722 * linear(rgba[i + 2]);
}

const turn = (page, sun) => page.evaluate((to) => mirage.place.changeLight(to), sun);

// Turns the sun until impostors are relit: lit ones give way only under a light that goes on
// changing.
async function relight(page) {
  let azimuth = 90;
  await until('relit impostors', async () => {
    await turn(page, [azimuth += 7, 45]);
    await sleep(400);
    const f = await figures(page);
    return f.relit > 0.9 * f.impostors;
  }, 60);
}

// Returns the picture under this sun and its full render, once all tiles for it are there. It moves
// by a hundredth of a degree every two seconds, which keeps impostors relit.
async function under(page, [azimuth, elevation]) {
  let asked = 0, settled = 0;
  await until('shadows', async () => {
    if (asked % 10 === 0) await turn(page, [azimuth + 0.001 * asked, elevation]);
    ++asked;
    await sleep(200);
    const f = await figures(page);
    settled = f.inFlight === 0 ? settled + 1 : 0;
    return settled > 2;
  }, 60);
  const f = await figures(page);
  assert.ok(f.relit > 0.9 * f.impostors && f.meshes === 0, `${f.relit} of ${f.impostors} impostors are relit`);
  return { drawn: await picture(page), full: await truth(page) };
}

async function sweep(shadows) {
  const server = await serve(scene, ['--no-geometry', '--references', '--shadows', shadows]);
  const page = await open(browser, `${server.url}${view}`, { width, height });
  await until('tiles', async () => { const f = await figures(page); return f?.complete && f.impostors > 50 && f.inFlight === 0; }, 60);
  await relight(page);
  const out = [];
  for (const sun of suns) out.push(await under(page, sun));
  assert.deepEqual(page.problems, []);
  await page.context().close();
  await server.stop();
  return out;
}

// Returns the mean luminance of each picture over the lit places of a thing.
function litMeans([left, top, right, bottom], on, off) {
  const sums = { on: 0, off: 0, full: 0, lit: 0 };
  for (let y = top; y < bottom; ++y) {
    for (let x = left; x < right; ++x) {
      const i = 4 * (y * width + x);
      const full = luminance(on.full.rgba, i), plain = luminance(off.full.rgba, i);
      if (Math.abs(full - plain) > sameShare * plain) continue;
      sums.on += luminance(on.drawn.rgba, i);
      sums.off += luminance(off.drawn.rgba, i);
      sums.full += full;
      ++sums.lit;
    }
  }
  const area = (right - left) * (bottom - top);
  return { on: sums.on / sums.lit, off: sums.off / sums.lit, full: sums.full / sums.lit, share: sums.lit / area };
}

test('relit impostors follow the sun, with and without shadows', async () => {
  const on = await sweep('on'), off = await sweep('off');
  console.log('thing, sun: lit share, luminance with shadows, without, in the full render');
  const wrong = [];
  for (const [name, box] of Object.entries(things)) {
    const seen = suns.map((sun, i) => litMeans(box, on[i], off[i]));
    for (const [i, s] of seen.entries()) {
      const line = `${name}, ${suns[i].join('/')}: ${s.share.toFixed(2)} ${[s.on, s.off, s.full].map((v) => v.toFixed(4)).join(' ')}`;
      console.log(line);
      if (s.share < 0.5 || [s.on, s.off].some((v) => Math.abs(v - s.full) > mostApart * s.full)) wrong.push(line);
    }
    const full = seen.map((s) => s.full);
    assert.ok(Math.max(...full) > 1.05 * Math.min(...full), `the sun changes the ${name}`);
  }
  assert.deepEqual(wrong, []);
});
