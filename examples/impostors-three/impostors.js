// Draws a bake of mirage-bake (target generic) as impostors in three.js: each pixel follows its ray through the depth of the
// three frames around the view, so it shows parallax, hides and is hidden right, and takes the light of the scene.
//   const bake = await loadBake('baked/tree.json');
//   const trees = new Impostors(bake, 10000);  trees.setMatrixAt(i, matrix);  scene.add(trees);
import * as THREE from 'three';

/** Loads NAME.json and the pictures it names. Throws if a picture is missing or has another size than it says. */
export async function loadBake(url) {
  const at = new URL(url, location.href);
  const answer = await fetch(at);
  if (!answer.ok) throw new Error(`${at}: ${answer.status}`);
  const bake = await answer.json();
  if (bake.format !== 'mirage-bake 1' || bake.target !== 'generic') throw new Error(`${at} is no bake for the target generic`);
  if (bake.layout === 'ring') throw new Error(`${at} is a ring, which this shader does not draw`);
  const loader = new THREE.TextureLoader();
  bake.textures = {};
  for (const name of ['color', 'normal']) {
    const map = bake.maps.find((one) => one.map === name);
    if (!map) throw new Error(`${at} has no map ${name}`);
    const texture = await loader.loadAsync(new URL(map.file, at).href);
    if (texture.image.width !== bake.size_px) throw new Error(`${map.file} is ${texture.image.width} px wide, not ${bake.size_px}`);
    texture.flipY = false;
    texture.premultiplyAlpha = false;  // the file's colours are already
    texture.colorSpace = name === 'color' ? THREE.SRGBColorSpace : THREE.NoColorSpace;
    texture.generateMipmaps = true;
    texture.minFilter = THREE.LinearMipmapLinearFilter;
    texture.anisotropy = 1;
    bake.textures[name] = texture;
  }
  return bake;
}

const vertexShader = /* glsl */ `
uniform vec3 u_center;
uniform float u_radius;
uniform float u_grid;
uniform bool u_whole;            // the lattice covers the whole sphere
uniform vec3 u_eye;              // world
varying vec3 v_along;            // from the eye to the pixel, in radii of the object
flat varying vec3 v_from;        // the eye, in radii about the centre
flat varying vec2 v_frame[3];
flat varying vec3 v_weight;
flat varying mat4 v_world;       // from radii about the centre

vec2 folded(vec2 p) { return vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0) * (1.0 - abs(p.yx)); }

vec2 place_of(vec3 d) {          // in the lattice, 0 to grid - 1
  if (!u_whole) d.y = max(d.y, 0.0);
  vec2 p = d.xz / max(abs(d.x) + abs(d.y) + abs(d.z), 1e-9);
  p = u_whole ? (d.y < 0.0 ? folded(p) : p) : vec2(p.y + p.x, p.y - p.x);
  return clamp(p * 0.5 + 0.5, 0.0, 1.0) * (u_grid - 1.0);
}

void main() {
  mat4 world = modelMatrix;
#ifdef USE_INSTANCING
  world = world * instanceMatrix;
#endif
  v_world = world * mat4(u_radius, 0.0, 0.0, 0.0, 0.0, u_radius, 0.0, 0.0, 0.0, 0.0, u_radius, 0.0, u_center, 1.0);
  v_from = (inverse(v_world) * vec4(u_eye, 1.0)).xyz;
  float away = max(length(v_from), 1.001);
  vec3 d = v_from / away;
  vec2 at = place_of(d), base = min(floor(at), vec2(u_grid - 2.0)), f = at - base;
  v_frame[0] = base;
  v_frame[1] = base + (f.x > f.y ? vec2(1.0, 0.0) : vec2(0.0, 1.0));
  v_frame[2] = base + 1.0;
  v_weight = vec3(min(1.0 - f.x, 1.0 - f.y), abs(f.x - f.y), min(f.x, f.y));
  // A square before the eye that covers the sphere's outline.
  vec3 right = normalize(abs(d.y) > 0.999 ? vec3(1.0, 0.0, 0.0) : cross(vec3(0.0, 1.0, 0.0), d)), up = cross(d, right);
  vec3 corner = (right * position.x + up * position.y) * away / sqrt(max(away * away - 1.0, 1e-4));
  v_along = corner - v_from;
  gl_Position = projectionMatrix * viewMatrix * v_world * vec4(corner, 1.0);
}`;

const fragmentShader = /* glsl */ `
precision highp float;
uniform sampler2D u_color;       // premultiplied
uniform sampler2D u_normal;      // alpha: .5 + height / 2, in radii
uniform float u_grid, u_tile;
uniform bool u_whole;
uniform int u_steps;
uniform vec3 u_ambient, u_sun, u_sun_color;   // sun: direction to it
uniform mat4 projectionMatrix;
varying vec3 v_along;
flat varying vec3 v_from;
flat varying vec2 v_frame[3];
flat varying vec3 v_weight;
flat varying mat4 v_world;

// As mirage-bake measures it: numerics.md section 7.
const float kCovers = 0.35;      // where a texel covers less, a ray passes
const float kSheer = 0.07;       // neighbouring heights that differ by more belong to two surfaces
const float kCliff = 0.03, kThick = 0.15, kHidden = 0.02, kEmpty = 0.3, kUnseen = 0.03;

vec2 folded(vec2 p) { return vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0) * (1.0 - abs(p.yx)); }

mat3 axes_of(vec2 frame) {       // right, up, toward
  vec2 g = frame / (u_grid - 1.0), p = 2.0 * g - 1.0;
  vec3 d = vec3(g.x - g.y, 0.0, g.x + g.y - 1.0);
  if (u_whole) d = vec3(p.x, 0.0, p.y);
  d.y = 1.0 - abs(d.x) - abs(d.z);
  if (u_whole && d.y < 0.0) d.xz = folded(p);
  d = normalize(d);
  vec3 right = normalize(cross(abs(d.y) > 1.0 - 1e-6 ? vec3(0.0, 0.0, -1.0) : vec3(0.0, 1.0, 0.0), d));
  return mat3(right, cross(d, right), d);
}

// One frame of the lattice, and the ray in its axes.
vec2 frame_uv;
vec3 o, d;
float level, t_hit;

vec2 uv_of(vec3 p) { return (frame_uv + clamp(vec2(p.x, -p.y) * 0.5 + 0.5, 0.5 / u_tile, 1.0 - 0.5 / u_tile)) / u_grid; }

void look_from(vec2 frame, vec3 along) {
  mat3 axes = axes_of(frame);
  frame_uv = frame;
  o = v_from * axes;
  d = along * axes;
}

float below(float t, out float cover) {   // how far the ray is below the surface there
  vec3 p = o + t * d;
  vec2 uv = uv_of(p);
  cover = textureLod(u_color, uv, level).a;
  return 2.0 * textureLod(u_normal, uv, level).a - 1.0 - p.z;
}
// As below(), where a ray has met something. Between two surfaces the filter puts a wall; there the nearest texel's height counts.
float below_unwalled(float t, out float cover) {
  float depth = below(t, cover);
  vec2 texels = vec2(textureSize(u_normal, int(level))), at = uv_of(o + t * d) * texels;
  float nearest = 2.0 * texelFetch(u_normal, ivec2(at), int(level)).a - 1.0 - (o.z + t * d.z);
  return abs(nearest - depth) > 0.5 * kSheer ? nearest : depth;
}
bool inside(float t) {
  float cover, depth = below(t, cover);
  return depth >= 0.0 && cover >= kCovers;
}

// Returns where the ray meets the frame's surface; trust 0: nowhere. A ray that only passes behind an edge may take the edge.
float trace(out float trust) {
  float b = dot(o, d), room = b * b - dot(o, o) + 1.0;
  trust = 0.0;
  if (room <= 0.0) return 0.0;
  float across = length(d.xy) * sqrt(room) * u_tile / exp2(level);   // texels
  int steps = clamp(int(ceil(across)), 6, u_steps);
  float begin = -b - sqrt(room), stride = 2.0 * sqrt(room) / float(steps), edge = 0.0;
  bool was = false;
  for (int i = 1; i <= steps; ++i) {
    float t = begin + stride * float(i);
    bool now = inside(t);
    if (now && !was) {
      float out_t = t - stride, in_t = t, cover;
      for (int k = 0; k < 6; ++k) {
        float middle = 0.5 * (out_t + in_t);
        if (inside(middle)) in_t = middle; else out_t = middle;
      }
      float depth = below_unwalled(in_t, cover);
      if (abs(depth) <= kCliff) { trust = 1.0; return in_t; }
      if (trust == 0.0 && depth > 0.0 && depth <= kThick) { edge = in_t; trust = kHidden; }
      now = depth > 0.0;
    }
    was = now;
  }
  return edge;
}

void main() {
  vec3 along = normalize(v_along);
  // texels of a frame for each pixel
  level = clamp(log2(0.5 * u_tile * length(fwidth(v_along)) / 1.4), 0.0, max(log2(u_tile / 8.0), 0.0));
  vec4 color = vec4(0.0);
  vec3 normal = vec3(0.0);
  float all = 0.0, met = 0.0, shown = 0.0, nearest = 1e9, cover;
  float ts[3], trusts[3];
  for (int i = 0; i < 3; ++i) {
    look_from(v_frame[i], along);
    ts[i] = trace(trusts[i]);
    if (trusts[i] == 1.0) nearest = min(nearest, ts[i]);
  }
  for (int i = 0; i < 3; ++i) {
    look_from(v_frame[i], along);
    float t = ts[i], trust = trusts[i];
    float w = v_weight[i] * (trust > 0.0 ? trust : kEmpty);
    // Another frame sees a surface that this one cannot see, and this one says what is behind it.
    bool behind = trust < 1.0 || t > nearest + kCliff;
    if (behind && nearest < 1e9 && below_unwalled(nearest, cover) > kCliff && cover >= kCovers) w *= kUnseen;
    all += w;
    if (trust == 0.0) continue;
    vec2 uv = uv_of(o + t * d);
    vec4 c = textureLod(u_color, uv, level);
    color += w * c;
    normal += w * c.a * (2.0 * textureLod(u_normal, uv, level).rgb - 1.0);
    if (w > met) { met = w; shown = t; }
  }
  if (!(color.a > 0.0)) discard;
  color /= all;
#ifdef CUT
  if (color.a < 0.5) discard;
  color /= color.a;
#endif
  vec3 n = normalize(mat3(v_world) * normal + 1e-9);
  vec3 light = u_ambient + u_sun_color * max(dot(n, u_sun), 0.0);
  gl_FragColor = vec4(color.rgb * light, color.a);
  vec4 clip = projectionMatrix * viewMatrix * v_world * vec4(v_from + shown * along, 1.0);
  gl_FragDepth = clamp(0.5 + 0.5 * clip.z / clip.w, 0.0, 1.0);
  #include <colorspace_fragment>
}`;

/**
 * Many instances of one bake. Matrices may turn, move and scale evenly. `cut`: hard edges, which need no order (default).
 * `steps`: the most that a ray takes through a frame; it takes one for each texel it passes over.
 */
export class Impostors extends THREE.InstancedMesh {
  constructor(bake, count, { steps = 64, cut = true } = {}) {
    const material = new THREE.ShaderMaterial({
      vertexShader, fragmentShader,
      defines: cut ? { CUT: '' } : {},
      uniforms: {
        u_color: { value: bake.textures.color }, u_normal: { value: bake.textures.normal },
        u_center: { value: new THREE.Vector3(...bake.center) }, u_radius: { value: bake.radius },
        u_grid: { value: bake.grid }, u_tile: { value: bake.tile_px }, u_whole: { value: bake.layout === 'octahedral' },
        u_steps: { value: steps }, u_eye: { value: new THREE.Vector3() },
        u_ambient: { value: new THREE.Color(1, 1, 1) }, u_sun: { value: new THREE.Vector3(0, 1, 0) }, u_sun_color: { value: new THREE.Color(0, 0, 0) },
      },
      transparent: !cut, premultipliedAlpha: true,
    });
    super(new THREE.PlaneGeometry(2, 2), material, count);
    this.frustumCulled = false;  // instances are everywhere
    this.onBeforeRender = (renderer, scene, camera) => {
      material.uniforms.u_eye.value.setFromMatrixPosition(camera.matrixWorld);
      material.uniformsNeedUpdate = true;
    };
  }

  /** Sets the light: radiance of a white surface in the shade, and of one that faces the sun, besides. */
  setLight(ambient, sunDirection, sun) {
    const u = this.material.uniforms;
    u.u_ambient.value.copy(ambient);
    u.u_sun.value.copy(sunDirection).normalize();
    u.u_sun_color.value.copy(sun);
  }
}
