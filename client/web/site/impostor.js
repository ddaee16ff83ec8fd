// Impostor: lets a picture with depth (GET /v1/impostor) follow the pointer a little. It has no
// dependencies, and other sites use it as well:
//   <script type="module" src="https://HOST/impostor.js"></script>
//   <img src="https://HOST/v1/impostor?size=640x360" data-mirage-impostor width="640" height="360" alt="…">
// An image shows itself. While it moves, a canvas lies over it; all images of a page share one. Where
// there is no WebGL 2, or less motion is preferred, and at rest, the image is all there is.

const reach = [0.05, 0.025];  // shares of the picture's height by which nearest and farthest part, to each side
const pivot = 0.3;       // nearness that stands still: 0 is the farthest, 1 the nearest
const easeMs = 120;      // in which two thirds of a way are gone
const margin = 0.1;      // of the picture, which goes on behind its edge as in a mirror
const restAt = 0.002;    // of the reach, less than a pixel
const copied = ['objectFit', 'objectPosition', 'borderRadius', 'border', 'padding', 'filter', 'clipPath'];
const headBytes = 56;    // of the chunk's content, before the depth
const cellTexels = 4;    // of the picture, to a texel of the depth
const still = matchMedia('(prefers-reduced-motion: reduce)');

const vertexShader = `#version 300 es
uniform highp sampler2D nearness;
uniform vec2 cell, shift;  // a cell's share of the picture; the way of nearness 1, in clip space
uniform float pivot, margin;
out vec2 place;
void main() {
  ivec2 count = textureSize(nearness, 0);
  int square = gl_VertexID / 6, corner = gl_VertexID % 6;
  ivec2 at = ivec2(square % (count.x + 1), square / (count.x + 1)) +
    ivec2(corner == 1 || corner == 2 || corner == 4, corner >= 2 && corner != 3);
  float near = 0.0;  // the nearest around: what the grid stretches beside things in front then has the colours behind them
  for (int i = 0; i < 9; ++i) {
    ivec2 texel = clamp(at + ivec2(i % 3, i / 3) - 2, ivec2(0), count - 1);
    near = max(near, texelFetch(nearness, texel, 0).r);
  }
  place = (vec2(at) - 0.5) * cell;
  place = mix(place, vec2(-margin), equal(at, ivec2(0)));
  place = mix(place, vec2(1.0 + margin), greaterThan(at, count));
  gl_Position = vec4(place * vec2(2, -2) + vec2(-1, 1) + shift * (near - pivot), 1.0 - 2.0 * near, 1);
}`;
const fragmentShader = `#version 300 es
precision mediump float;
uniform sampler2D colors;
in highp vec2 place;
out vec4 color;
void main() { color = vec4(texture(colors, place).rgb, 1); }`;

// Returns the files of colours and nearness in an impostor (server/tile/impostor_file.h); null: it is none.
function readImpostor(buffer) {
  const view = new DataView(buffer);
  const name = (at) => (at + 4 <= view.byteLength ? view.getUint32(at) : 0);
  if (name(0) !== 0x52494646 || name(8) !== 0x57454250) return null;  // RIFF, WEBP
  for (let at = 12; at + 8 <= view.byteLength;) {
    const bytes = view.getUint32(at + 4, true), from = at + 8;
    if (name(at) === 0x4D495249) {  // MIRI
      if (bytes <= headBytes || from + bytes > view.byteLength || view.getUint32(from, true) !== 1) return null;
      return [new Uint8Array(buffer), new Uint8Array(buffer, from + headBytes, bytes - headBytes)];
    }
    at = from + bytes + bytes % 2;
  }
  return null;
}

const exactly = { colorSpaceConversion: 'none', premultiplyAlpha: 'none' };

async function load(image) {
  const address = image.currentSrc || image.src;
  let buffer;
  if (address.startsWith('data:')) {
    buffer = Uint8Array.from(atob(address.slice(address.indexOf(',') + 1)), (c) => c.charCodeAt(0)).buffer;
  } else {
    const answer = await fetch(address);
    if (!answer.ok) return null;
    buffer = await answer.arrayBuffer();
  }
  const parts = readImpostor(buffer);
  return parts && Promise.all(parts.map((bytes) => createImageBitmap(new Blob([bytes], { type: 'image/webp' }), exactly)));
}

/// The canvas that draws one impostor after another; null without WebGL 2.
function makeRelief() {
  const canvas = document.createElement('canvas');
  const gl = canvas.getContext('webgl2', { alpha: false, antialias: false });
  if (!gl) return null;
  canvas.setAttribute('aria-hidden', 'true');
  canvas.style.cssText = 'position:fixed;box-sizing:border-box;max-width:none;margin:0;pointer-events:none';
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertexShader], [gl.FRAGMENT_SHADER, fragmentShader]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) return null;
  gl.useProgram(program);
  gl.enable(gl.DEPTH_TEST);
  gl.depthFunc(gl.LEQUAL);
  const uniform = (name) => gl.getUniformLocation(program, name);
  gl.uniform1i(uniform('nearness'), 1);
  gl.uniform1f(uniform('pivot'), pivot);
  gl.uniform1f(uniform('margin'), margin);
  const [cell, shift] = [uniform('cell'), uniform('shift')];
  const fill = (unit, bitmap, filter) => {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, filter);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.MIRRORED_REPEAT);
  };
  let vertices = 0;
  return { canvas, lost: () => gl.isContextLost(), lose: () => gl.getExtension('WEBGL_lose_context')?.loseContext(),
    take([colors, depth]) {
      for (const unit of [0, 1]) {
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.deleteTexture(gl.getParameter(gl.TEXTURE_BINDING_2D));
      }
      [canvas.width, canvas.height] = [colors.width, colors.height];
      gl.viewport(0, 0, colors.width, colors.height);
      fill(0, colors, gl.LINEAR);
      fill(1, depth, gl.NEAREST);
      gl.uniform2f(cell, cellTexels / colors.width, cellTexels / colors.height);
      vertices = 6 * (depth.width + 1) * (depth.height + 1);
    },
    draw([x, y]) {
      gl.uniform2f(shift, -2 * reach[0] * x * canvas.height / canvas.width, 2 * reach[1] * y);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.drawArrays(gl.TRIANGLES, 0, vertices);
    } };
}

let relief = null;    // made when the first image moves
let shown = null;     // the image that moves: { image, at, to, there }
let next = 0, lastAt = 0;
const loaded = new WeakMap();   // image: { address, parts }

// Lays the canvas over the image, wherever that is now.
function place(image) {
  const { canvas } = relief;
  const box = image.getBoundingClientRect(), style = getComputedStyle(image);
  for (const name of copied) canvas.style[name] = style[name];
  [canvas.style.width, canvas.style.height] = [`${box.width}px`, `${box.height}px`];
  if (canvas.previousElementSibling !== image) image.after(canvas);
  const now = canvas.getBoundingClientRect();
  canvas.style.left = `${(parseFloat(canvas.style.left) || 0) + box.left - now.left}px`;
  canvas.style.top = `${(parseFloat(canvas.style.top) || 0) + box.top - now.top}px`;
}

function tick(now) {
  next = 0;
  if (!shown?.there) return;
  if (relief.lost() || !shown.image.isConnected) { end(shown.image); return; }
  const share = 1 - Math.exp(-Math.min(50, lastAt ? now - lastAt : 16) / easeMs);
  lastAt = now;
  shown.at = shown.at.map((v, i) => v + (shown.to[i] - v) * share);
  const left = Math.max(...shown.at.map((v, i) => Math.abs(shown.to[i] - v)));
  if (left < restAt && shown.to.every((v) => v === 0)) { end(shown.image); return; }
  relief.draw(shown.at);
  place(shown.image);
  if (left >= restAt) wake();
  else lastAt = 0;
}

function wake() { next ||= requestAnimationFrame(tick); }

function begin(image) {
  end(shown?.image);
  shown = { image, at: [0, 0], to: [0, 0], there: false };
  const mine = shown, address = image.currentSrc || image.src;
  if (loaded.get(image)?.address !== address) loaded.set(image, { address, parts: load(image).catch(() => null) });
  loaded.get(image).parts.then((parts) => {
    if (shown !== mine || !parts) return;
    if (!relief || relief.lost()) relief = makeRelief();
    if (!relief) return;
    relief.take(parts);
    shown.there = true;
    wake();
  });
}

/// Shows the image alone again, at once.
export function end(image) {
  if (!shown || shown.image !== image) return;
  relief?.canvas.remove();
  shown = null;
  lastAt = 0;
}

/// Gives back what the graphics hold; a later motion takes it again.
export function dispose() {
  end(shown?.image);
  relief?.lose();
  relief = null;
}

/// Lets the image follow the pointer over `area`.
export function follow(image, area = image) {
  const rest = () => {
    if (shown?.image !== image) return;
    shown.to = [0, 0];
    wake();
  };
  area.addEventListener('pointermove', (e) => {
    if (still.matches || !image.isConnected) return;
    if (shown?.image !== image) begin(image);
    const box = area.getBoundingClientRect();
    const way = [(e.clientX - box.left) / box.width, (e.clientY - box.top) / box.height];
    shown.to = way.map((v) => Math.min(1, Math.max(-1, 2 * v - 1)));
    wake();
  }, { passive: true });
  for (const name of ['pointerleave', 'pointercancel']) area.addEventListener(name, rest);
}

const followed = new WeakSet();
addEventListener('pointerover', (e) => {
  const image = e.target;
  if (!(image instanceof HTMLImageElement) || !('mirageImpostor' in image.dataset) || followed.has(image)) return;
  followed.add(image);
  follow(image);
}, { passive: true });
