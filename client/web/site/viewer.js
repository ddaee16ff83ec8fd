// Viewer: the page itself; loads the core and runs its frames.
import { loadModule, pose, startCore, textAt, withText } from './core.js';
import { Choices } from './choices.js';
import { Compare } from './compare.js';
import { Controls } from './controls.js';
import { Figures, megabytes } from './figures.js';
import { Pace } from './pace.js';
import { Place } from './place.js';
import { leavePoster, posterShown } from './poster.js';
import { Prices } from './prices.js';
import { ServerLink } from './server_link.js';
import { say } from './status.js';
import { Toolbar } from './toolbar.js';

const $ = (id) => document.getElementById(id);
const canvas = $('mirage');
const mostPixelRatio = 2;
const resting = 2, drawn = 1, drawable = 4;  // bits of page_frame()
const mostKept = 4000;
const fewLeft = 0.1;           // share of the things in view that have no image
const longestPosterMs = 1000;  // over a picture that is there

// Returns MB for tiles and for meshes, by the device's memory; browsers tell that up to 8 GB, if at
// all.
function memoryBudgets() {
  const gigabytes = navigator.deviceMemory ?? 4;
  return gigabytes >= 4 ? [216, 256] : gigabytes >= 2 ? [108, 96] : [54, 48];
}

export class Viewer {
  constructor() {
    this.intervals = [];   // of the display, while loading
    this.pauses = [];      // ms for taking messages in, a number a frame
    this.uploads = [];     // ms for uploading them, a number a frame
    this.frames = [];      // ms from one drawn picture to the next
    this.next = 0;         // requestAnimationFrame's id; 0: the page sleeps
    this.lost = false;     // the context is lost
    this.failed = false;
    this.waited = false;   // for the graphics card, since the last frame
    this.tickMs = 0;       // ms that the last frame took here
    this.marks = { start: performance.now() };
    this.place = new Place(this);
    this.choices = new Choices(this);
    this.pace = new Pace();
  }

  fail(text) {
    this.failed = true;
    cancelAnimationFrame(this.next);
    this.next = 0;
    say(text, { aside: false });
  }

  async start() {
    const loading = (got, all) => say(`Loading the viewer: ${megabytes(got)} of ${megabytes(all)}`, { progress: got / all, aside: false });
    say('Loading the viewer', { progress: 0, aside: false });
    this.watchDisplay();
    this.controls = new Controls(canvas, $('stick'), () => this.wake(), (x, y) => this.viewerThere() && this.core._page_aim(x, y));
    this.link = new ServerLink(this, this.place.address.token);
    const module = await loadModule(loading);
    this.link.worker.postMessage({ module });
    this.link.connect();
    this.core = await startCore(module, (bytes) => this.link.send(bytes));
    this.marks.loaded = performance.now();
    say('Starting the graphics', { progress: 1, aside: false });
    await new Promise((done) => { setTimeout(done); });  // lets the text be shown
    this.prices = new Prices(this);
    if (!this.startGraphics()) return;
    this.figures = new Figures(this);
    this.compare = new Compare(this);
    this.toolbar = new Toolbar(this);
    addEventListener('resize', () => { this.compare.end(); this.wake(); });
    document.addEventListener('visibilitychange', () => { document.hidden ? this.hide() : this.wake(); });
    this.watchContext();
    this.wake();
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

  // --- the graphics -------------------------------------------------------------------------------------------------------
  viewerThere() { return Boolean(this.core) && this.marks.graphics !== undefined && !this.lost && !this.failed; }

  startGraphics() {
    const { core } = this;
    const [width, height] = this.size();
    const [atlasMb, meshMb] = memoryBudgets();
    const { clip, variant } = this.choices.wanted;
    const begun = withText(core, this.link.token, (token) => withText(core, clip, (clipAt) => withText(core, variant, (variantAt) =>
      core._page_start(width, height, this.place.address.budget ?? -1, this.displayMs(), atlasMb, meshMb, token, clipAt, variantAt))));
    if (begun < 0) {
      const why = textAt(core, core._page_text());
      this.fail(why.includes('WebGL 2')
        ? 'This browser has no WebGL 2, which the scene is drawn with. A current Firefox, Chrome, Edge or Safari has it; it may be switched off in the settings, or the graphics driver be too old.'
        : `The graphics did not start: ${why}`);
      return false;
    }
    this.marks.graphics = performance.now();
    const gl = canvas.getContext('webgl2');
    this.pace.begin(gl);
    this.prices.recall(gl);
    if (this.link.connected) core._page_connected(1);
    this.place.apply();
    if (this.toolbar?.stopped) core._page_play(0, this.place.sessionMs());
    return true;
  }

  watchContext() {
    canvas.addEventListener('webglcontextlost', (e) => {
      e.preventDefault();
      if (this.failed) return;
      this.stopGraphics();
      this.lost = true;
      say('The graphics were reset: waiting for them to come back');
    });
    canvas.addEventListener('webglcontextrestored', () => {
      this.lost = false;
      say('');
      this.restart();
    });
  }

  stopGraphics() {
    cancelAnimationFrame(this.next);
    this.next = 0;
    if (!this.viewerThere()) return;
    if (this.seen) this.place.keep();
    this.core._page_stop();
    this.marks.graphics = undefined;
  }

  /// Starts a new session on a new connection; what was held is gone with the graphics.
  restart() {
    this.stopGraphics();
    if (!this.startGraphics()) return;
    this.place.returnToKept();
    this.core._page_connected(0);
    this.link.connectAnew();
    this.wake();
  }

  // --- for other scripts, as `window.mirage`: answers before there is a scene are empty -----------------------------------
  /// Returns the figures of the picture (WebViewer::figures); {}: there is none yet.
  stats() { return this.viewerThere() ? this.figures.now() : {}; }
  /// Returns the eye, and a point that it looks at, m.
  camera() {
    if (!this.viewerThere()) return null;
    const { eye, ahead } = pose(this.core);
    return { eye, look: eye.map((v, i) => v + ahead[i]) };
  }
  /// Puts the eye somewhere else; three numbers each, m. Returns false if it cannot look from there.
  setCamera(eye, look) {
    const numbers = [...eye, ...look];
    const good = numbers.length === 6 && numbers.every(Number.isFinite) && eye.some((v, i) => v !== look[i]);
    if (!this.viewerThere() || !good) return false;
    this.core._page_look(...numbers);
    this.place.changedAt = performance.now();
    this.wake();
    return true;
  }
  /// True if everything in view is there, and the picture would not get any better.
  atRest() {
    const { complete, atRest, refined } = this.stats();
    return Boolean(this.seen && complete && atRest && refined);
  }
  connected() { return Boolean(this.link?.connected); }

  // --- frames -------------------------------------------------------------------------------------------------------------
  size() {
    const ratio = Math.min(mostPixelRatio, devicePixelRatio || 1);
    return [Math.max(1, Math.round(innerWidth * ratio)), Math.max(1, Math.round(innerHeight * ratio))];
  }

  wake() {
    if (this.next || !this.viewerThere() || document.hidden) return;
    this.lastAt = 0;
    this.next = requestAnimationFrame((at) => this.tick(at));
  }

  hide() {
    cancelAnimationFrame(this.next);
    this.next = 0;
    this.lastDrawn = false;
    this.prices.keep();
  }

  tick(at) {
    this.next = 0;
    if (!this.viewerThere()) return;
    if (!this.pace.ready()) {
      this.waited = true;
      this.next = requestAnimationFrame((then) => this.tick(then));
      return;
    }
    const { core } = this;
    const began = performance.now();
    const seconds = this.lastAt ? Math.min(0.1, (at - this.lastAt) / 1000) : 1 / 60;
    if (this.lastAt && this.lastDrawn) core._page_interval_ms(this.ownInterval(at - this.lastAt));
    const deliveredMs = this.link.deliver();
    if (this.seen && this.controls.steers()) leavePoster();
    const motion = posterShown() ? this.controls.still() : this.controls.take(seconds);
    if (motion.moved) {
      this.compare.end();
      core._page_steer(...motion.steering);
    }
    this.place.setLight();
    const [width, height] = this.size();
    this.prices.beginFrame();
    const bits = core._page_frame(this.place.sessionMs(), width, height);
    if (bits < 0) { this.fail(`The scene cannot be drawn: ${textAt(core, core._page_text())}`); return; }
    this.prices.endFrame((bits & drawn) !== 0);
    if (bits & drawn) this.pace.drawn();
    this.measure(at, bits, deliveredMs);
    this.show(bits);
    this.compare.look();
    this.figures.look(at);
    this.place.remember(motion, at);
    this.lastAt = at;
    this.waited = false;
    this.tickMs = performance.now() - began;
    const sleeps = (bits & resting) && !motion.held && !this.link.arrivals.length && !this.compare.waits();
    if (!sleeps) this.next = requestAnimationFrame((then) => this.tick(then));
    else this.sleep();
  }

  // Returns the part of the interval that frames cause. A display that is seldom refreshed, for
  // example to save power, is not their doing: a frame that misses one refresh is shown by the next
  // one of a display that does not save.
  ownInterval(ms) {
    if (this.waited) return ms;
    const display = this.displayMs();
    return Math.min(ms, this.tickMs > display ? this.tickMs + display : display);
  }

  // Sleeps at rest, where nothing is drawn. Gamepads send no events, so they are asked.
  sleep() {
    this.lastDrawn = false;
    this.figures.look(Infinity);
    clearTimeout(this.padTimer);
    if (this.controls.gamepads().length) {
      this.padTimer = setTimeout(() => { this.controls.take(0).held ? this.wake() : this.sleep(); }, 50);
    }
  }

  measure(at, bits, deliveredMs) {
    const isDrawn = (bits & drawn) !== 0;
    if (this.lastAt && isDrawn && this.lastDrawn) this.frames.push(at - this.lastAt);
    this.pauses.push(deliveredMs + this.core._page_decode_ms());
    this.uploads.push(this.core._page_upload_ms());
    for (const list of [this.frames, this.pauses, this.uploads]) if (list.length > mostKept) list.splice(0, mostKept / 4);
    this.lastDrawn = isDrawn;
  }

  // True if the picture has images of most things, if somebody has changed it, or if it has had its time.
  betterThanPoster() {
    const { complete, placeholders, visible } = this.figures.now();
    return (complete && placeholders <= fewLeft * visible) || this.place.changedAt !== undefined ||
      performance.now() - this.marks.picture > longestPosterMs;
  }

  // Says what the first picture waits for.
  tellWait() {
    const name = textAt(this.core, this.core._page_scene_name());
    const got = this.figures.now().bytesDown;
    say(name ? `${name}: the first picture is on its way, ${megabytes(got)}` : 'Waiting for the scene', { aside: false });
  }

  // Shows messages and tools once there is a picture.
  show(bits) {
    if (!(bits & drawable)) {
      if (this.link.connected && !this.seen) this.tellWait();
      return;
    }
    if (!this.seen && (bits & drawn)) {
      this.seen = true;
      this.marks.picture = performance.now();
      document.title = `Mirage: ${textAt(this.core, this.core._page_scene_name())}`;
      this.toolbar.enable();
    }
    if (this.seen) this.toolbar.offerPause();
    this.toolbar.showMode();
    if (this.seen && this.link.noteSeen()) {
      say('');
      this.place.tellWrong();
    }
    if (this.seen) this.choices.look();
    if (this.seen && posterShown() && (bits & resting || this.betterThanPoster())) leavePoster();
  }
}

const viewer = new Viewer();
globalThis.mirage = viewer;
viewer.start().catch((error) => {
  const missing = typeof WebAssembly !== 'object' || !WebAssembly.compileStreaming;
  viewer.fail(missing ? 'This browser has no WebAssembly, which the scene is drawn with.' : `This page did not load: ${error.message}. Reload it.`);
});
