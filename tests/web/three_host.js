// A host's page for three.test.mjs: the same model by Mirage and by three.js itself, a blue cube, and what tests ask of them.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { EffectComposer } from 'three/addons/postprocessing/EffectComposer.js';
import { OutputPass } from 'three/addons/postprocessing/OutputPass.js';
import { RenderPass } from 'three/addons/postprocessing/RenderPass.js';
import { MirageScene } from 'mirage-client/three';

globalThis.version = THREE.REVISION;
const warn = console.warn;
let warned = '';
console.warn = (...words) => { warned += words.join(' '); warn(...words); };
const isBlue = (p, i) => p[i + 2] > 150 && p[i] < 60 && p[i + 1] < 60;

async function ownModel() {
  const { scene } = await new GLTFLoader().loadAsync('/monkey.glb');
  scene.traverse((o) => { if (o.isMesh) o.material = new THREE.MeshBasicMaterial({ color: 0xffffff, side: THREE.DoubleSide }); });
  return scene;
}

globalThis.make = async (o) => {
  if (o.xr) {
    const { XRDevice, metaQuest3 } = await import('iwer');
    const device = new XRDevice(metaQuest3, { stereoEnabled: true });
    device.installRuntime({ forceInstall: true });
    device.stereoEnabled = true;
    delete globalThis.XRWebGLBinding;  // the browser's own, which knows nothing of the emulated device
  }
  const renderer = new THREE.WebGLRenderer({
    antialias: Boolean(o.antialias), reversedDepthBuffer: Boolean(o.reversed), logarithmicDepthBuffer: Boolean(o.logarithmic),
    ...(o.half ? { outputBufferType: THREE.HalfFloatType } : {}) });
  document.body.append(renderer.domElement);
  renderer.setSize(innerWidth, innerHeight);
  const camera = new THREE.PerspectiveCamera(50, innerWidth / innerHeight, 0.1, 200);
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0x203020);
  const mirage = new MirageScene({ renderer, url: o.url, sky: false, frameMs: 10000, samples: 1 });
  const own = await ownModel();
  const cube = new THREE.Mesh(new THREE.BoxGeometry(1.1, 1.1, 1.1), new THREE.MeshBasicMaterial({ color: 0x0000ff }));
  cube.rotation.set(0.4, 0.6, 0.1);
  cube.position.set(0.5, 0.2, 0.2);
  if (o.placed) {
    for (const one of [mirage, own]) {
      one.position.set(3, -2, 1);
      one.rotation.set(0.2, 1.1, -0.3);
      one.scale.setScalar(2.5);
    }
    cube.position.set(4.6, -1.2, 2);
    cube.scale.setScalar(2);
    camera.position.set(3, -2, 13);
  } else {
    camera.position.set(0, 0, 5);
  }
  own.visible = false;
  scene.add(mirage, own, cube);
  let composer = null;
  if (o.composer) {
    composer = new EffectComposer(renderer);
    composer.addPass(new RenderPass(scene, camera));
    composer.addPass(new OutputPass());
  }
  if (o.glass) {
    cube.material = new THREE.MeshPhysicalMaterial({ transmission: 1, roughness: 0, ior: 1, thickness: 0, color: 0xffffff });
    cube.position.set(0, 0, 2);
    cube.rotation.set(0, 0, 0);
    scene.add(new THREE.AmbientLight(0xffffff, 0.1));
  }
  const draw = () => (composer ? composer.render() : renderer.render(scene, camera));
  const one = {
    renderer, camera, scene, mirage, cube, down: '',
    get warned() { return warned; },
    render() { mirage.update(camera); one.second?.update(camera); draw(); },
    pixels() {
      const gl = renderer.getContext(), { width, height } = renderer.domElement;
      const out = new Uint8Array(4 * width * height);
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, out);
      renderer.resetState();
      if (o.reversed) { renderer.state.buffers.depth.setReversed(true); renderer.state.buffers.depth.setClear(1); }
      return { width, height, out };
    },
    moveCube(z) { cube.position.z = o.placed ? 1 + 2.5 * z : z; },
    resize(width, height, ratio) {
      renderer.setPixelRatio(ratio);
      renderer.setSize(width, height);
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
    },
    // Returns the worst of the pixels of the cube that only one of both pictures shows, px: how far it is from one where both agree,
    // or how far apart cube and model are there, seen from the side.
    compareCube() {
      one.render();
      const { width, height, out: seen } = one.pixels();
      mirage.visible = false;
      own.visible = true;
      draw();
      const { out: truth } = one.pixels();
      const focal = height / 2 * camera.projectionMatrix.elements[5];
      const rays = new THREE.Raycaster();
      const gap = (x, y) => {
        rays.setFromCamera(new THREE.Vector2((x + 0.5) / width * 2 - 1, (y + 0.5) / height * 2 - 1), camera);
        const [of, by] = [own, cube].map((object) => rays.intersectObject(object)[0]?.distance);
        return of && by ? focal * Math.abs(of - by) / Math.min(of, by) : Infinity;
      };
      let apart = 0, count = 0, wrong = 0;
      for (let y = 0; y < height; ++y) {
        for (let x = 0; x < width; ++x) {
          const blue = isBlue(seen, 4 * (y * width + x));
          count += blue ? 1 : 0;
          if (blue === isBlue(truth, 4 * (y * width + x))) continue;
          ++wrong;
          let r = 1;
          for (let found = false; r < 50 && !found; found || ++r) {
            for (let v = Math.max(0, y - r); v <= Math.min(height - 1, y + r) && !found; ++v) {
              for (let u = Math.max(0, x - r); u <= Math.min(width - 1, x + r) && !found; ++u) found = isBlue(truth, 4 * (v * width + u)) === blue;
            }
          }
          apart = Math.max(apart, Math.min(r, gap(x, y)));
        }
      }
      mirage.visible = true;
      own.visible = false;
      return { apart, count, wrong };
    },
    // Returns how far, px, points under places of the picture are from those where three.js's own ray meets the model.
    points() {
      one.render();
      own.visible = true;
      own.updateWorldMatrix(true, true);
      const rays = new THREE.Raycaster();
      const { height } = renderer.domElement;
      const focal = height / 2 * camera.projectionMatrix.elements[5];
      let hits = 0, worst = 0;
      for (let y = 0.3; y < 0.7; y += 0.02) {
        for (let x = 0.35; x < 0.65; x += 0.02) {
          rays.setFromCamera(new THREE.Vector2(2 * x - 1, 1 - 2 * y), camera);
          const around = [[0, 0], [2, 0], [-2, 0], [0, 2], [0, -2]].map(([u, v]) => {
            rays.setFromCamera(new THREE.Vector2(2 * x - 1 + 2 * u / renderer.domElement.width, 1 - 2 * y + 2 * v / height), camera);
            return rays.intersectObject(own)[0];
          });
          if (around.some((hit) => !hit)) continue;  // at the model's edge
          const depths = around.map((hit) => hit.distance);
          if (Math.max(...depths) - Math.min(...depths) > 0.01 * depths[0]) continue;  // at an edge within it, or steep
          ++hits;
          const point = mirage.pointAt(x, y);
          worst = Math.max(worst, point ? focal * point.distanceTo(around[0].point) / depths[0] : Infinity);
        }
      }
      own.visible = false;
      return { hits, worst, outside: mirage.pointAt(0.01, 0.01) };
    },
    // Returns, for two cameras of one frame, how many pixels are not the background, by Mirage and by three.js itself.
    twoViews() {
      const other = camera.clone();
      other.position.x += 1.2;
      cube.visible = false;
      const counts = (each) => { renderer.render(scene, each); return one.notBackground(); };
      mirage.update([camera, other]);
      const seen = [camera, other].map(counts);
      if (!mirage.atRest) return null;
      mirage.visible = false;
      own.visible = true;
      const truth = [camera, other].map(counts);
      mirage.visible = true;
      own.visible = false;
      return seen.map((n, i) => [n, truth[i]]);
    },
    notBackground() {
      const { out } = one.pixels();
      let count = 0;
      for (let i = 0; i < out.length; i += 4) {
        count += Math.abs(out[i] - 0x20) + Math.abs(out[i + 1] - 0x30) + Math.abs(out[i + 2] - 0x20) < 12 ? 0 : 1;
      }
      return count;
    },
    hostPictures() {
      const differ = (a, b) => a.reduce((n, v, i) => n + (v !== b[i] ? 1 : 0), 0);
      const picture = () => { draw(); return one.pixels().out; };
      const lit = new THREE.Mesh(new THREE.SphereGeometry(0.5), new THREE.MeshStandardMaterial({ color: 0xff8800 }));
      scene.add(lit, new THREE.HemisphereLight(0xffffff, 0x222222, 3));
      lit.position.set(-1, 0.5, 1);
      scene.remove(mirage);
      const before = picture(), again = picture();
      scene.add(mirage);
      mirage.update(camera);
      mirage.visible = false;
      const hidden = picture();
      mirage.visible = true;
      one.render();
      mirage.dispose();
      scene.remove(mirage);
      return { without: differ(before, again), hidden: differ(before, hidden), disposed: differ(before, picture()) };
    },
    // Returns the pixels on either side that are neither the background's nor the cube's.
    halves() {
      one.render();
      const { width, height, out } = one.pixels();
      const sides = { left: 0, right: 0 };
      for (let i = 0; i < width * height; ++i) {
        const background = Math.abs(out[4 * i] - 0x20) + Math.abs(out[4 * i + 1] - 0x30) + Math.abs(out[4 * i + 2] - 0x20) < 12;
        if (!background && !isBlue(out, 4 * i)) ++sides[i % width < width / 2 ? 'left' : 'right'];
      }
      return sides;
    },
    throughGlass() {
      one.render();
      const { out: through } = one.pixels();
      mirage.visible = false;
      draw();
      const { out: without } = one.pixels();
      mirage.visible = true;
      draw();
      let changed = 0;
      const { width, height } = renderer.domElement;
      for (let y = Math.round(height * 0.45); y < height * 0.55; ++y) {
        for (let x = Math.round(width * 0.45); x < width * 0.55; ++x) {
          const i = 4 * (y * width + x);
          changed += Math.abs(through[i + 1] - without[i + 1]) > 20 ? 1 : 0;
        }
      }
      return changed;
    },
    async enterXr() {
      renderer.xr.enabled = true;
      const session = await navigator.xr.requestSession('immersive-vr', { optionalFeatures: ['local-floor'] });
      for (const each of [mirage, own]) each.position.set(0.2, 1.6, -4);  // before the eyes of the device
      cube.visible = false;
      renderer.xr.setReferenceSpaceType('local');
      await renderer.xr.setSession(session);
      one.seenEyes = null;
      renderer.setAnimationLoop(() => {
        mirage.update(camera);
        renderer.render(scene, camera);
        if (!mirage.atRest) return;
        const eyes = eyePixels();
        mirage.visible = false;
        own.visible = true;
        renderer.render(scene, camera);
        one.seenEyes = { eyes, truth: eyePixels() };
        mirage.visible = true;
        own.visible = false;
      });
    },
    eyes() { return one.seenEyes; },
    wrongCameras() {
      const told = { times: 0 };
      mirage.addEventListener('error', ({ text }) => { ++told.times; told.last = text; });
      const flat = new THREE.OrthographicCamera(-2, 2, 2, -2, 0.1, 50);
      mirage.update(flat);
      mirage.update(flat);
      told.orthographic = told.last;
      mirage.scale.set(1, 2, 1);
      mirage.update(camera);
      told.squeezed = told.last;
      mirage.scale.set(1, 1, 1);
      told.back = mirage.update(camera);
      mirage.scale.set(1, 2, 1);
      mirage.update(camera);
      mirage.scale.set(1, 1, 1);
      try { new MirageScene({ renderer, url: o.url, frameMs: -1 }); } catch (error) { told.option = error.message; }
      return told;
    },
  };
  // Counts what is not the background in each eye's part of XR's framebuffer, and where its middle is.
  function eyePixels() {
    const gl = renderer.getContext();
    const cameras = renderer.xr.getCamera().cameras, target = renderer.getRenderTarget();
    gl.bindFramebuffer(gl.FRAMEBUFFER, renderer.xr.getSession().renderState.baseLayer?.framebuffer ?? null);
    const sides = cameras.map(({ viewport }) => {
      const [x, y, w, h] = [viewport.x, viewport.y, viewport.z, viewport.w];
      const p = new Uint8Array(4 * w * h);
      gl.readPixels(x, y, w, h, gl.RGBA, gl.UNSIGNED_BYTE, p);
      let count = 0, sum = 0;
      for (let i = 0; i < w * h; ++i) {
        if (Math.abs(p[4 * i] - p[4 * ((h - 2) * w + 1)]) + Math.abs(p[4 * i + 1] - p[4 * ((h - 2) * w + 1) + 1]) > 24) { ++count; sum += i % w; }
      }
      return { count, middle: sum / Math.max(1, count) };
    });
    renderer.resetState();
    if (target) renderer.setRenderTarget(target);
    return sides;
  }
  mirage.addEventListener('down', ({ text }) => { one.down = text; });
  if (o.second) {
    one.second = new MirageScene({ renderer, url: o.second, frameMs: 10000, samples: 1 });
    mirage.position.x = -1.6;
    one.second.position.x = 1.6;
    one.second.scale.setScalar(0.4);
    cube.visible = false;
    scene.add(one.second);
  }
  return one;
};
