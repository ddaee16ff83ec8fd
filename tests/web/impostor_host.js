// A page for impostors.test.mjs and impostor_error.mjs: a model drawn by three.js as a mesh and as an impostor of its bake, by the
// field's protocol (512 x 512 pixels, the sphere fills the picture, ambient 0.6 and a sun of 2.5 from (2,3,1), before grey).
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { Impostors, loadBake } from '/example/impostors.js';

const EDGE = 512, GREY = 128;

function picture(renderer, samples, scene, camera) {
  const big = EDGE * samples;
  renderer.setSize(big, big, false);
  renderer.setClearColor(0x000000, 0);
  renderer.render(scene, camera);
  const gl = renderer.getContext(), raw = new Uint8Array(4 * big * big);
  gl.readPixels(0, 0, big, big, gl.RGBA, gl.UNSIGNED_BYTE, raw);
  // Averages premultiplied linear light, and lays it before grey.
  const linear = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4), table = Float64Array.from({ length: 256 }, (_, i) => linear(i / 255));
  const srgb = (v) => 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055), grey = linear(GREY / 255);
  const out = new Uint8Array(4 * EDGE * EDGE);
  for (let y = 0; y < EDGE; ++y) {
    for (let x = 0; x < EDGE; ++x) {
      const sum = [0, 0, 0, 0];
      for (let s = 0; s < samples * samples; ++s) {
        const at = 4 * ((y * samples + Math.floor(s / samples)) * big + x * samples + (s % samples));
        for (let c = 0; c < 3; ++c) sum[c] += table[raw[at + c]];
        sum[3] += raw[at + 3] / 255;
      }
      const n = samples * samples, at = 4 * (y * EDGE + x), cover = sum[3] / n;
      for (let c = 0; c < 3; ++c) out[at + c] = Math.round(srgb(sum[c] / n + (1 - cover) * grey));
      out[at + 3] = Math.round(255 * cover);
    }
  }
  return out;
}

/** PSNR over the box around both masks, and IoU of the masks. */
function compare(a, b) {
  let left = EDGE, right = -1, low = EDGE, high = -1, both = 0, either = 0;
  for (let i = 0; i < EDGE * EDGE; ++i) {
    const in_a = a[4 * i + 3] > 127, in_b = b[4 * i + 3] > 127;
    both += in_a && in_b;
    if (!(in_a || in_b)) continue;
    ++either;
    const x = i % EDGE, y = Math.floor(i / EDGE);
    left = Math.min(left, x); right = Math.max(right, x); low = Math.min(low, y); high = Math.max(high, y);
  }
  let squares = 0, values = 0;
  for (let y = low; y <= high; ++y) {
    for (let x = left; x <= right; ++x) {
      for (let c = 0; c < 3; ++c) squares += (a[4 * (y * EDGE + x) + c] - b[4 * (y * EDGE + x) + c]) ** 2;
      values += 3;
    }
  }
  return { psnr: 10 * Math.log10(255 ** 2 / (squares / values)), iou: both / either };
}

async function meshOf(model) {
  if (model === 'knot') return new THREE.Mesh(new THREE.TorusKnotGeometry(1, 0.35, 200, 32, 2, 3), new THREE.MeshLambertMaterial({ color: new THREE.Color(0.8, 0.35, 0.2) }));
  const { scene } = await new GLTFLoader().loadAsync(model);
  scene.traverse((o) => {
    if (!o.isMesh) return;
    const { map, color, alphaTest, transparent, side, vertexColors, normalMap, normalScale } = o.material;
    o.material = new THREE.MeshLambertMaterial({ map, color, side, vertexColors, normalMap, normalScale, alphaTest: transparent ? 0.5 : alphaTest });
  });
  return scene;
}

globalThis.measure = async ({ bake: address, model, directions, radii = 4, light = 'lit', cut = false, show = false }) => {
  const bake = await loadBake(address);
  const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true, alpha: true, premultipliedAlpha: true });
  const center = new THREE.Vector3(...bake.center), r = bake.radius;
  const sunDirection = new THREE.Vector3(2, 3, 1).normalize(), lit = light === 'lit';
  const meshScene = new THREE.Scene(), bakeScene = new THREE.Scene();
  const sun = new THREE.DirectionalLight(0xffffff, lit ? 2.5 : 0);
  sun.position.copy(sunDirection).multiplyScalar(1e4);
  meshScene.add(await meshOf(model), new THREE.AmbientLight(0xffffff, lit ? 0.6 : Math.PI), sun);
  const impostor = new Impostors(bake, 1, { steps: 192, cut });
  impostor.setMatrixAt(0, new THREE.Matrix4());
  impostor.setLight(new THREE.Color().setScalar(lit ? 0.6 / Math.PI : 1), sunDirection, new THREE.Color().setScalar(lit ? 2.5 / Math.PI : 0));
  bakeScene.add(impostor);
  const camera = new THREE.PerspectiveCamera(2 * Math.atan(1.05 / Math.sqrt(radii ** 2 - 1)) * 180 / Math.PI, 1, (radii - 1) * r * 0.99, (radii + 1) * r * 1.01);
  const rows = [];
  let shown = null;
  for (let i = 0; i < directions; ++i) {
    const s = Math.sin(5 * Math.PI / 180), y = s + (1 - s) * (i + 0.5) / directions, ring = Math.sqrt(1 - y * y), turn = 2.399963 * i;
    camera.position.set(ring * Math.cos(turn), y, ring * Math.sin(turn)).multiplyScalar(radii * r).add(center);
    camera.lookAt(center);
    camera.updateMatrixWorld();
    const due = picture(renderer, 4, meshScene, camera), drawn = picture(renderer, 2, bakeScene, camera);
    rows.push(compare(due, drawn));
    if (show && i === Math.floor(directions / 3)) shown = [Array.from(due), Array.from(drawn)];
  }
  renderer.dispose();
  const mean = (key) => rows.reduce((sum, row) => sum + row[key], 0) / rows.length;
  return { psnr: mean('psnr'), iou: mean('iou'), worst: Math.min(...rows.map((row) => row.psnr)), texture_mib: 2 * 4 / 3 * 4 * bake.size_px ** 2 / 1048576, shown };
};
