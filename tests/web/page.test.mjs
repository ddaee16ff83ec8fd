// The page in a real browser, with the shipped server: what a person does, and what goes wrong.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { createHash } from 'node:crypto';
import { brotliDecompressSync, gunzipSync } from 'node:zlib';
import http from 'node:http';
import { copyFileSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { barriers, bin, figures, flip, hostSite, launch, message, open, picture, pose, relay, rested, scratch, screen, seen, serve, poseAtRest, sleep, stopAll, truth, until, write, decode } from './harness.mjs';

let browser, knot;
const apart = (a, b) => Math.hypot(...a.map((v, i) => v - b[i]));
const at = (hash) => `${knot.url}${hash}`;
const view = '#eye=0,1,6&look=0,0.5,0';
// No budget: a picture at rest does not depend on how long frames take here.
const settled = `${view}&budget=0`;

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

// Gets the answer as sent, not as a browser would unpack it.
const get = (url, headers = {}) => new Promise((done, fail) => {
  http.get(url, { headers }, (answer) => {
    const parts = [];
    answer.on('data', (part) => parts.push(part));
    answer.on('end', () => done({ status: answer.statusCode, headers: answer.headers, body: Buffer.concat(parts) }));
  }).on('error', fail);
});

test('the page is served compressed, its parts for ever, itself never from a cache', async () => {
  await until('its poster', async () => (await get(knot.url)).body.includes('id="poster"'));
  const plain = await get(knot.url);
  assert.equal(plain.status, 200);
  assert.equal(plain.headers['content-encoding'], undefined);
  assert.equal(plain.headers['cache-control'], 'no-cache');
  assert.equal(plain.headers['x-content-type-options'], 'nosniff');
  const policy = plain.headers['content-security-policy'];
  assert.match(policy, /default-src 'none'/);
  assert.doesNotMatch(policy, /unsafe-inline|'unsafe-eval'|\*/);
  // Style and script in the page are allowed by their hashes, and nothing else.
  const text = plain.body.toString();
  assert.doesNotMatch(text, /<script type="module">|style="| on[a-z]+="/);
  const inside = [...text.matchAll(/<(style|script)>(.*?)<\/\1>/gs)];
  assert.deepEqual(inside.map((found) => found[1]), ['style', 'script']);
  for (const [, , body] of inside) assert.ok(policy.includes(`'sha256-${createHash('sha256').update(body).digest('base64')}'`));
  const gzip = await get(knot.url, { 'Accept-Encoding': 'gzip' });
  assert.deepEqual(gunzipSync(gzip.body), plain.body);
  const named = [...plain.body.toString().matchAll(/(?:src|href)="([^"#][^"]*)"/g)].map((found) => found[1]);
  // The poster is in the page, and the address of what other sites show is for them.
  const names = named.filter((name) => !name.startsWith('data:image/webp;') && !name.startsWith(`${knot.url}v1/oembed?`));
  assert.equal(named.length, names.length + 2);
  assert.ok(names.length >= 4);
  for (const name of names) {
    assert.doesNotMatch(name, /^(https?:)?\/\//, 'from this host alone');
    const whole = await get(knot.url + name);
    const small = await get(knot.url + name, { 'Accept-Encoding': 'gzip, br' });
    assert.match(whole.headers['cache-control'], /immutable/);
    assert.deepEqual(brotliDecompressSync(small.body), whole.body, name);
  }
  assert.equal((await get(`${knot.url}../etc/passwd`)).status, 404);
  assert.equal((await get(`${knot.url}nothing`)).status, 404);
  const strange = await get(knot.url, { Host: "x; script-src 'unsafe-inline'" });
  assert.doesNotMatch(strange.headers['content-security-policy'] ?? '', /unsafe-inline/);
});

test('a picture comes, and what is on the screen is what was drawn', async () => {
  const page = await open(browser, at(view));
  await rested(page);
  assert.match(await page.title(), /^Mirage: /);
  const drawn = await picture(page), shown = await screen(page);
  assert.equal(shown.width, 640);
  assert.ok(await flip(page, drawn, shown) < 0.002);
  let other = 0;
  for (let i = 0; i < drawn.rgba.length; i += 4) other += drawn.rgba[i] - drawn.rgba[i + 2] > 20 ? 1 : 0;  // the knot is red
  assert.ok(other > 2000, `${other} px of a knot`);
  assert.equal(await message(page), '');
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('at rest nothing is drawn and the page sleeps', async () => {
  const page = await open(browser, at(view));
  const { drawnFrames } = await rested(page);
  await page.evaluate(() => { globalThis.asked = 0; const real = requestAnimationFrame; globalThis.requestAnimationFrame = (f) => { ++asked; return real(f); }; });
  await sleep(1500);
  assert.equal((await figures(page)).drawnFrames, drawnFrames);
  assert.equal(await page.evaluate(() => asked), 0);
  await page.context().close();
});

// The graphics card answers a query only when all earlier drawing is done; the page would stand
// still for it.
test('frames ask the graphics card nothing', async () => {
  const page = await open(browser, at(settled), { before: () => {
    globalThis.waited = {};
    for (const name of ['getParameter', 'getError', 'readPixels', 'checkFramebufferStatus', 'isEnabled', 'finish', 'getBufferSubData',
      'getProgramParameter', 'getShaderParameter', 'getUniform', 'getFramebufferAttachmentParameter', 'getTexParameter', 'clientWaitSync']) {
      const real = WebGL2RenderingContext.prototype[name];
      WebGL2RenderingContext.prototype[name] = function ask(...args) {
        const disjoint = name === 'getParameter' && args[0] === 0x8FBB;  // known without asking
        if (!disjoint) waited[name] = (waited[name] ?? 0) + 1;
        return real.apply(this, args);
      };
    }
  } });
  await rested(page);
  assert.ok(await page.evaluate(() => waited.getParameter > 0), 'it is counted');
  const { drawnFrames } = await figures(page);
  await page.evaluate(() => { for (const name in waited) delete waited[name]; });
  await page.locator('#mirage').focus();
  await page.keyboard.down('ArrowLeft');
  await sleep(1000);
  const asked = await page.evaluate(() => ({ ...waited }));
  await page.keyboard.up('ArrowLeft');
  assert.ok((await figures(page)).drawnFrames > drawnFrames + 5);
  assert.deepEqual(asked, {});
  await page.context().close();
});

// A display that saves power asks for pictures seldom. Frames are not late for that, and their plan
// keeps what it has.
test('a display that calls seldom takes nothing away', async () => {
  const forest = await serve('builtin:forest?trees=60');
  const page = await open(browser, `${forest.url}#budget=60`, { before: () => {
    globalThis.every = 1;
    const real = globalThis.requestAnimationFrame.bind(globalThis);
    globalThis.requestAnimationFrame = (f) => {
      let left = globalThis.every;
      const step = (at) => { --left > 0 ? real(step) : f(at); };
      return real(step);
    };
  } });
  await seen(page, 60);
  await page.locator('#mirage').focus();
  await page.keyboard.down('ArrowLeft');
  await sleep(4000);
  const before = (await figures(page)).mostMs;
  await page.evaluate(() => { globalThis.every = 12; });
  await sleep(8000);
  const after = (await figures(page)).mostMs;
  await page.keyboard.up('ArrowLeft');
  assert.ok(after > 0.8 * before, `${before} ms planned at most, then ${after}`);
  await page.context().close();
  await forest.stop();
});

test('keys move, the mouse turns about what is under it, pans and flies, the wheel goes nearer', async () => {
  const page = await open(browser, at(view));
  await rested(page);
  const start = await pose(page);
  await page.locator('#mirage').focus();
  await page.keyboard.down('KeyW');
  await sleep(400);
  await page.keyboard.up('KeyW');
  const ahead = await pose(page);
  const along = start.ahead.reduce((sum, v, i) => sum + v * (ahead.eye[i] - start.eye[i]), 0);
  assert.ok(along > 0.05, `${along} m ahead`);
  assert.ok(Math.abs(apart(start.eye, ahead.eye) - along) < 1e-3, 'straight ahead');
  await page.keyboard.down('KeyQ');
  await sleep(200);
  await page.keyboard.up('KeyQ');
  assert.ok((await pose(page)).eye[1] < ahead.eye[1], 'Q goes down');

  await page.keyboard.down('KeyX');
  await sleep(200);
  await page.keyboard.up('KeyX');
  await page.keyboard.press('KeyH');
  const before = await pose(page);
  const yawOf = ({ ahead: way }) => Math.atan2(way[0], -way[2]);
  const drag = async (button, to) => {
    await page.mouse.move(320, 180);
    await page.mouse.down({ button });
    await page.mouse.move(...to, { steps: 5 });
    await page.mouse.up({ button });
  };
  await drag('left', [420, 180]);
  await until('turned', async () => apart((await pose(page)).ahead, before.ahead) > 0.8);
  const turned = await poseAtRest(page);
  const yaw = yawOf(turned) - yawOf(before);
  assert.ok(Math.abs(yaw - 3.14 * 100 / 360) < 0.01, `a drag over the height turns by half a circle, here ${yaw}`);
  assert.ok(Math.abs(turned.ahead[1] - before.ahead[1]) < 0.01, 'level');
  assert.ok(apart(turned.eye, before.eye) > 1, 'the eye goes around');

  await drag('right', [320, 120]);
  await until('shifted', async () => apart((await pose(page)).eye, turned.eye) > 0.05);
  const shifted = await poseAtRest(page);
  assert.ok(shifted.eye[1] < turned.eye[1], 'what is dragged up is looked at from below');
  assert.ok(apart(shifted.ahead, turned.ahead) < 1e-6, 'a pan does not turn');

  await page.keyboard.press('KeyH');
  const home = await pose(page);
  await page.mouse.move(320, 180);
  await page.mouse.wheel(0, -100);
  await until('a step', async () => apart((await pose(page)).eye, home.eye) > 0.05);
  await sleep(600);
  const nearer = await poseAtRest(page);
  await page.mouse.dblclick(320, 180);
  await until('flown', async () => apart((await pose(page)).eye, nearer.eye) > 0.3);

  assert.equal(await page.textContent('#mode'), 'Walk', 'one object is orbited');
  await page.keyboard.press('KeyM');
  assert.equal(await page.textContent('#mode'), 'Orbit');
  await sleep(800);
  const still = await poseAtRest(page);
  await drag('left', [420, 180]);
  await until('looked', async () => apart((await pose(page)).ahead, still.ahead) > 0.25);
  const looked = await poseAtRest(page);
  assert.ok(Math.abs(yawOf(looked) - yawOf(still) + Math.PI / 3 * 100 / 360) < 0.01, 'the picture goes with the hand');
  assert.ok(apart(looked.eye, still.eye) < 1e-9, 'who walks turns in place');
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('feet stay on the ground, walls stop them; G flies and lands', async () => {
  const hall = await serve('builtin:museum?objects=4&triangles=2000');
  const page = await open(browser, `${hall.url}#budget=0`);
  await rested(page);
  const start = await pose(page);
  const hold = async (keys, ms) => {
    for (const key of keys) await page.keyboard.down(key);
    await sleep(ms);
    for (const key of keys) await page.keyboard.up(key);
  };
  await page.locator('#mirage').focus();
  await hold(['KeyV'], 700);  // looks down
  await hold(['ShiftLeft', 'KeyW'], 6000);
  const walked = await pose(page);
  const way = Math.hypot(walked.eye[0] - start.eye[0], walked.eye[2] - start.eye[2]);
  assert.ok(way > 2, `${way} m on the ground`);
  assert.ok(Math.abs(walked.eye[1] - start.eye[1]) < 0.2, `at eye height, ${walked.eye[1]} m and ${start.eye[1]} m before`);
  assert.ok(Math.hypot(walked.eye[0], walked.eye[2]) < 18, 'the wall stops who walks');
  await hold(['KeyQ'], 400);
  assert.ok(Math.abs((await pose(page)).eye[1] - walked.eye[1]) < 0.05, 'Q does not go under the ground');

  await page.keyboard.press('KeyG');
  await until('a word', async () => /Flying/.test(await message(page)));
  await page.keyboard.down('KeyE');
  await until('up', async () => (await pose(page)).eye[1] > walked.eye[1] + 0.5);
  await page.keyboard.up('KeyE');
  const above = await pose(page);
  await page.keyboard.press('KeyG');
  await hold(['KeyS'], 2500);
  const landed = await pose(page);
  assert.ok(Math.abs(landed.eye[1] - start.eye[1]) < 0.3, `landed at ${landed.eye[1]} m`);
  assert.deepEqual(page.problems, []);
  await page.context().close();
  await hall.stop();
});

test('background: a colour behind everything, kept in the address, on top of no object', async () => {
  const page = await open(browser, at(settled));
  await rested(page);
  const own = await picture(page);
  await page.locator('#figures-button').click();
  await page.locator('#background').fill('#3366cc');
  await until('in the address', async () => page.url().includes('&bg=3366cc'));
  await rested(page);
  const blue = await picture(page);
  const at4 = (image, i) => [...image.rgba.subarray(4 * i, 4 * i + 3)];
  let behind = 0, same = 0;
  for (let i = 0; i < blue.width * blue.height; ++i) {
    const near = at4(blue, i).every((v, c) => Math.abs(v - [0x33, 0x66, 0xcc][c]) <= 1);
    behind += near ? 1 : 0;
    same += at4(blue, i).every((v, c) => Math.abs(v - at4(own, i)[c]) <= 2) ? 1 : 0;
  }
  const share = (n) => n / (blue.width * blue.height);
  assert.ok(share(behind) > 0.5 && share(same) > 0.05, `behind ${share(behind)}, as before ${share(same)}`);
  assert.ok(share(behind) + share(same) > 0.98, `and little else: ${share(behind)} + ${share(same)}`);
  await fromMenu(page, 'compare');
  await until('a word', async () => /own background/.test(await message(page)));
  await page.locator('#own-background').click();
  await rested(page);
  assert.ok(await flip(page, own, await picture(page)) < 0.005);
  await page.goto('about:blank');
  await page.goto(at(`${view}&bg=nothing`));
  await until('a word', async () => /bg=nothing/.test(await message(page)));
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('fingers: one turns, two shift and pinch, the stick moves', async () => {
  const page = await open(browser, at(view), { width: 360, height: 640, touch: true });
  await rested(page);
  const session = await page.context().newCDPSession(page);
  const touch = (type, points) => session.send('Input.dispatchTouchEvent', {
    type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  const start = await pose(page);
  await touch('touchStart', [[180, 300]]);
  await touch('touchMove', [[150, 300]]);
  await touch('touchMove', [[120, 300]]);
  await touch('touchEnd', []);
  await until('turned', async () => apart((await pose(page)).ahead, start.ahead) > 0.1);
  const turned = await poseAtRest(page);
  assert.ok(apart(turned.eye, start.eye) > 0.1, 'one finger goes around');

  await touch('touchStart', [[150, 300], [210, 300]]);
  await touch('touchMove', [[110, 300], [250, 300]]);
  await touch('touchMove', [[80, 300], [280, 300]]);
  await touch('touchEnd', []);
  await until('moved', async () => apart((await pose(page)).eye, turned.eye) > 0.05);
  const pinched = await poseAtRest(page);
  const along = turned.ahead.reduce((sum, v, i) => sum + v * (pinched.eye[i] - turned.eye[i]), 0);
  assert.ok(along > 0.05, 'spreading goes ahead');
  assert.ok(apart(pinched.ahead, turned.ahead) < 1e-3, 'two fingers do not turn');

  assert.ok(await page.locator('#stick').isHidden(), 'who orbits needs no stick');
  await page.locator('#mode').tap();
  const box = await page.locator('#stick').boundingBox();
  assert.ok(box && box.width > 80, 'the stick is there for fingers');
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await touch('touchStart', [[x, y]]);
  await touch('touchMove', [[x, y - 50]]);
  await sleep(400);
  const held = await pose(page);
  await touch('touchEnd', []);
  assert.ok(apart(held.eye, pinched.eye) > 0.05, 'the stick moves');
  await sleep(200);
  const let_go = await pose(page);
  await sleep(300);
  assert.ok(apart((await pose(page)).eye, let_go.eye) < 1e-9, 'and stops when it is let go');
  await page.context().close();
});

test('a gamepad moves and looks, and wakes a page at rest', async () => {
  const page = await open(browser, at(view), { before: () => {
    globalThis.pad = { connected: true, axes: [0, 0, 0, 0], buttons: [] };
    navigator.getGamepads = () => [pad];
  } });
  await rested(page);
  const start = await pose(page);
  await page.evaluate(() => { pad.axes = [0, -1, 0.5, 0]; });
  await sleep(500);
  await page.evaluate(() => { pad.axes = [0, 0.1, 0, 0]; });
  const end = await pose(page);
  assert.ok(apart(end.eye, start.eye) > 0.05 && apart(end.ahead, start.ahead) > 0.05);
  await sleep(200);
  const still = await pose(page);
  await sleep(200);
  assert.deepEqual(await pose(page), still, 'what a worn stick says is nothing');
  await page.context().close();
});

test('the address holds the view: a link shows the same, back and forward work', async () => {
  const page = await open(browser, at(settled));
  await rested(page);
  const first = await pose(page);
  assert.ok(apart(first.eye, [0, 1, 6]) < 1e-6);
  await page.locator('#mirage').focus();
  await page.keyboard.down('KeyD');
  await sleep(500);
  await page.keyboard.up('KeyD');
  const moved = await pose(page);
  await until('the address', async () => (await page.url()) !== at(settled));
  const link = page.url();
  assert.match(link, /#eye=[-\d.,]+&look=[-\d.,]+&budget=0$/);
  await rested(page);
  const there = await picture(page);

  const other = await open(browser, link);
  await rested(other);
  assert.ok(apart((await pose(other)).eye, moved.eye) < 1e-3);
  const shown = await picture(other);
  assert.ok(await flip(other, there, shown) < 0.005, 'the same picture');
  await other.context().close();

  await page.goBack();
  await until('back', async () => apart((await pose(page)).eye, first.eye) < 1e-3);
  await page.goForward();
  await until('forward', async () => apart((await pose(page)).eye, moved.eye) < 1e-3);
  await page.locator('#home').click();
  await until('home', async () => apart((await pose(page)).eye, moved.eye) > 0.1);
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('the light is in the address', async () => {
  const page = await open(browser, at(settled));
  await rested(page);
  const own = await picture(page);
  await page.locator('#figures-button').click();
  await page.locator('#azimuth').fill('90');
  await until('another light', async () => page.url().includes('light=90,'));
  await rested(page);
  const turned = await picture(page);
  assert.ok(await flip(page, own, turned) > 0.003, 'it looks different');
  await page.goBack();
  await rested(page);
  assert.ok(await flip(page, own, await picture(page)) < 0.002, 'and back');
  await page.context().close();
});

test('a broken link says so and shows the scene', async () => {
  for (const hash of ['#eye=1,2&look=x', '#eye=1,2,3', '#eye=1,2,3&look=1,2,3', '#nonsense', '#eye=%E0%A4%A&look=1e99,0,0', '#t=-1&light=a,b']) {
    const page = await open(browser, at(hash));
    const told = await until('a message', () => message(page).then((text) => /cannot be read/.test(text) && text), 20);
    assert.doesNotMatch(told, /undefined|NaN/);
    await seen(page, 20);
    assert.deepEqual(page.problems, []);
    await page.context().close();
  }
});

test('sharing gives the link, a screenshot the picture', async () => {
  const page = await open(browser, at(view), { permissions: ['clipboard-read', 'clipboard-write'] });
  await rested(page);
  await page.locator('#share').click();
  const link = await until('a link', () => page.evaluate(() => navigator.clipboard.readText().catch(() => document.getElementById('link').value)));
  assert.match(link, /^http:\/\/127\.0\.0\.1:\d+\/#eye=0,1,6&look=/);
  await page.evaluate(() => Object.defineProperty(navigator, 'clipboard', { value: undefined }));
  await page.locator('#share').click();
  assert.equal(await page.locator('#link').inputValue(), link, 'without a clipboard it can be copied by hand');
  await page.locator('#link-close').click();

  const [download] = await Promise.all([page.waitForEvent('download'), fromMenu(page, 'screenshot')]);
  assert.match(download.suggestedFilename(), /^mirage-.*\.png$/);
  const file = join(scratch(), 'shot.png');
  await download.saveAs(file);
  const saved = await decode(page, readFileSync(file)), drawn = await picture(page);
  assert.equal(saved.width, drawn.width);
  assert.ok(await flip(page, drawn, saved) < 1e-4);
  await page.context().close();
});

test('compare: the full render beside it, FLIP under it', async () => {
  const page = await open(browser, at(view));
  await rested(page);
  await fromMenu(page, 'compare');
  await until('FLIP', async () => /^FLIP 0\.\d{4}/.test(await page.locator('#flip').textContent()), 60);
  const mean = await page.evaluate(() => mirage.compare.mean);
  assert.ok(mean > 0 && mean < 0.05, `FLIP ${mean}`);
  assert.match(await page.locator('#flip').textContent(), /most in the ring, 0\.\d{3}: “.+”/);
  assert.ok(await page.locator('#worst').isVisible());
  await page.evaluate(() => { document.getElementById('worst').hidden = true; });  // it is no part of the pictures below
  await page.locator('#split').fill('0');
  const truth = await screen(page);
  await page.locator('#split').fill('1000');
  const ours = await screen(page);
  assert.ok(await flip(page, await picture(page), ours) < 0.002, 'all Mirage');
  const measured = await flip(page, truth, ours);
  assert.ok(Math.abs(measured - mean) < 0.003, `what is told is what is seen: ${measured}, ${mean}`);
  assert.ok(measured > 0, 'the full render is another picture');
  assert.match(await page.locator('#flip').textContent(), /on objects 0\.\d{4}, and within 0\.\d{3}/);

  // The line stands in the picture, and is dragged there.
  await page.locator('#split').fill('500');
  await page.mouse.move(320, 180);
  await page.mouse.down();
  await page.mouse.move(480, 200, { steps: 4 });
  await page.mouse.up();
  const line = await page.evaluate(() => parseFloat(document.getElementById('truth').style.clipPath.split(' ').at(-1)));
  assert.ok(Math.abs(line - 480) < 8, `the line is at ${line} px`);
  const half = await screen(page);
  const column = (image, x) => Buffer.concat(Array.from({ length: 60 }, (_, y) => Buffer.from(image.rgba.subarray(4 * ((y + 100) * image.width + x), 4 * ((y + 100) * image.width + x) + 3))));
  assert.deepEqual(column(half, 300), column(ours, 300), 'Mirage on its left');
  assert.deepEqual(column(half, 560), column(truth, 560), 'the full render on its right');
  await page.locator('#difference').click();
  await page.locator('#split').fill('0');
  const heat = await screen(page);
  let light = 0;
  for (let i = 0; i < heat.rgba.length; i += 4) light += heat.rgba[i] > 8 ? 1 : 0;
  assert.ok(light > 100 && light < 0.4 * heat.rgba.length / 4, `a difference at edges: ${light} px`);
  await page.keyboard.press('Escape');
  assert.ok(await page.locator('#slider').isHidden());
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('where there are no full renders, comparing says why', async () => {
  const server = await serve('builtin:knot', ['--no-reference']);
  const page = await open(browser, server.url);
  await rested(page);
  await fromMenu(page, 'compare');
  assert.match(await message(page), /makes no full renders/);
  await page.context().close();
  await server.stop();
});

test('the graphics are lost and come back', async () => {
  const page = await open(browser, at(settled));
  await rested(page);
  const before_loss = await picture(page), stood = await pose(page);
  await page.evaluate(() => {
    globalThis.loss = document.getElementById('mirage').getContext('webgl2').getExtension('WEBGL_lose_context');
    loss.loseContext();
  });
  await until('a word', async () => /graphics were reset/.test(await message(page)));
  await page.evaluate(() => loss.restoreContext());
  await rested(page);
  assert.ok(apart((await pose(page)).eye, stood.eye) < 1e-6, 'at the same place');
  assert.ok(await flip(page, before_loss, await picture(page)) < 0.005);
  assert.ok(await flip(page, before_loss, await screen(page)) < 0.005, 'on the screen, too');
  assert.equal(await message(page), '');
  await page.context().close();
});

test('the server is killed and comes back: the picture stays, frames go on', async () => {
  const server = await serve('builtin:clutter');
  const page = await open(browser, server.url);
  await until('tiles', async () => (await figures(page))?.tilesReceived >= 15, 60);
  await server.stop('SIGKILL');
  await until('a word', async () => /server is gone.*trying again/.test(await message(page)));
  const { drawnFrames } = await figures(page);
  await page.locator('#mirage').focus();
  await page.keyboard.down('ArrowLeft');
  await sleep(500);
  await page.keyboard.up('ArrowLeft');
  const f = await figures(page);
  assert.ok(f.drawnFrames > drawnFrames, 'it can be walked through');
  assert.ok(f.impostors + f.meshes > 0, 'with what is here');
  const back = await serve('builtin:clutter', [], server.port);
  await until('reconnected', async () => (await figures(page)).connected && (await message(page)) === '', 30);
  const { tilesReceived } = await figures(page);
  await page.keyboard.down('ArrowRight');
  await until('tiles of the new server', async () => (await figures(page)).tilesReceived > tilesReceived, 60);
  await page.keyboard.up('ArrowRight');
  await page.context().close();
  await back.stop();
});

test('tokens: asked for in a field, refused with a word, never in the address or a log', async () => {
  const file = write(join(scratch(), 'tokens'), 'right-token-4711 name=somebody\n');
  const server = await serve('builtin:knot', ['--token-file', file]);
  const page = await open(browser, server.url);
  await page.locator('#token-form').waitFor({ state: 'visible' });
  await page.locator('#token').fill('wrong-token-0815');
  await page.keyboard.press('Enter');
  await until('refused', async () => /does not know this token/.test(await message(page)));
  await sleep(1100);  // a server makes clients that guess wait
  await page.locator('#token').fill('right-token-4711');
  await page.keyboard.press('Enter');
  await rested(page);
  assert.doesNotMatch(page.url(), /token/);
  await page.reload();
  await rested(page);
  await page.context().close();

  const requests = [];
  const context = await browser.newContext({ viewport: { width: 640, height: 360 } });
  const linked = await context.newPage();
  linked.on('request', (request) => requests.push(request.url()));
  await linked.goto(`${server.url}#token=right-token-4711&eye=0,1,6&look=0,0.5,0`);
  await rested(linked);
  assert.doesNotMatch(linked.url(), /token/, 'gone from the address');
  assert.match(linked.url(), /eye=0,1,6/);
  assert.ok(requests.every((url) => !new URL(url).search && !url.split('#')[0].includes('4711')), 'in no request line');
  assert.doesNotMatch(server.log.join(''), /4711|0815/, 'in no log');
  await context.close();
  await server.stop();
});

test('a hidden tab does nothing', async () => {
  const page = await open(browser, at(view));
  await rested(page);
  const hide = (hidden) => page.evaluate((value) => {
    Object.defineProperty(document, 'hidden', { configurable: true, get: () => value });
    document.dispatchEvent(new Event('visibilitychange'));
  }, hidden);
  await hide(true);
  const { drawnFrames } = await figures(page);
  await page.locator('#mirage').focus();
  await page.keyboard.down('KeyW');
  await sleep(500);
  assert.equal((await figures(page)).drawnFrames, drawnFrames);
  assert.ok((await figures(page)).asleep);
  await hide(false);
  await until('awake', async () => (await figures(page)).drawnFrames > drawnFrames);
  await page.keyboard.up('KeyW');
  await page.context().close();
});

test('views of how it works: each key another picture, and the picture again', async () => {
  // The knot is an impostor where there is no geometry. Where there is, a busy link decides when it comes; nearby it always does.
  const without = await serve('builtin:knot', ['--no-geometry']);
  for (const [url, keys] of [[`${without.url}#budget=0`, ['Digit2', 'Digit3', 'Digit4']], [at(settled), ['Digit2', 'Digit5']]]) {
    const hash = new URL(url).hash;
    const page = await open(browser, url);
    await rested(page);
    const own = await screen(page);
    for (const key of keys) {
      await page.keyboard.press(key);
      await rested(page);
      assert.ok(await flip(page, own, await screen(page)) > 0.005, `${key} at '${hash}'`);
    }
    await page.keyboard.press('Digit1');
    await rested(page);
    assert.ok(await flip(page, own, await screen(page)) < 0.003);  // refined from another scale, maybe
    await page.context().close();
  }
  await without.stop();
});

test('small, sharp and turned screens; everything by keyboard, with a name', async () => {
  const page = await open(browser, at(view), { width: 320, height: 568, scale: 2, touch: true });
  await rested(page);
  const { width } = await picture(page);
  assert.equal(width, 640, 'in the pixels of the screen');
  const rows = await page.evaluate(() => new Set([...document.querySelectorAll('#bar button')].filter((e) => e.offsetParent !== null)
    .map((e) => e.getBoundingClientRect().top)).size);
  assert.equal(rows, 1, 'the buttons take one row');
  await page.locator('#figures-button').click();
  await page.locator('#more').click();
  const wide = await page.evaluate(() => [...document.querySelectorAll('button, input, section, dl')].filter((e) => e.offsetParent !== null)
    .filter((e) => { const box = e.getBoundingClientRect(); return box.right > innerWidth + 1 || box.left < -1; }).map((e) => e.id || e.outerHTML.slice(0, 60)));
  assert.deepEqual(wide, [], 'nothing beyond 320 px');
  const nameless = await page.evaluate(() => [...document.querySelectorAll('button, input')].filter((e) =>
    !(e.textContent.trim() || e.getAttribute('aria-label') || e.labels?.length)).map((e) => e.outerHTML));
  assert.deepEqual(nameless, []);
  const reached = new Set();
  for (let i = 0; i < 40; ++i) {
    await page.keyboard.press('Tab');
    reached.add(await page.evaluate(() => document.activeElement.id));
  }
  for (const id of ['mirage', 'home', 'share', 'more', 'screenshot', 'compare', 'keys', 'figures-button', 'azimuth', 'own-light']) assert.ok(reached.has(id), id);
  await page.keyboard.press('Escape');
  assert.equal(await page.locator('#menu').isVisible(), false, 'Escape closes the menu');
  await page.locator('#figures-close').click();
  assert.equal(await page.locator('#figures').isVisible(), false, 'the panel covers no button that closes it');
  await page.setViewportSize({ width: 568, height: 320 });
  await until('turned', async () => (await picture(page)).width === 1136);
  await rested(page);
  await page.context().close();
});

for (const [width, height, colorScheme] of [[1280, 720, 'dark'], [1280, 720, 'light'], [320, 568, 'light']]) {
  test(`an accessibility checker finds nothing in any state of the page: ${width} x ${height}, ${colorScheme}`, async () => {
    const page = await open(browser, at(view), { width, height, colorScheme });
    const found = {};
    const look = async (state) => { const all = await barriers(page); if (all.length) found[state] = all; };
    const press = (id) => page.evaluate((of) => document.getElementById(of).click(), id);
    await look('loading');
    await rested(page);
    await look('home');
    await press('figures-button');
    await page.locator('#figures summary').click();
    await page.keyboard.press('3');
    await until('status', async () => (await page.locator('#details-list dt').count()) > 0);
    await look('status, details, a view with its legend');
    await page.keyboard.press('1');
    await press('figures-button');
    await press('more');
    await look('menu');
    await press('keys');
    assert.equal(await page.locator('#menu').isVisible(), false, 'a choice closes the menu');
    await look('keys');
    await press('keys');
    await press('compare');
    await until('compared', async () => /FLIP/.test(await page.locator('#flip').textContent()), 60);
    await look('comparison');
    await press('compare-end');
    await page.evaluate(() => { document.getElementById('link-box').hidden = false; document.getElementById('token-form').hidden = false; });
    await look('forms');
    assert.deepEqual(found, {});
    await page.context().close();
  });
}

test('figures, layers and keys explain themselves', async () => {
  const page = await open(browser, at(view));
  await rested(page);
  await page.keyboard.press('o');
  await until('status', async () => /sharp/.test(await page.locator('#status-list').textContent()));
  await page.locator('#figures summary').click();
  const unexplained = await page.evaluate(() => [...document.querySelectorAll('#figures dt')]
    .filter((name) => !/^[A-Z].{20,}\.$/.test(name.nextElementSibling.nextElementSibling?.textContent ?? '')).map((name) => name.textContent));
  assert.deepEqual(unexplained, []);
  assert.ok(await page.locator('#details-list dt').count() >= 10);
  assert.equal(await page.locator('#legend').isVisible(), false);
  for (const key of ['2', '3', '4', '5']) {
    await page.keyboard.press(key);
    const items = await page.locator('#legend li').allTextContents();
    assert.ok(items.length > 0 && items.every((text) => text.length > 0), key);
    assert.ok(await page.locator('#legend').isVisible());
  }
  await page.keyboard.press('1');
  assert.equal(await page.locator('#legend').isVisible(), false);

  await page.keyboard.press('Shift+?');
  const keys = await page.locator('#keys-list').textContent();
  for (const key of ['W A S D', 'wheel', 'double click', 'Shift', 'Esc']) assert.ok(keys.includes(key), key);
  await page.keyboard.press('Escape');
  assert.equal(await page.locator('#keys-list').isVisible(), false);
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('the sliders of the light begin where the sun is', async () => {
  const city = await serve('builtin:city?blocks=2');
  const page = await open(browser, `${city.url}`);
  await seen(page);
  await page.locator('#figures-button').click();
  const sun = await page.evaluate(() => [0, 1].map((part) => mirage.core._page_own_sun(part)));
  assert.ok(sun.every(Number.isFinite));
  const shown = [await page.locator('#azimuth').inputValue(), await page.locator('#elevation').inputValue()].map(Number);
  sun.forEach((degrees, i) => assert.ok(Math.abs(shown[i] - degrees) <= 0.5, `${shown} for ${sun}`));
  await page.context().close();
  await city.stop();
});

test('quality and field of view: chosen in the panel, kept in the address', async () => {
  const page = await open(browser, at(view));
  await rested(page);
  const budget = async () => (await figures(page)).budgetMs;
  const usual = await budget(), wide = await picture(page);
  assert.ok(usual > 0);
  await page.locator('#figures-button').click();
  for (const [quality, share] of [['picture', 3], ['speed', 0.5]]) {
    await page.locator('#quality').selectOption(quality);
    await until(`${share} of the time`, async () => Math.abs(await budget() / usual - share) < 0.01);
    assert.equal(await page.evaluate(() => document.activeElement.id), 'mirage', 'keys move');
  }
  await page.locator('#fov').fill('30');
  assert.equal(await page.locator('#fov-degrees').textContent(), '30°');
  await rested(page);
  const near = await picture(page), full = await truth(page);
  assert.ok(await flip(page, full, near) < 0.05, 'it is what the server renders at 30°');
  assert.ok(await flip(page, full, wide) > 0.1, 'and not what it renders at 60°');
  await until('in the address', async () => page.url().endsWith('&fov=30&quality=speed'));
  const link = page.url();
  await page.goto('about:blank');
  await page.goto(link);
  await rested(page);
  assert.ok(await flip(page, full, await picture(page)) < 0.05);
  assert.ok(Math.abs(await budget() / usual - 0.5) < 0.01);
  assert.equal(await page.locator('#quality').inputValue(), 'speed');
  await page.goto('about:blank');
  await page.goto(at(`${view}&fov=175&quality=best`));
  await until('a word', async () => /quality=best, fov=175/.test(await message(page)));
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('a line tells how much of what is in view has an image, and goes', async () => {
  const city = await serve('builtin:city?blocks=2');
  const slow = await relay(city.port, { rtt: 100, rate: 3 });
  const page = await open(browser, slow.url);
  const line = page.locator('#arriving');
  await line.waitFor({ state: 'visible' });
  await line.waitFor({ state: 'hidden', timeout: 120000 });
  await page.context().close();
  await slow.stop();
  await city.stop();
});

test('other scripts read and set the view', async () => {
  const page = await open(browser, at(settled));
  await until('at rest', () => page.evaluate(() => mirage.atRest()), 60);
  assert.equal(await page.evaluate(() => mirage.connected()), true);
  const { eye, look } = await page.evaluate(() => mirage.camera());
  assert.ok(apart(eye, [0, 1, 6]) < 1e-3 && look[2] < eye[2], `${eye} ${look}`);
  assert.equal(await page.evaluate(() => mirage.setCamera([3, 1, 4], [0, 0, 0])), true);
  assert.ok(apart((await page.evaluate(() => mirage.camera())).eye, [3, 1, 4]) < 1e-6);
  await until('in the address', async () => page.url().includes('#eye=3,1,4&'));
  for (const [from, to] of [[[0, 0, 0], [0, 0, 0]], [[NaN, 0, 0], [1, 0, 0]], [[1, 2], [3, 4, 5]]]) {
    assert.equal(await page.evaluate(([a, b]) => mirage.setCamera(a, b), [from, to]), false);
  }
  const stats = await page.evaluate(() => mirage.stats());
  assert.ok(stats.visible > 0 && Number.isFinite(stats.boundPx));
  assert.equal(await page.locator('canvas#mirage').count(), 1);
  assert.deepEqual(page.problems, []);
  await page.context().close();
});

test('no WebGL 2: a sentence', async () => {
  const page = await open(browser, knot.url, { before: () => {
    const real = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function get(kind, ...rest) { return kind === 'webgl2' ? null : real.call(this, kind, ...rest); };
  } });
  await until('a sentence', async () => /no WebGL 2/.test(await message(page)));
  await page.context().close();
});

test('no server, another version, a small device: a sentence each, or less memory', async () => {
  const page = await open(browser, at(view), { before: () => Object.defineProperty(navigator, 'deviceMemory', { value: 1 }) });
  await rested(page);
  assert.ok((await figures(page)).gpuBytes < 54e6);
  const told = await page.evaluate(() => {
    mirage.link.closed({ code: 4001, reason: 'speak 9', opened: true });
    return document.getElementById('message').textContent;
  });
  assert.match(told, /another version.*Reload/);
  await page.context().close();

  const host = await hostSite({ '/': join(bin, '../../web/site') });  // it has the page's files and answers no WebSocket
  const alone = await open(browser, `${host.origin}/index.html`);
  await until('a sentence', async () => /^No server answers here, or it does not let this page in: trying again in \d+ s$/.test(await message(alone)));
  await alone.context().close();
  host.close();
});

test('what the server calls its scene never becomes markup', async () => {
  const folder = scratch();
  const model = process.env.WEB_MODEL;
  const name = join(folder, '<img src=x onerror=alert(1)>.glb');
  copyFileSync(model, name);
  const server = await serve(name);
  const page = await open(browser, server.url);
  await seen(page);  // it is animated
  await page.locator('#figures-button').click();
  assert.equal(await page.locator('img').count(), 0);
  assert.match(await page.title(), /<img src=x/);
  await page.context().close();
  await server.stop();
});

test('what moves can be stopped, and goes on from there', async () => {
  const server = await serve(process.env.WEB_MODEL);
  const page = await open(browser, server.url);
  await seen(page);
  const shot = async () => (await page.locator('#mirage').screenshot()).toString('base64');
  const waits = (ms) => page.waitForTimeout(ms);
  const pause = page.locator('#pause');
  await pause.waitFor();  // it is known what moves
  assert.equal(await pause.textContent(), 'Pause');
  await page.keyboard.press('Space');
  assert.equal(await pause.textContent(), 'Play');
  assert.equal(await pause.getAttribute('aria-pressed'), 'true');
  await rested(page);  // what was under way has arrived
  const stopped = await shot();
  await waits(700);
  assert.equal(await shot(), stopped, 'it stands');
  await pause.click();
  assert.equal(await pause.textContent(), 'Pause');
  await waits(700);
  assert.notEqual(await shot(), stopped, 'it goes on');
  await page.context().close();
  await server.stop();

  const still = await serve('builtin:knot');
  const other = await open(browser, still.url);
  await rested(other);
  assert.equal(await other.locator('#pause').isVisible(), false, 'nothing moves');
  await other.context().close();
  await still.stop();
});

// Writes a red square with a green variant, and two clips: in one it stays, in the other it is far away.
function squareOfChoices() {
  const floats = new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, -1, 0, 1, 1, 0, -1, 1, 0, 0, 1000, 0, 0, 0, 0.01, 0, 0, 0, -1000, 0, 0, -1001, 0]);
  const bytes = Buffer.from(floats.buffer);
  const accessor = (first, count, type, bounds = {}) => ({ bufferView: 0, byteOffset: 4 * first, count, type, componentType: 5126, ...bounds });
  const clip = (name, output) => ({ name, samplers: [{ input: 1, output }], channels: [{ sampler: 0, target: { node: 0, path: 'translation' } }] });
  const color = (baseColorFactor) => ({ doubleSided: true, pbrMetallicRoughness: { baseColorFactor, metallicFactor: 0 } });
  const file = join(scratch(), 'square.gltf');
  writeFileSync(file, JSON.stringify({
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }], extensionsUsed: ['KHR_materials_variants'],
    extensions: { KHR_materials_variants: { variants: [{ name: 'leaf & <b>green</b>' }] } },
    materials: [color([0.8, 0.02, 0.02, 1]), color([0.02, 0.8, 0.02, 1])],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, material: 0,
      extensions: { KHR_materials_variants: { mappings: [{ material: 1, variants: [0] }] } } }] }],
    accessors: [accessor(0, 6, 'VEC3', { min: [-1, -1, 0], max: [1, 1, 0] }), accessor(18, 2, 'SCALAR', { min: [0], max: [1000] }),
      accessor(20, 2, 'VEC3'), accessor(26, 2, 'VEC3')],
    animations: [clip('stays', 2), clip('gone', 3)],
    bufferViews: [{ buffer: 0, byteLength: bytes.length }],
    buffers: [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString('base64')}` }],
  }));
  return file;
}

test('clips and variants: chosen in a list, kept in the address, refused with a word', async () => {
  const server = await serve(squareOfChoices(), ['--choices', '1']);
  const front = '#eye=0,0,4&look=0,0,0';
  const color = async (page) => {
    const { width, height, rgba } = await picture(page);
    const [r, g, b] = rgba.subarray(4 * (width * (height >> 1) + (width >> 1)));
    return r > 2 * g && r > 2 * b ? 'red' : g > 2 * r && g > 2 * b ? 'green' : 'else';
  };
  const choose = async (page, list, name) => { await page.locator('#more').click(); await list.selectOption(name); };
  const becomes = (page, wanted) => until(wanted, async () => (await figures(page))?.seen && (await color(page)) === wanted);
  const page = await open(browser, `${server.url}${front}`);
  await becomes(page, 'red');
  const variant = page.getByLabel('Variant'), clip = page.getByLabel('Clip');
  assert.deepEqual(await variant.locator('option').allTextContents(), ['As it is', 'leaf & <b>green</b>']);
  assert.deepEqual(await clip.locator('option').allTextContents(), ['All clips', 'stays', 'gone']);
  await choose(page, variant, 'leaf & <b>green</b>');
  await becomes(page, 'green');
  await until('no more message', async () => (await message(page)) === '');
  assert.equal(new URL(page.url()).searchParams.get('variant'), 'leaf & <b>green</b>');
  assert.match(page.url(), /#eye=0,0,4/, 'the view stays');
  assert.equal(await variant.inputValue(), 'leaf & <b>green</b>');

  // An equal address shows the same. Beyond --choices, the server says so, and the page stays with what it shows.
  const other = await open(browser, page.url());
  await becomes(other, 'green');
  await choose(other, other.getByLabel('Clip'), 'gone');
  await until('a word', async () => /does not show “gone”.*as many clips and variants/.test(await message(other)));
  await becomes(other, 'green');
  assert.equal(await other.getByLabel('Clip').inputValue(), '');
  await other.context().close();

  await choose(page, variant, '');
  await becomes(page, 'red');
  assert.equal(new URL(page.url()).search, '');
  await choose(page, clip, 'gone');
  await becomes(page, 'else');
  assert.deepEqual(page.problems, []);
  await page.context().close();

  const wrong = await open(browser, `${server.url}?clip=jump${front}`);
  await becomes(wrong, 'red');
  await until('a word', async () => /no clip “jump”/.test(await message(wrong)));
  assert.equal(new URL(wrong.url()).search, '');
  await wrong.context().close();
  await server.stop();

  const plain = await open(browser, at(view));
  await seen(plain);
  assert.equal(await plain.getByLabel('Clip').isVisible(), false);
  await plain.context().close();
});
