// Draws one glTF file with the camera and the surroundings that render.mjs asks for, and tells when
// it is done.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { DRACOLoader } from 'three/addons/loaders/DRACOLoader.js';
import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';
import { RGBELoader } from 'three/addons/loaders/RGBELoader.js';
import { EXRLoader } from 'three/addons/loaders/EXRLoader.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';

async function environment(renderer, url) {
  const loader = url.endsWith('.exr') ? new EXRLoader() : new RGBELoader();
  const image = await loader.setDataType(THREE.FloatType).loadAsync(url);
  image.mapping = THREE.EquirectangularReflectionMapping;
  return new THREE.PMREMGenerator(renderer).fromEquirectangular(image).texture;
}

async function draw(o) {
  const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  renderer.setPixelRatio(1);
  renderer.setSize(o.width, o.height);
  renderer.toneMapping = THREE.NoToneMapping;
  renderer.outputColorSpace = THREE.SRGBColorSpace;
  document.body.appendChild(renderer.domElement);

  const loader = new GLTFLoader();
  loader.setDRACOLoader(new DRACOLoader().setDecoderPath('/three/examples/jsm/libs/draco/gltf/'));
  loader.setKTX2Loader(
    new KTX2Loader().setTranscoderPath('/three/examples/jsm/libs/basis/').detectSupport(renderer));
  loader.setMeshoptDecoder(MeshoptDecoder);
  const gltf = await loader.loadAsync(o.model);

  const scene = new THREE.Scene();
  scene.background = new THREE.Color().setRGB(...o.background, THREE.LinearSRGBColorSpace);
  scene.add(gltf.scene);
  if (o.environment) scene.environment = await environment(renderer, o.environment);
  if (gltf.animations.length > 0) {
    const mixer = new THREE.AnimationMixer(gltf.scene);
    gltf.animations.forEach((clip) => mixer.clipAction(clip).play());
    mixer.setTime(0);
  }
  const box = new THREE.Box3().setFromObject(gltf.scene);
  const eye = new THREE.Vector3(...o.eye);
  const far = eye.distanceTo(box.getCenter(new THREE.Vector3())) +
    box.getSize(new THREE.Vector3()).length();
  const camera = new THREE.PerspectiveCamera(o.fov, o.width / o.height, far / 5000, far * 2);
  camera.position.copy(eye);
  camera.lookAt(...o.target);
  renderer.render(scene, camera);
}

draw(JSON.parse(decodeURIComponent(location.hash.slice(1))))
  .then(() => { window.drawn = 'yes'; })
  .catch((error) => { window.drawn = String(error && error.stack || error); });
