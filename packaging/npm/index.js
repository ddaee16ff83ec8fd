// A scene of a Mirage server on a WebGL 2 context of yours: each view as a texture of colour and one
// of depth. three.js and the <mirage-view> element are built on it.
import createMirage from './mirage.js';

const firstPauseMs = 250, longestPauseMs = 5000;  // before the next try to connect
const viewNumbers = 13;
const drawn = 1, resting = 2, drawable = 4;  // bits of layer_frame()
// Extensions that the core uses where the context has them; each has to be asked for by name.
const extensions = ['EXT_clip_control', 'EXT_color_buffer_float', 'EXT_float_blend', 'EXT_color_buffer_half_float',
  'EXT_texture_filter_anisotropic', 'OES_texture_float_linear', 'WEBGL_debug_renderer_info'];
const modules = new Map();  // by address: compiled once for all scenes of a page

const sharedNow = () => performance.timeOrigin + performance.now();

function compiled(source) {
  if (source instanceof WebAssembly.Module) return Promise.resolve(source);
  if (source instanceof Response) return WebAssembly.compileStreaming(source);
  const key = String(source);
  if (!modules.has(key)) {
    modules.set(key, fetch(key).then((answer) => {
      if (!answer.ok) throw new Error(`${key}: ${answer.status}`);
      const typed = new Response(answer.body, { headers: { 'Content-Type': 'application/wasm' } });
      return WebAssembly.compileStreaming(typed);
    }));
    modules.get(key).catch(() => modules.delete(key));
  }
  return modules.get(key);
}

// Browsers start workers from the page's own origin only. One of another origin is imported by a small one of ours.
function startWorker(source) {
  if (source instanceof Worker) return source;
  if (source === undefined) {
    const own = new URL('./worker.js', import.meta.url);
    if (own.origin === location.origin || own.protocol === 'blob:') return new Worker(new URL('./worker.js', import.meta.url), { type: 'module' });
    source = own;
  }
  const url = new URL(source, location.href);
  if (url.origin === location.origin) return new Worker(url, { type: 'module' });
  const blob = new Blob([`import ${JSON.stringify(url.href)};`], { type: 'text/javascript' });
  return new Worker(URL.createObjectURL(blob), { type: 'module' });
}

/// Returns the addresses of a server's socket and of a frozen folder, and what the address chose. One that names frozen.bin is
/// a folder's; where no server answers at another, a folder is looked for there.
function addressOf(url) {
  const at = URL.canParse(url, location.href) ? new URL(url, location.href) : null;
  if (!/^(https?|wss?):$/.test(at?.protocol)) throw new TypeError(`url is ${url}, and no address with http, https, ws or wss`);
  const chosen = { clip: at.searchParams.get('clip') ?? '', variant: at.searchParams.get('variant') ?? '' };
  const frozen = /\/frozen\.(bin|json)$/.test(at.pathname);
  const folder = new URL(at);
  folder.protocol = /s:$/.test(at.protocol) ? 'https:' : 'http:';
  at.protocol = /s:$/.test(at.protocol) ? 'wss:' : 'ws:';
  for (const address of [at, folder]) {
    address.hash = '';
    address.search = '';
    address.pathname = address.pathname.replace(/[^/]*$/, '');
  }
  return { socket: frozen ? null : at.href, folder: folder.href, ...chosen };
}

function numberWithin(name, value, low, high) {
  if (!(value >= low && value <= high)) throw new RangeError(`${name} is ${value}, and not ${low} to ${high}`);
  return value;
}

/// A client of one server, or of a frozen folder (mirage-freeze). Events: `load` (there is something to draw), `rest` (the picture would not get better), `needs-render`
/// (something has arrived), `down` (the server is gone; it is tried again), `up`, `hole` (a file of the folder is missing or
/// damaged), and `error`; the last five have `detail.text`.
export class MirageClient extends EventTarget {
  /// options: gl (a WebGL 2 context), url, token, frameMs (0: by renderer), tauPx, samples (0: chosen frame by frame), sky,
  /// atlasMb, geometryMb, wasm (address, Response or Module), worker (address or Worker).
  /// Throws TypeError or RangeError if an option makes no sense.
  constructor(options) {
    super();
    const { gl, url, token = '', frameMs = 0, tauPx = 1, samples = 0, sky = false, atlasMb = 192, geometryMb = 256 } = options;
    if (!(gl instanceof WebGL2RenderingContext)) throw new TypeError('gl is no WebGL 2 context');
    this.gl = gl;
    this.address = addressOf(url);
    this.options = {
      frameMs: numberWithin('frameMs', frameMs, 0, 10000), tauPx: numberWithin('tauPx', tauPx, 0.01, 1000),
      samples: numberWithin('samples', samples, 0, 16), atlasMb: numberWithin('atlasMb', atlasMb, 8, 2048),
      geometryMb: numberWithin('geometryMb', geometryMb, 1, 2048), sky: Boolean(sky), token: String(token) };
    this.core = null;
    this.pictures = [];     // of the last update, one for each view
    this.loaded = false;
    this.atRest = false;
    this.connected = false;
    this.frozen = false;    // a folder answers: it has one light, and nothing in it moves
    this.lost = false;
    this.disposed = false;
    this.arrivals = [];
    this.pauseMs = firstPauseMs;
    this.began = performance.now();
    /// Resolves once the core runs, and rejects where it cannot.
    this.ready = this.start(options);
    this.ready.catch((error) => this.fail(`Mirage did not start: ${error.message}`));
  }

  async start({ wasm, worker }) {
    const module = compiled(wasm ?? new URL('./mirage.wasm', import.meta.url));
    module.catch(() => {});  // told below; the worker may fail first
    this.worker = startWorker(worker);
    this.worker.onmessage = ({ data }) => this.heard(data);
    this.worker.onerror = () => this.fail('the worker that talks to the server did not start: the page\'s policy may forbid it (worker-src)');
    this.worker.postMessage({ module: await module });
    this.connect();
    const core = await createMirage({
      instantiateWasm: (imports, done) => {
        module.then((code) => WebAssembly.instantiate(code, imports)).then((instance) => done(instance), (error) => this.fail(error.message));
        return {};
      },
      write: (bytes) => this.worker.postMessage({ send: bytes }, [bytes.buffer]),
    });
    if (this.disposed) return;
    const { frameMs, tauPx, samples, atlasMb, geometryMb, sky, token } = this.options;
    const texts = [token, this.address.clip, this.address.variant].map((text) => textOf(core, text));
    core._layer_start(frameMs, tauPx, samples, atlasMb, geometryMb, sky ? 1 : 0, ...texts);
    texts.forEach((at) => core._free(at));
    for (const name of extensions) this.gl.getExtension(name);
    this.handle = core.GL.registerContext(this.gl, { majorVersion: 2, enableExtensionsByDefault: false });
    core.GL.makeContextCurrent(this.handle);
    this.core = core;
    this.views = core._malloc(4 * 8 * viewNumbers);
    this.attach();
  }

  attach() {
    const { core } = this;
    if (core._layer_attach() < 0) { this.fail(core.UTF8ToString(core._layer_text())); return; }
    core._layer_connected(this.connected ? 1 : 0);
    this.tell('needs-render');
  }

  tell(type, text = '') { this.dispatchEvent(new CustomEvent(type, { detail: { text } })); }
  fail(text) {
    if (this.disposed) return;
    this.problem = text;
    this.tell('error', text);
  }

  // --- the server ---------------------------------------------------------------------------------------------------------
  connect() { if (!this.disposed) this.worker.postMessage({ connect: this.address.socket, folder: this.address.folder }); }

  heard(data) {
    if (this.disposed) return;
    if (data.arrival) { this.arrivals.push(data.arrival); this.tell('needs-render'); }
    if (data.open) {
      this.connected = true;
      this.frozen = data.frozen;
      this.core?._layer_connected(1);
      this.tell('up');
      this.tell('needs-render');
    }
    if (data.hole) this.tell('hole', `${data.hole} of ${this.address.folder} is missing or damaged`);
    if (data.closed) this.closed(data.closed);
  }

  closed({ code, reason, opened }) {
    this.connected = false;
    this.arrivals.length = 0;
    this.core?._layer_connected(0);
    const refused = {
      1002: `the server refused what was said (${reason})`, 1008: `the server refused what was said (${reason})`,
      1009: `the server refused what was said (${reason})`, 4001: 'the server speaks another version of Mirage',
      4003: this.options.token ? 'the server does not know this token' : 'the server asks for a token',
      4901: `the frozen folder cannot be read (${reason})`, 4902: `there is no frozen.bin at ${reason}`,
      4900: `what the server sent cannot be read (${reason})` }[code];
    if (refused) { this.fail(refused); return; }
    const goodbye = this.core ? this.core.UTF8ToString(this.core._layer_goodbye()) : '';
    const wait = this.pauseMs * (1 + 0.15 * Math.random());
    this.pauseMs = Math.min(2 * this.pauseMs, longestPauseMs);
    this.retry = setTimeout(() => this.connect(), wait);
    const why = opened ? `the server is gone${goodbye ? ` (${goodbye})` : ''}`
      : `no server answers at ${this.address.socket}, or it does not let ${location.origin} in (mirage-server --allow-origin ${location.origin})`;
    this.tell('down', why);
  }

  deliver() {
    const { core } = this;
    for (const { control, payload, packed, wire, at } of this.arrivals.splice(0)) {
      const pointer = core._malloc(control.length + payload.length);
      core.HEAPU8.set(control, pointer);
      core.HEAPU8.set(payload, pointer + control.length);
      core._layer_arrived(pointer, control.length, pointer + control.length, payload.length, packed, wire, Math.max(0, sharedNow() - at));
      core._free(pointer);
    }
  }

  // --- frames -------------------------------------------------------------------------------------------------------------
  /// True if update() can draw.
  get usable() { return Boolean(this.core) && !this.lost && !this.disposed && !this.problem; }

  /// Takes in what has arrived, and draws views into their textures (`pictures`). A view is { eye: [x, y, z], rotation:
  /// [x, y, z, w], tangents: { left, right, down, up }, width, height }, in metres of the scene; up to four. GL values are
  /// their initial ones afterwards, and nothing is bound. Returns true if there are pictures.
  update(views) {
    if (!this.usable) return false;
    views.slice(0, 4).forEach(({ eye, rotation, tangents, width, height }, i) => {
      this.core.HEAPF64.set([...eye, ...rotation, tangents.left, tangents.right, tangents.down, tangents.up, width, height],
        (this.views >> 3) + i * viewNumbers);
    });
    return this.frame(() => this.core._layer_frame(performance.now() - this.began, this.views, views.length), views.length);
  }

  frame(draw, count) {
    const { core } = this;
    core.GL.makeContextCurrent(this.handle);
    this.deliver();
    const bits = draw();
    if (bits < 0) {
      this.tell('error', core.UTF8ToString(core._layer_text()));
      this.pictures = [];
      return false;
    }
    this.drawn = (bits & drawn) !== 0;
    this.pictures = [];
    for (let view = 0; view < count; ++view) {
      const at = core._layer_picture(view) >> 3;
      if (at === 0) break;
      const [color, depth, width, height, x, y] = core.HEAPF64.subarray(at, at + 6);
      this.pictures.push({ color: core.GL.textures[color], depth: core.GL.textures[depth], width, height, windowDepth: [x, y] });
    }
    if ((bits & drawable) && !this.loaded) {
      this.loaded = true;
      this.pauseMs = firstPauseMs;
      this.tell('load');
    }
    const rests = (bits & resting) !== 0;
    if (rests && !this.atRest) this.tell('rest');
    this.atRest = rests;
    return this.pictures.length > 0;
  }

  /// Returns { name, center, radius, home: { eye, target } } in metres; null before the server has told them.
  get scene() {
    const at = this.core ? this.core._layer_scene() >> 3 : 0;
    if (at === 0) return null;
    const n = [...this.core.HEAPF64.subarray(at, at + 10)];
    const name = this.core.UTF8ToString(this.core._layer_scene_name());
    return { name, center: n.slice(0, 3), radius: n[3], home: { eye: n.slice(4, 7), target: n.slice(7, 10) } };
  }
  /// Returns the figures of the last frame (docs/reference/view-statistics.md names them); {}: there is none.
  stats() { return this.core && this.loaded ? JSON.parse(this.core.UTF8ToString(this.core._layer_figures(performance.now() - this.began))) : {}; }
  /// Returns the point that a picture shows at a place (0 to 1, right and down), m; null: nothing. It waits for the graphics card,
  /// and leaves GL values as update() does.
  pointAt(view, x, y) {
    if (!this.usable) return null;
    this.core.GL.makeContextCurrent(this.handle);
    const at = this.core._layer_point_at(view, x, y) >> 3;
    const [hit, ...point] = this.core.HEAPF64.subarray(at, at + 4);
    return hit ? point : null;
  }
  /// Sets the sun, degrees; no arguments: the scene's own light. A frozen folder keeps its light, and says so.
  setSun(azimuth = NaN, elevation = NaN) {
    if (this.frozen) console.warn(`Mirage: ${this.address.folder} was frozen under its light, which cannot be turned`);
    this.core?._layer_sun(azimuth, elevation, performance.now() - this.began);
  }
  /// Stops the animation, or lets it go on.
  play(playing) { this.core?._layer_play(playing ? 1 : 0, performance.now() - this.began); }
  /// Tells how long the graphics card took for the last update that drew, ms: later frames are planned by it.
  noteGpuMs(ms) { if (this.usable) this.core._layer_gpu_ms(ms); }

  // --- its end ------------------------------------------------------------------------------------------------------------
  /// Call it on `webglcontextlost`.
  contextLost() {
    if (!this.core || this.lost) return;
    this.lost = true;
    this.pictures = [];
    this.core._layer_detach(1);
  }
  /// Call it on `webglcontextrestored`: everything comes again from the server.
  contextRestored() {
    if (!this.lost || this.disposed) return;
    this.lost = false;
    for (const name of extensions) this.gl.getExtension(name);
    this.core.GL.makeContextCurrent(this.handle);
    this.connected = false;
    this.arrivals.length = 0;
    this.attach();
    this.connect();
  }
  /// Releases everything; the context stays the host's.
  dispose() {
    if (this.disposed) return;
    this.disposed = true;
    clearTimeout(this.retry);
    if (this.core && !this.lost) {
      this.core.GL.makeContextCurrent(this.handle);
      this.core._layer_detach(0);
    }
    this.worker?.terminate();
    this.pictures = [];
    this.loaded = this.atRest = this.connected = false;
    this.core = null;
  }
}

function textOf(core, text) {
  const bytes = new TextEncoder().encode(`${text}\0`);
  const at = core._malloc(bytes.length);
  core.HEAPU8.set(bytes, at);
  return at;
}
