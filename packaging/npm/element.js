// <mirage-view src="http://HOST:9870/" camera-controls auto-rotate poster="…">: a scene of a Mirage server in a box of the page. Names of
// attributes, events and the slot are those that authors know from <model-viewer>.
import { MirageClient } from './index.js';
import { Controls } from './controls.js';

const mostPixelRatio = 2;
const rotateAfterMs = 3000;                  // without a hand on it
const rotateRate = Math.PI / 32;             // radians a second
const still = [0, 0, 0, 0, 0, 0, 0, 0, 0, 0];  // no steering

const sheet = `
:host { display: block; position: relative; width: 300px; height: 150px; overflow: hidden; contain: strict; }
canvas, #poster { position: absolute; inset: 0; width: 100%; height: 100%; }
canvas { touch-action: none; outline-offset: -2px; }
:host(:not([camera-controls])) canvas { touch-action: auto; }
#poster { background: center / cover no-repeat; transition: opacity .3s; pointer-events: none; }
#poster[hidden] { display: block; opacity: 0; }
#word { position: absolute; inset: auto 0 0; margin: 0; padding: .4em .8em; font: 14px/1.4 system-ui, sans-serif; color: #fff; background: #000b; }
#word[hidden] { display: none; }
@media (prefers-reduced-motion: reduce) { #poster { transition: none; } }`;

const numbersOf = (text) => (text ?? '').trim().split(/[\s,]+/).map(Number);

export class MirageView extends HTMLElement {
  static observedAttributes = ['src', 'token', 'poster', 'alt', 'camera-controls', 'auto-rotate', 'camera-eye', 'camera-target', 'field-of-view', 'sun', 'paused'];

  constructor() {
    super();
    const root = this.attachShadow({ mode: 'open' });
    const style = new CSSStyleSheet();
    style.replaceSync(sheet);
    root.adoptedStyleSheets = [style];
    this.canvas = document.createElement('canvas');
    this.posterBox = document.createElement('div');
    this.posterBox.id = 'poster';
    this.posterBox.part = 'poster';
    const slot = document.createElement('slot');
    slot.name = 'poster';
    this.posterBox.append(slot);
    this.word = document.createElement('p');
    this.word.id = 'word';
    this.word.part = 'message';
    this.word.role = 'status';
    this.word.hidden = true;
    root.append(this.canvas, this.posterBox, this.word, document.createElement('slot'));
    this.next = 0;
    this.handAt = -Infinity;
    const aim = (x, y) => this.client?.usable && this.client.core._layer_aim(x, y);
    this.controls = new Controls(this.canvas, null, () => this.touched(), aim,
      { keys: this.canvas, active: () => this.hasAttribute('camera-controls') });
    this.sizes = new ResizeObserver(() => this.wake());
    this.sight = new IntersectionObserver(([entry]) => { this.inSight = entry.isIntersecting; this.inSight ? this.begin() : this.sleep(); });
    this.canvas.addEventListener('webglcontextlost', (e) => { e.preventDefault(); this.client?.contextLost(); });
    this.canvas.addEventListener('webglcontextrestored', () => { this.client?.contextRestored(); this.wake(); });
    this.onVisible = () => (document.hidden ? this.sleep() : this.wake());
  }

  connectedCallback() {
    this.sizes.observe(this);
    this.sight.observe(this);
    document.addEventListener('visibilitychange', this.onVisible);
  }

  disconnectedCallback() {
    this.sizes.disconnect();
    this.sight.disconnect();
    document.removeEventListener('visibilitychange', this.onVisible);
    this.end();
  }

  attributeChangedCallback(name, before, value) {
    if (before === value) return;
    if (name === 'src' || name === 'token') {
      this.end();
      if (this.inSight) this.begin();
    } else if (name === 'poster') {
      this.posterBox.style.backgroundImage = value ? `url(${JSON.stringify(new URL(value, location.href).href)})` : '';
    } else {
      this.apply(name);
      this.wake();
    }
  }

  apply(name) {
    const { core } = this.client ?? {};
    if (name === 'alt' || name === 'camera-controls') {
      const steers = this.hasAttribute('camera-controls');
      this.canvas.tabIndex = steers ? 0 : -1;
      this.canvas.role = steers ? 'application' : 'img';
      this.canvas.ariaLabel = this.getAttribute('alt') ?? '3D scene';
    }
    if (!core) return;
    if (name === 'field-of-view' && this.hasAttribute(name)) core._layer_fov(parseFloat(this.getAttribute(name)));
    if (name === 'sun') this.client.setSun(...(this.hasAttribute(name) ? numbersOf(this.getAttribute(name)) : []));
    if (name === 'paused') this.client.play(!this.hasAttribute(name));
    if (name === 'camera-eye' || name === 'camera-target') {
      const eye = numbersOf(this.getAttribute('camera-eye')), target = numbersOf(this.getAttribute('camera-target'));
      if (eye.length === 3 && target.length === 3) core._layer_look(...eye, ...target);
    }
  }

  // --- its life -----------------------------------------------------------------------------------------------------------
  begin() {
    if (this.client || !this.getAttribute('src')) { this.wake(); return; }
    const gl = this.canvas.getContext('webgl2', { alpha: false, depth: false, stencil: false, antialias: false, powerPreference: 'high-performance' });
    try {
      if (!gl) throw new Error('this browser has no WebGL 2, which the scene is drawn with');
      this.client = new MirageClient({ gl, url: this.getAttribute('src'), token: this.getAttribute('token') ?? '', sky: true });
    } catch (error) {
      this.say(error.message);
      this.tell('error', { text: error.message });
      return;
    }
    const { client } = this;
    client.addEventListener('error', ({ detail }) => { this.say(detail.text); this.tell('error', detail); });
    client.addEventListener('down', ({ detail }) => { this.say(`${detail.text}: trying again`); this.tell('down', detail); });
    client.addEventListener('up', () => { this.say(''); this.tell('up', {}); });
    client.addEventListener('rest', () => this.tell('rest', {}));
    client.addEventListener('needs-render', () => this.wake());
    client.ready.then(() => {
      if (client !== this.client) return;
      for (const name of ['alt', 'camera-controls', 'field-of-view', 'sun', 'paused', 'camera-eye']) if (name !== 'sun' || this.hasAttribute(name)) this.apply(name);
      this.wake();
    }, () => {});
  }

  end() {
    this.sleep();
    this.client?.dispose();
    this.client = null;
    this.posterBox.hidden = false;
    this.say('');
  }

  tell(type, detail) { this.dispatchEvent(new CustomEvent(type, { detail })); }
  say(text) {
    this.word.textContent = text;  // text, never markup
    this.word.hidden = text === '';
  }

  touched() {
    this.handAt = performance.now();
    this.wake();
  }

  // --- frames -------------------------------------------------------------------------------------------------------------
  wake() {
    if (this.next || !this.inSight || document.hidden || !this.client?.usable) return;
    this.before = 0;
    this.next = requestAnimationFrame((at) => this.tick(at));
  }
  sleep() {
    cancelAnimationFrame(this.next);
    clearTimeout(this.rotation);
    this.next = 0;
  }

  size() {
    const ratio = Math.min(mostPixelRatio, devicePixelRatio || 1);
    return [this.clientWidth, this.clientHeight].map((edge) => Math.max(1, Math.round(edge * ratio)));
  }

  /// Returns the steering of this frame, and whether another one has to follow.
  steering(at) {
    const seconds = this.before ? Math.min(0.1, (at - this.before) / 1000) : 1 / 60;
    const motion = this.controls.take(seconds);
    const steers = this.hasAttribute('camera-controls');
    const steering = steers ? motion.steering : [...still];
    const wants = this.hasAttribute('auto-rotate') && this.client.loaded && !matchMedia('(prefers-reduced-motion: reduce)').matches;
    const rests = at - this.handAt;
    if (wants && rests > rotateAfterMs) steering[2] -= rotateRate * seconds;
    if (wants && rests <= rotateAfterMs) {
      clearTimeout(this.rotation);
      this.rotation = setTimeout(() => this.wake(), rotateAfterMs - rests + 20);
    }
    return { steering, goesOn: (steers && motion.held) || (wants && rests > rotateAfterMs), moved: steering.some((n) => n !== 0) };
  }

  tick(at) {
    this.next = 0;
    const { client } = this;
    if (!client?.usable) return;
    const { steering, goesOn, moved } = this.steering(at);
    const { core } = client;
    const [width, height] = this.size();
    core.HEAPF64.set(steering, client.views >> 3);
    const there = client.frame(() => core._layer_steered_frame(performance.now() - client.began, width, height, client.views), 1);
    if (there && client.drawn) {
      const [picture] = client.pictures;
      if (this.canvas.width !== picture.width || this.canvas.height !== picture.height) Object.assign(this.canvas, { width: picture.width, height: picture.height });
      core._layer_present();
      if (!this.posterBox.hidden) {
        this.posterBox.hidden = true;
        this.tell('load', {});
      }
    }
    if (moved) this.tell('camera-change', {});
    this.before = at;
    if (!client.atRest || goesOn || client.arrivals.length) this.next = requestAnimationFrame((then) => this.tick(then));
  }

  // --- for scripts --------------------------------------------------------------------------------------------------------
  /// True once there is a picture of the scene.
  get loaded() { return Boolean(this.client?.loaded); }
  /// True if the picture would not get better.
  get atRest() { return Boolean(this.client?.atRest); }
  /// Returns { eye, target }, m; null before there is a scene.
  get camera() {
    const core = this.client?.core;
    if (!core || !this.client.scene) return null;
    const at = core._layer_eye() >> 3;
    const n = [...core.HEAPF64.subarray(at, at + 9)];
    return { eye: n.slice(0, 3), target: n.slice(0, 3).map((v, i) => v + n[3 + i]), pivot: n.slice(6) };
  }
  /// Looks from `eye` at `target`; three numbers each, m.
  setCamera(eye, target) {
    this.client?.core?._layer_look(...eye, ...target);
    this.wake();
  }
  /// Goes back to where the scene is looked at from at first.
  resetCamera() {
    this.client?.core?._layer_home();
    this.wake();
  }
  /// As MirageClient.stats().
  stats() { return this.client?.stats() ?? {}; }
}

customElements.define('mirage-view', MirageView);
