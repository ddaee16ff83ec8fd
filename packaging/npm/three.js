// A scene of a Mirage server as an object of three.js: it is drawn into textures of its own, and a triangle over the picture
// lays them among the host's objects by depth.
import { BufferAttribute, BufferGeometry, CustomBlending, ExternalTexture, Mesh, Object3D, OneFactor, OneMinusSrcAlphaFactor,
  Quaternion, ShaderMaterial, Vector2, Vector3 } from 'three';
import { MirageClient } from './index.js';

const vertexShader = /* glsl */`
flat out vec2 v_clip;
out vec2 v_at;
void main() {
  v_at = 0.5 * position.xy + 0.5;
  v_clip = vec2(-projectionMatrix[2][2], projectionMatrix[3][2]);
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

const fragmentShader = /* glsl */`
precision highp float;
precision highp sampler2D;
uniform sampler2D u_color;   // linear light, premultiplied; alpha: share that objects cover
uniform sampler2D u_depth;
uniform vec2 u_own;          // window depth in u_depth = x + y / eye depth, in units of the host
uniform int u_reversed;      // 1: the host's depth is reversed
#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
uniform float logDepthBufFC;
#endif
flat in vec2 v_clip;         // the host's clip depth over eye depth = x + y / eye depth
in vec2 v_at;

// Where a soft outline covers a pixel in part, its one sample of depth may be of nothing: the nearest one around counts then.
float eye_depth(ivec2 at) {
  float nothing = u_own.y > 0.0 ? 0.0 : 1.0;  // reversed or forward
  ivec2 last = textureSize(u_depth, 0) - 1;
  float there = texelFetch(u_depth, at, 0).r;
  bool none = there == nothing;
  for (int i = 0; i < 9 && none; ++i) {
    float around = texelFetch(u_depth, clamp(at + ivec2(i % 3, i / 3) - 1, ivec2(0), last), 0).r;
    there = nothing > 0.5 ? min(there, around) : max(there, around);
  }
  return u_own.y / (there - u_own.x);
}

void main() {
  vec2 size = vec2(textureSize(u_color, 0));
  ivec2 at = min(ivec2(v_at * size), ivec2(size) - 1);
  vec4 c = texture(u_color, v_at);
#ifdef MIRAGE_SKY
  gl_FragColor = vec4(c.rgb, 1.0);
#else
  if (c.a <= 0.0) discard;
  gl_FragColor = vec4(c.rgb / c.a, c.a);
#endif
  float d = eye_depth(at);
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
  gl_FragColor.rgb *= gl_FragColor.a;
  float ndc = v_clip.x + v_clip.y / d;
#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
  float window = log2(1.0 + d) * logDepthBufFC * 0.5;
#else
  float window = u_reversed == 1 ? ndc : 0.5 * ndc + 0.5;
#endif
  bool nothing = !(d > 0.0) || c.a <= 0.0;
  gl_FragDepth = nothing ? (u_reversed == 1 ? 0.0 : 1.0) : clamp(window, 0.0, 1.0);
}`;

function triangle() {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
  return geometry;
}

/// Returns the tangents of a perspective camera's edges; null: it is none (orthographic, oblique or mirrored).
function tangentsOf({ elements: m }) {
  const perspective = m[11] === -1 && m[15] === 0 && m[1] === 0 && m[2] === 0 && m[4] === 0 && m[6] === 0 && m[0] > 0 && m[5] > 0;
  if (!perspective) return null;
  return { left: (m[8] - 1) / m[0], right: (m[8] + 1) / m[0], down: (m[9] - 1) / m[5], up: (m[9] + 1) / m[5] };
}

const mirrored = 'the world matrix of a MirageScene may move, turn and scale it evenly, and nothing else';
const flat = 'Mirage draws for perspective cameras alone';

/// A Mirage scene among the objects of three.js. Place it as any object: moved, turned, scaled evenly. Call update(camera) once
/// before each render. Events: those of MirageClient (`load`, `rest`, `needs-render`, `down`, `up`, `error`), with `text`.
export class MirageScene extends Object3D {
  /// options: url, renderer (a WebGLRenderer), toneMapped (false: Mirage's colours as they are), and those of MirageClient.
  constructor({ renderer, toneMapped = false, ...options }) {
    super();
    this.renderer = renderer;
    this.toldWrong = this.toldDown = '';
    this.views = new Map();  // camera -> index of its picture
    this.client = new MirageClient({ ...options, gl: renderer.getContext() });
    for (const type of ['load', 'rest', 'needs-render', 'down', 'up', 'error']) {
      this.client.addEventListener(type, ({ detail }) => {
        if (type === 'error') console.error(`Mirage: ${detail.text}`);
        if (type === 'up') this.toldDown = '';
        if (type === 'down' && detail.text !== this.toldDown) console.warn(`Mirage: ${detail.text}`);
        if (type === 'down') this.toldDown = detail.text;
        this.dispatchEvent({ type, text: detail.text });
      });
    }
    this.textures = [];
    this.add(this.makeTriangle(toneMapped, options.sky === true));
    this.onLost = () => this.client.contextLost();
    this.onRestored = () => this.client.contextRestored();
    renderer.domElement.addEventListener('webglcontextlost', this.onLost);
    renderer.domElement.addEventListener('webglcontextrestored', this.onRestored);
  }

  makeTriangle(toneMapped, sky) {
    const material = new ShaderMaterial({
      vertexShader, fragmentShader, toneMapped, defines: sky ? { MIRAGE_SKY: 1 } : {},
      uniforms: { u_color: { value: null }, u_depth: { value: null }, u_own: { value: new Vector2() }, u_reversed: { value: 0 } },
      blending: CustomBlending, blendSrc: OneFactor, blendDst: OneMinusSrcAlphaFactor, premultipliedAlpha: true });
    const mesh = new Mesh(triangle(), material);
    mesh.frustumCulled = false;
    mesh.renderOrder = 1e9;  // after everything opaque: soft outlines blend with what is there
    mesh.raycast = () => {};
    mesh.onBeforeRender = (renderer, scene, camera) => this.showTo(camera);
    return mesh;
  }

  /// True once there is something to draw.
  get loaded() { return this.client.loaded; }
  /// True if the picture would not get better.
  get atRest() { return this.client.atRest; }
  /// As MirageClient.scene, in the scene's own metres; null before the server has told it.
  get info() { return this.client.scene; }

  /// Draws what `camera` sees into Mirage's textures, or what each of up to four cameras of one frame sees. Call it once before
  /// all of the frame's renders, and in XR within its callback. Returns true if there is a picture.
  update(camera) {
    const { renderer, client } = this;
    if (!client.usable) return false;
    this.updateWorldMatrix(true, false);
    const cameras = this.camerasOf(camera);
    const views = this.visible ? cameras.map((one) => this.viewOf(one)) : [];
    if (views.includes(null)) {
      this.views.clear();
      client.atRest = false;
      return false;
    }
    this.toldWrong = '';
    const target = renderer.getRenderTarget(), face = renderer.getActiveCubeFace(), mip = renderer.getActiveMipmapLevel();
    const there = client.update(views);
    this.giveBack(target, face, mip);
    this.views = new Map(cameras.map((one, i) => [one, i]));
    this.takePictures();
    return there;
  }

  camerasOf(camera) {
    const { xr } = this.renderer;
    if (!xr.isPresenting) {
      const cameras = [camera].flat();
      cameras.forEach((one) => one.updateWorldMatrix(true, false));
      return cameras;
    }
    xr.updateCamera(camera);
    return xr.getCamera().cameras;
  }

  viewOf(camera) {
    const tangents = tangentsOf(camera.projectionMatrix);
    const position = new Vector3(), rotation = new Quaternion(), scale = new Vector3();
    this.matrixWorld.decompose(position, rotation, scale);
    const even = scale.x > 0 && Math.abs(scale.y / scale.x - 1) < 1e-4 && Math.abs(scale.z / scale.x - 1) < 1e-4;
    if (!tangents || !even) { this.wrong(tangents ? mirrored : flat); return null; }
    this.metre = scale.x;
    const eye = new Vector3().setFromMatrixPosition(camera.matrixWorld).sub(position).applyQuaternion(rotation.clone().conjugate()).divideScalar(scale.x);
    const turned = new Quaternion(), ignored = new Vector3();
    camera.matrixWorld.decompose(new Vector3(), turned, ignored);
    turned.premultiply(rotation.conjugate()).normalize();
    const [width, height] = this.sizeFor(camera);
    return { eye: eye.toArray(), rotation: turned.toArray(), tangents, width, height };
  }

  sizeFor(camera) {
    if (camera.viewport && this.renderer.xr.isPresenting) return [camera.viewport.z, camera.viewport.w].map((n) => Math.max(1, Math.round(n)));
    const size = this.renderer.getRenderTarget() ?? this.renderer.getDrawingBufferSize(new Vector2());
    return [Math.max(1, Math.round(size.width)), Math.max(1, Math.round(size.height))];
  }

  // Makes three.js forget what it believes of GL. resetState() also forgets reversed depth, and what that clears depth to.
  giveBack(target, face, mip) {
    const { renderer } = this;
    const { depth } = renderer.state.buffers;
    const reversed = depth.getReversed();
    renderer.resetState();
    if (reversed) {
      depth.setReversed(true);
      depth.setClear(1);
    }
    if (target) renderer.setRenderTarget(target, face, mip);
  }

  takePictures() {
    this.client.pictures.forEach(({ color, depth }, i) => {
      this.textures[i] ??= [new ExternalTexture(color), new ExternalTexture(depth)];
      this.textures[i][0].sourceTexture = color;
      this.textures[i][1].sourceTexture = depth;
    });
  }

  // Sets the picture of this camera; another one (a mirror's, a probe's) sees nothing of Mirage.
  showTo(camera) {
    const { material } = this.children[0];
    const index = this.views.get(camera);
    const picture = this.client.pictures[index];
    const { u_color: color, u_depth: depth, u_own: own, u_reversed: reversed } = material.uniforms;
    material.colorWrite = material.depthWrite = picture !== undefined;
    material.uniformsNeedUpdate = true;
    [color.value, depth.value] = picture ? this.textures[index] : [null, null];
    if (!picture) return;
    own.value.set(picture.windowDepth[0], picture.windowDepth[1] * this.metre);
    reversed.value = this.renderer.state.buffers.depth.getReversed() ? 1 : 0;
  }

  wrong(text) {
    if (text !== this.toldWrong) {
      console.error(`Mirage: ${text}`);
      this.dispatchEvent({ type: 'error', text });
    }
    this.toldWrong = text;
  }

  /// Returns the point of the world that Mirage's picture shows at a place (0 to 1, right and down), as a Vector3; null: nothing. It
  /// waits for the graphics card: call it for a click, not for every frame.
  pointAt(x, y) {
    const { renderer } = this;
    const target = renderer.getRenderTarget(), face = renderer.getActiveCubeFace(), mip = renderer.getActiveMipmapLevel();
    const point = this.client.pointAt(0, x, y);
    this.giveBack(target, face, mip);
    return point ? new Vector3(...point).applyMatrix4(this.matrixWorld) : null;
  }

  /// Releases everything on the graphics card, and ends the connection.
  dispose() {
    this.renderer.domElement.removeEventListener('webglcontextlost', this.onLost);
    this.renderer.domElement.removeEventListener('webglcontextrestored', this.onRestored);
    this.client.dispose();
    const [mesh] = this.children;
    mesh.geometry.dispose();
    mesh.material.dispose();
    this.renderer.resetState();
  }
}
