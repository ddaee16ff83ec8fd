// The page: loads the core, runs its frames, and is the person's side of it.
import createMirage from './mirage.js';
import { readAddress, writeAddress } from './address.js';
import { Controls } from './controls.js';
import { Compare } from './compare.js';
import { Figures } from './figures.js';
import { Prices } from './prices.js';

const $ = (id) => document.getElementById(id);
const wasmBytes = Number(document.querySelector('script[data-wasm-bytes]')?.dataset.wasmBytes) || 1e6;
const canvas = $('view');
const mostPixelRatio = 2;
const resting = 2, drawn = 1, drawable = 4;  // bits of a frame
const now = () => performance.timeOrigin + performance.now();

export class Viewer {
  constructor() {
    this.address = readAddress(location.hash);
    this.light = this.address.light ?? null;
    this.token = this.address.token ?? sessionStorage.getItem('mirage-token') ?? '';
    this.startedAt = now() - 1000 * (this.address.t ?? 0);
    this.arrivals = [];
    this.intervals = [];   // of the display, while loading
    this.pauses = [];      // ms that taking messages in took, one number a frame
    this.uploads = [];     // ms that handing it to the graphics card took, the same
    this.frames = [];      // ms from one drawn picture to the next
    this.next = 0;         // of requestAnimationFrame; 0: the page sleeps
    this.connected = false;
    this.lost = false;     // the context is
    this.failed = false;
    this.pauseMs = 250;    // before the next try to connect
    this.marks = { start: performance.now() };
    this.hideToken();
  }

  // Never in a history, a screenshot or a link that is passed on.
  hideToken() {
    if (this.address.token === undefined) return;
    const kept = location.hash.replace(/^#/, '').split('&').filter((part) => !part.startsWith('token='));
    history.replaceState(null, '', kept.length ? `#${kept.join('&')}` : location.pathname + location.search);
  }

  say(text, { progress = null, aside = true } = {}) {
    $('status').hidden = text === '';
    $('status').classList.toggle('aside', aside);
    $('message').textContent = text;
    $('progress').hidden = progress === null;
    if (progress !== null) $('progress').value = progress;
  }

  fail(text) {
    this.failed = true;
    cancelAnimationFrame(this.next);
    this.next = 0;
    this.say(text, { aside: false });
  }

  async start() {
    this.say('Loading', { progress: 0, aside: false });
    this.watchDisplay();
    this.startWorker();
    const module = await this.loadModule();
    this.worker.postMessage({ module });
    this.connect();
    this.core = await createMirage({
      instantiateWasm(imports, done) {
        WebAssembly.instantiate(module, imports).then((instance) => done(instance));
        return {};
      },
      write: (bytes) => this.worker.postMessage({ send: bytes }, [bytes.buffer]),
    });
    this.marks.loaded = performance.now();
    this.say('Starting the graphics', { progress: 1, aside: false });
    await new Promise((done) => { setTimeout(done); });  // let it be seen
    this.prices = new Prices(this);
    if (!this.startGraphics()) return;
    this.controls = new Controls(canvas, $('stick'), () => this.wake());
    this.figures = new Figures(this);
    this.compare = new Compare(this);
    this.listen();
    this.wake();
  }

  async loadModule() {
    const response = await fetch(new URL('./mirage.wasm', import.meta.url));
    if (!response.ok) throw new Error(`the server answered ${response.status}`);
    let got = 0;
    const counted = response.body.pipeThrough(new TransformStream({
      transform: (chunk, out) => {
        got += chunk.length;
        this.say('Loading', { progress: Math.min(1, got / wasmBytes), aside: false });
        out.enqueue(chunk);
      } }));
    return WebAssembly.compileStreaming(new Response(counted, { headers: { 'Content-Type': 'application/wasm' } }));
  }

  watchDisplay() {
    let before = 0;
    const look = (at) => {
      if (before) this.intervals.push(at - before);
      before = at;
      if (this.intervals.length < 12 && !this.core) requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
  }

  displayMs() {
    const sorted = [...this.intervals].sort((a, b) => a - b);
    const median = sorted[sorted.length >> 1] ?? 1000 / 60;
    return Math.min(1000 / 30, Math.max(1000 / 240, median));
  }

  withText(text, use) {
    const bytes = new TextEncoder().encode(`${text}\0`);
    const at = this.core._malloc(bytes.length);
    this.core.HEAPU8.set(bytes, at);
    const out = use(at);
    this.core._free(at);
    return out;
  }
  text(pointer) { return this.core.UTF8ToString(pointer); }

  startGraphics() {
    const { core } = this;
    const [width, height] = this.size();
    const gigabytes = navigator.deviceMemory ?? 4;
    const atlasMb = gigabytes >= 4 ? 216 : gigabytes >= 2 ? 108 : 54;
    const meshMb = gigabytes >= 4 ? 256 : gigabytes >= 2 ? 96 : 48;
    const begun = this.withText(this.token, (token) => core._page_start(
      width, height, this.address.budget ?? -1, this.displayMs(), atlasMb, meshMb, token));
    if (begun < 0) {
      const why = this.text(core._page_text());
      this.fail(why.includes('WebGL 2')
        ? 'This browser has no WebGL 2, which the scene is drawn with. A current Firefox, Chrome, Edge or Safari has it; it may be switched off in the settings, or the graphics driver be too old.'
        : `The graphics did not start: ${why}`);
      return false;
    }
    this.marks.graphics = performance.now();
    this.prices.recall();
    if (this.connected) core._page_connected(1);
    this.applyAddress();
    return true;
  }

  // What the view's link says, as far as it says anything.
  applyAddress() {
    const { eye, look, light } = this.address;
    if (eye) this.core._page_look(...eye, ...look);
    this.light = light ?? null;
    this.lightIsSet = false;
    this.placed = Boolean(eye);
  }

  // --- the link -----------------------------------------------------------------------------------------------------------
  startWorker() {
    this.worker = new Worker(new URL('./socket_worker.js', import.meta.url), { type: 'module' });
    this.worker.onmessage = ({ data }) => {
      if (data.arrival) { this.arrivals.push(data.arrival); this.wake(); }
      if (data.open) this.opened();
      if (data.closed) this.closed(data.closed);
      if (data.flip) this.compare.measured(data.flip);
    };
    this.worker.onerror = () => this.fail('The part of this page that talks to the server did not start: module workers may be missing in this browser.');
  }

  connect() {
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    const folder = location.pathname.replace(/[^/]*$/, '');
    this.worker.postMessage({ connect: `${scheme}://${location.host}${folder}` });
  }

  opened() {
    this.marks.connected ??= performance.now();
    this.connected = true;
    this.triesLeft = null;
    if (this.viewerThere()) this.core._page_connected(1);
    this.wake();
  }

  viewerThere() { return Boolean(this.core) && this.marks.graphics !== undefined && !this.lost && !this.failed; }

  closed({ code, reason, opened }) {
    this.connected = false;
    this.arrivals.length = 0;
    if (this.viewerThere()) this.core._page_connected(0);
    const refused = this.reasonOf(code, reason);
    if (code === 4003) { this.askToken(this.token !== ''); return; }
    if (refused) { this.fail(refused); return; }
    const goodbye = this.viewerThere() ? this.text(this.core._page_goodbye()) : '';
    const wait = this.pauseMs * (1 + 0.15 * Math.random());
    this.pauseMs = Math.min(2 * this.pauseMs, 5000);
    const why = opened || this.seen ? 'The server is gone' : 'No server answers here, or it does not let this page in';
    this.offline = `${why}${goodbye ? ` (${goodbye})` : ''}: ${this.seen ? 'showing what is here, ' : ''}trying again in ${Math.max(1, Math.round(wait / 1000))} s`;
    this.say(this.offline, { aside: Boolean(this.seen) });
    clearTimeout(this.retry);
    this.retry = setTimeout(() => this.connect(), wait);
    this.wake();
  }

  reasonOf(code, reason) {
    if (code === 4001) return 'The server speaks another version than this page. Reload it.';
    if (code === 4900) return `What the server sent cannot be read (${reason}). Reload the page; if that does not help, server and page do not belong together.`;
    if (code === 1008 || code === 1002 || code === 1009) return `The server refused what this page said (${reason || code}). Reload the page.`;
    return null;
  }

  askToken(wrong) {
    sessionStorage.removeItem('mirage-token');
    this.say(wrong ? 'The server does not know this token.' : '', { aside: false });
    $('token-form').hidden = false;
    $('token').value = '';
    $('token').focus();
  }

  useToken(token) {
    this.token = token;
    sessionStorage.setItem('mirage-token', token);
    $('token-form').hidden = true;
    this.say('Connecting', { aside: false });
    this.restart();  // the core greets with the token it was started with
  }

  // --- frames -------------------------------------------------------------------------------------------------------------
  size() {
    const ratio = Math.min(mostPixelRatio, devicePixelRatio || 1);
    return [Math.max(1, Math.round(innerWidth * ratio)), Math.max(1, Math.round(innerHeight * ratio))];
  }

  wake() {
    if (this.next || !this.viewerThere() || document.hidden) return;
    this.restedAt = undefined;
    this.lastAt = 0;
    this.next = requestAnimationFrame((at) => this.tick(at));
  }

  // What came goes to the core: no frame waits for anything else.
  takeArrivals() {
    if (this.arrivals.length === 0) return;
    const began = performance.now();
    const { core } = this;
    for (const { control, payload, packed, wire, at } of this.arrivals.splice(0)) {
      const pointer = core._malloc(control.length + payload.length);
      core.HEAPU8.set(control, pointer);
      core.HEAPU8.set(payload, pointer + control.length);
      core._page_arrived(pointer, control.length, pointer + control.length, payload.length, packed, wire, Math.max(0, now() - at));
      core._free(pointer);
    }
    this.arrivingMs = performance.now() - began;
  }

  sessionMs() { return now() - this.startedAt; }

  tick(at) {
    this.next = 0;
    if (!this.viewerThere()) return;
    const { core } = this;
    const seconds = this.lastAt ? Math.min(0.1, (at - this.lastAt) / 1000) : 1 / 60;
    if (this.lastAt && this.lastDrawn) core._page_interval_ms(at - this.lastAt);
    this.arrivingMs = 0;
    this.takeArrivals();
    const motion = this.controls.take(seconds);
    if (motion.moved) {
      this.compare.end();
      this.placed = true;
      core._page_steer(...motion.turn, ...motion.move.map((m) => m * motion.boost));
    }
    this.setLight();
    const [width, height] = this.size();
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    this.prices.beginFrame();
    const bits = core._page_frame(this.sessionMs(), width, height);
    if (bits < 0) { this.fail(`The scene cannot be drawn: ${this.text(core._page_text())}`); return; }
    this.prices.endFrame((bits & drawn) !== 0);
    this.note(at, bits);
    this.compare.look();
    this.figures.look(at);
    this.rememberView(motion, at);
    this.lastAt = at;
    const sleeps = (bits & resting) && !motion.held && !this.arrivals.length && !this.compare.waits();
    if (!sleeps) this.next = requestAnimationFrame((then) => this.tick(then));
    else this.sleep();
  }

  // At rest nothing is drawn; a gamepad tells of itself by being asked only.
  sleep() {
    this.lastDrawn = false;
    this.figures.look(Infinity);
    clearTimeout(this.padTimer);
    if (this.controls.gamepads().length) {
      this.padTimer = setTimeout(() => { this.controls.take(0).held ? this.wake() : this.sleep(); }, 50);
    }
  }

  note(at, bits) {
    const isDrawn = (bits & drawn) !== 0;
    if (this.lastAt && isDrawn && this.lastDrawn) this.frames.push(at - this.lastAt);
    this.pauses.push(this.arrivingMs + this.core._page_decode_ms());
    this.uploads.push(this.core._page_upload_ms());
    for (const list of [this.frames, this.pauses, this.uploads]) if (list.length > 4000) list.splice(0, 1000);
    this.lastDrawn = isDrawn;
    if (!(bits & drawable)) {
      if (this.connected && !this.seen) this.say('Waiting for the scene', { aside: false });
      return;
    }
    if (!this.seen && isDrawn) {
      this.seen = true;
      this.marks.picture = performance.now();
      document.title = `Mirage: ${this.text(this.core._page_scene_name())}`;
      if (matchMedia('(pointer: coarse)').matches) $('stick').hidden = false;
      for (const button of document.querySelectorAll('#bar button')) button.disabled = false;
    }
    if (this.connected && this.seen && (this.offline !== undefined || !this.greeted)) {
      this.greeted = true;
      this.offline = undefined;
      this.pauseMs = 250;
      this.say('');
      this.tellWrong();
    }
  }

  // Once there is a picture under it.
  tellWrong() {
    if (this.address.wrong.length) this.notice(`This link has parts that cannot be read: ${this.address.wrong.join(', ')}`);
    this.address.wrong = [];
  }

  setLight() {
    if (this.lightIsSet || !this.core._page_home_known()) return;
    this.lightIsSet = true;
    if (this.light) this.core._page_sun(...this.light, this.sessionMs());
    else if (this.lightWasSet) this.core._page_sun(NaN, NaN, this.sessionMs());
    this.lightWasSet = Boolean(this.light);
  }

  changeLight(light) {
    this.light = light;
    this.lightIsSet = false;
    this.viewChanged = performance.now();
    this.placed = true;
    this.wake();
  }

  // --- the view, in the address -------------------------------------------------------------------------------------------
  view() {
    const at = this.core._page_pose() >> 3;
    const [ex, ey, ez, ax, ay, az] = this.core.HEAPF64.subarray(at, at + 6);
    return { eye: [ex, ey, ez], ahead: [ax, ay, az], light: this.light ?? undefined };
  }

  link({ timed = false } = {}) {
    const t = timed ? this.sessionMs() / 1000 : undefined;
    const budget = this.address.budget;
    return location.href.replace(/#.*$/, '') + writeAddress({ ...this.view(), t, budget });
  }

  // A while after the last motion: a place one can come back to.
  rememberView(motion, at) {
    if (motion.moved) this.viewChanged = at;
    if (this.viewChanged === undefined || motion.held || at - this.viewChanged < 400) return;
    this.viewChanged = undefined;
    this.pushView();
  }

  pushView() {
    const link = this.link();
    if (link === location.href) return;
    if (location.hash === '') history.replaceState({ view: 1 }, '', link);
    else history.pushState({ view: 1 }, '', link);
  }

  followAddress() {
    this.address = { ...readAddress(location.hash), budget: this.address.budget };
    if (this.address.token !== undefined) { this.hideToken(); this.useToken(this.address.token); return; }
    this.tellWrong();
    this.applyAddress();
    if (!this.address.eye && this.core._page_home_known()) this.core._page_home();
    if (this.address.t !== undefined) this.startedAt = now() - 1000 * this.address.t;
    this.compare.end();
    this.figures.showLight();
    this.wake();
  }

  // --- buttons and keys ---------------------------------------------------------------------------------------------------
  listen() {
    const actions = {
      home: () => { this.core._page_home(); this.viewChanged = 0; this.wake(); },
      share: () => this.share(),
      screenshot: () => this.screenshot(),
      compare: () => this.compare.toggle(),
      'figures-button': () => this.figures.toggle(),
      fullscreen: () => (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen?.())?.catch?.(() => {}),
    };
    for (const [id, action] of Object.entries(actions)) {
      $(id).addEventListener('click', action);
      if (!this.seen) $(id).disabled = true;
    }
    if (!document.documentElement.requestFullscreen) $('fullscreen').hidden = true;
    const keys = { KeyH: 'home', KeyL: 'share', KeyP: 'screenshot', KeyC: 'compare', KeyO: 'figures-button', KeyF: 'fullscreen' };
    addEventListener('keydown', (e) => {
      const typing = e.target instanceof HTMLInputElement && e.target.type !== 'range' && e.target.type !== 'radio';
      if (typing || e.ctrlKey || e.metaKey || e.altKey || e.repeat) return;
      if (e.code === 'Escape') { this.compare.end(); $('link-box').hidden = true; }
      const layer = /^Digit([1-5])$/.exec(e.code);
      if (layer) this.figures.showLayer(Number(layer[1]) - 1);
      if (keys[e.code] && !$(keys[e.code]).disabled) $(keys[e.code]).click();
    });
    $('token-form').addEventListener('submit', (e) => { e.preventDefault(); this.useToken($('token').value.trim()); });
    $('link-close').addEventListener('click', () => { $('link-box').hidden = true; });
    addEventListener('resize', () => { this.compare.end(); this.wake(); });
    addEventListener('hashchange', () => this.followAddress());
    document.addEventListener('visibilitychange', () => {
      if (document.hidden) { cancelAnimationFrame(this.next); this.next = 0; this.lastDrawn = false; this.prices.keep(); }
      else this.wake();
    });
    this.watchContext(canvas);
  }

  watchContext(of) {
    of.addEventListener('webglcontextlost', (e) => {
      e.preventDefault();
      if (of !== canvas || this.failed) return;
      this.stopGraphics();
      this.lost = true;
      this.say('The graphics were reset: waiting for them to come back');
    });
    of.addEventListener('webglcontextrestored', () => {
      this.lost = false;
      this.say('');
      this.restart();
    });
  }

  stopGraphics() {
    cancelAnimationFrame(this.next);
    this.next = 0;
    if (!this.viewerThere()) return;
    if (this.seen) this.keptView = this.view();
    this.core._page_stop();
    this.marks.graphics = undefined;
  }

  // A new session on a new connection: what was held is gone with the graphics.
  restart() {
    this.stopGraphics();
    if (!this.startGraphics()) return;
    if (this.keptView) this.core._page_look(...this.keptView.eye, ...this.keptView.eye.map((v, i) => v + this.keptView.ahead[i]));
    this.lightIsSet = false;
    this.arrivals.length = 0;
    this.connected = false;
    this.core._page_connected(0);
    this.greeted = false;
    this.connect();
    this.wake();
  }

  async share() {
    const link = this.link({ timed: false });
    try {
      await navigator.clipboard.writeText(link);
      this.notice('The link to this view is copied.');
    } catch {  // pages without TLS have no clipboard
      $('link-box').hidden = false;
      $('link').value = link;
      $('link').select();
    }
  }

  pixels() {
    const { core } = this;
    const [width, height] = [core._page_width(), core._page_height()];
    const at = core._page_pixels();
    return { width, height, rgba: core.HEAPU8.slice(at, at + 4 * width * height) };
  }

  screenshot() {
    const { width, height, rgba } = this.pixels();
    for (let i = 3; i < rgba.length; i += 4) rgba[i] = 255;
    const sheet = document.createElement('canvas');
    [sheet.width, sheet.height] = [width, height];
    sheet.getContext('2d').putImageData(new ImageData(new Uint8ClampedArray(rgba.buffer), width, height), 0, 0);
    sheet.toBlob((blob) => {
      const link = document.createElement('a');
      link.href = URL.createObjectURL(blob);
      link.download = `mirage-${this.text(this.core._page_scene_name()).replace(/[^a-z0-9]+/gi, '-')}.png`;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    }, 'image/png');
  }

  notice(text) {
    this.say(text);
    clearTimeout(this.noticeTimer);
    this.noticeTimer = setTimeout(() => { if ($('message').textContent === text) this.say(''); }, 6000);
  }
}

const viewer = new Viewer();
globalThis.mirage = viewer;  // for who looks into it
viewer.start().catch((error) => {
  const wasm = typeof WebAssembly !== 'object' || !WebAssembly.compileStreaming;
  viewer.fail(wasm ? 'This browser has no WebAssembly, which the scene is drawn with.' : `This page did not load: ${error.message}. Reload it.`);
});
