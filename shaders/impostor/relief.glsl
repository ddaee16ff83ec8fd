// Tracing a ray through a tile's depth, in tile space (relief.vert).
uniform sampler2DArray u_color;
uniform sampler2DArray u_depth;

const float kMaxCells = 1024.0;
const float kSolid = 0.99;
const float kWall = 6.0;   // largest code step between neighbours of one surface
const float kClear = 1.0;   // cells from an edge to texels that hold only one surface
const float kRounding = 1.0;
const float kFillReach = 0.15;  // share of the window by which a surface is extended (0.3 r)
const float kOneSided = 0.2;  // share of that: wider occluders are also filled from one side

struct Ray {
  vec3 from;  // tile space, first point inside the content's box
  vec3 span;  // to the last such point; both along the capture direction
  vec4 window;  // texels of the tile: least and greatest x, y
};

struct Hit {
  vec4 color;   // premultiplied, accumulated so far
  vec3 point;   // first surface met, tile space
#ifdef RELIT
  Stored surface;  // weighted like colour
#endif
};

// False: the ray through `point` misses the box.
bool clip_ray(vec3 point, vec3 direction, vec3 low, vec3 high, out Ray ray) {
  vec3 d = direction / max(max(abs(direction.x), abs(direction.y)), abs(direction.z));
  d = mix(d, vec3(1e-9), lessThan(abs(d), vec3(1e-9)));
  vec3 a = (low - point) / d, b = (high - point) / d;
  vec3 first = min(a, b), last = max(a, b);
  float enter = max(max(first.x, first.y), first.z);
  float leave = min(min(last.x, last.y), last.z);
  if (!(enter <= leave)) return false;
  ray.from = point + d * enter;
  ray.span = d * (leave - enter);
  ray.window = vec4(low.xy, high.xy);
  // A ray from behind meets the surface from its back, but is still traced in the order of capture.
  if (ray.span.z < 0.0) {
    ray.from += ray.span;
    ray.span = -ray.span;
  }
  return true;
}

// Depth code 0..254, -1: nothing there.
float code_at(ivec2 texel, int layer) {
  return floor(texelFetch(u_depth, ivec3(texel, layer), 0).r * 255.0 + 0.5) - 1.0;
}

vec4 color_at(vec2 at, int layer) {
  vec2 uv = at / vec2(textureSize(u_color, 0).xy);
  return textureLod(u_color, vec3(uv, float(layer)), 0.0);
}

// One Newton step from parameter s to where the ray meets the surface interpolated between texels.
// `codes`: those of the four texels around it, x before y.
float refined(Ray ray, float s, vec4 codes) {
  vec2 at = ray.from.xy + ray.span.xy * s - 0.5;
  vec2 f = at - floor(at);
  float c00 = codes.x, c10 = codes.y, c01 = codes.z, c11 = codes.w;
  float low = min(min(c00, c10), min(c01, c11)), high = max(max(c00, c10), max(c01, c11));
  if (low < 0.0 || high - low > 2.0 * kWall) return s;
  float dx0 = c10 - c00, dx1 = c11 - c01;
  float c0 = c00 + dx0 * f.x, c1 = c01 + dx1 * f.x;
  float c = mix(c0, c1, f.y);
  // The bound covers at most half a code between stored and interpolated depth.
  float nearest = f.y < 0.5 ? (f.x < 0.5 ? c00 : c10) : (f.x < 0.5 ? c01 : c11);
  c = clamp(c, nearest - 0.5, nearest + 0.5);
  float slope = ray.span.z - dot(vec2(mix(dx0, dx1, f.y), c1 - c0), ray.span.xy);
  float error = ray.from.z + ray.span.z * s - c;
  return slope > 0.25 * ray.span.z ? clamp(s - error / slope, 0.0, 1.0) : s;
}

float refine(Ray ray, float s, int layer) {
  ivec2 base = ivec2(floor(ray.from.xy + ray.span.xy * s - 0.5));
  return refined(ray, s, vec4(code_at(base, layer), code_at(base + ivec2(1, 0), layer),
                              code_at(base + ivec2(0, 1), layer), code_at(base + ivec2(1, 1), layer)));
}

// Texel of cell i of n along the ray.
ivec2 cell(Ray ray, float i, float n) {
  return ivec2(floor(ray.from.xy + ray.span.xy * ((i + 0.5) / n)));
}

float cell_code(Ray ray, float i, float n, int layer) { return code_at(cell(ray, i, n), layer); }

// True if the rise from `last` to `c`, in cells i - 1 and i, is a slope that continues before or
// behind it. False: it is an edge.
bool one_surface(Ray ray, float i, float n, int layer, float last, float c) {
  ivec2 from = cell(ray, i - 1.0, n), to = cell(ray, i, n);
  float before = code_at(2 * from - to, layer), next = code_at(2 * to - from, layer);
  return (before >= 0.0 && abs(before - 2.0 * last + c) <= kWall) ||
         (next >= 0.0 && abs(next - 2.0 * c + last) <= kWall);
}

// True if the content of cell `at` continues smoothly for twice `step` cells, perhaps before or
// beyond the ray: a surface visible for longer than it is hidden. Leaves do not continue like that.
bool goes_on(Ray ray, float at, float step, float n, int layer) {
  vec2 end = ray.from.xy + ray.span.xy * ((at + 2.0 * step + 0.5) / n);
  if (any(lessThan(end, ray.window.xy)) || any(greaterThanEqual(end, ray.window.zw))) return false;
  float a = cell_code(ray, at, n, layer), b = cell_code(ray, at + step, n, layer);
  float c = cell_code(ray, at + 2.0 * step, n, layer);
  return min(a, min(b, c)) >= 0.0 && abs(a - 2.0 * b + c) <= kWall;
}

// Parameter at which the ray meets the surface extended over a hidden stretch [from, to]: from the
// surface it left at `from` to the one behind which it came out at `to` (codes, -1: none). -1: the
// ray does not meet it.
float extended(Ray ray, float from, float entry, float to, float leave) {
  if (entry < 0.0 && leave < 0.0) return -1.0;
  float at = ((entry < 0.0 ? leave : entry) - ray.from.z) / ray.span.z;
  if (entry >= 0.0 && leave >= 0.0) {
    float a = ray.from.z + ray.span.z * from - entry, b = ray.from.z + ray.span.z * to - leave;
    at = b > 0.0 && a < 0.0 ? mix(from, to, a / (a - b)) : -1.0;
  }
  return at >= from && at <= to ? at : -1.0;
}

// Adds the tile's content at `at`, behind everything the ray met so far.
void blend(inout Hit hit, vec2 at, int layer, vec3 point) {
  vec4 color = color_at(at, layer);
  if (hit.color.a < 0.5) hit.point = point;
#ifdef RELIT
  Stored s = stored_surface(at, float(layer));
  float weight = (1.0 - hit.color.a) * color.a;
  hit.surface.normal += weight * s.normal;
  hit.surface.roughness += weight * s.roughness;
  hit.surface.rest += weight * s.rest;
#endif
  hit.color += (1.0 - hit.color.a) * color;
}

Hit nothing() {
  Hit hit;
  hit.color = vec4(0.0);
  hit.point = vec3(0.0);
#ifdef RELIT
  hit.surface = Stored(vec2(0.0), 0.0, vec3(0.0));
#endif
  return hit;
}

#ifdef LAYERED
#include "impostor/relief_layers.glsl"
#else
// Traces front to back through the cells that the ray crosses, one sample a cell. A ray that passes
// behind a surface continues, hidden. When it comes out behind another surface, or ends, the
// farther surfaces on either side of the hidden stretch are extended into it. Soft texels are
// blended and passed.
Hit trace(Ray ray, int layer, float reach) {
  Hit hit = nothing();
  float n = clamp(ceil(max(abs(ray.span.x), abs(ray.span.y))), 1.0, kMaxCells);
  float rise = ray.span.z / n;
  float i = 0.0, last = -1.0;
  while (i < n && hit.color.a < kSolid) {
    // The ray is in front of everything so far.
    float c = -1.0;
    float deep = ray.from.z + rise * i;
    while (i < n) {
      c = cell_code(ray, i, n, layer);
      if (c >= 0.0 && c <= deep + rise) break;
      last = c;
      i += 1.0;
      deep += rise;
    }
    if (i >= n) break;
    bool risen = last - c > kWall && one_surface(ray, i, n, layer, last, c);
    if (risen || c >= deep - (last >= 0.0 && last - c <= kWall ? kWall : kRounding)) {
      float met = risen ? (i - 0.5 + (last - deep + 0.5 * rise) / (last - c + rise)) / n
                        : (c - ray.from.z) / ray.span.z;
      float s = refine(ray, clamp(met, 0.0, 1.0), layer);
      blend(hit, ray.from.xy + ray.span.xy * s, layer, ray.from + ray.span * s);
      if (hit.color.a >= kSolid) break;
    }
    // The ray is hidden behind c.
    float entry = last > c + kWall ? last : -1.0;
    float start = i;
    float under = c;
    while (i < n) {
      i += 1.0;
      deep += rise;
      c = i < n ? cell_code(ray, i, n, layer) : -1.0;
      if (c < 0.0 || c >= deep - kRounding) break;  // out again
      if (c > under + 2.0 * kWall) break;       // out behind a farther surface
      under = c;
    }
    float at = extended(ray, start / n, entry, i / n, c);
    if (at >= 0.0) {
      bool from_entry = entry >= 0.0 && (c < 0.0 || at * n - start < i - at * n);
      float source = from_entry ? start - kClear : i + 1.0 + kClear;
      float hidden = max(i - start, 1.0);
      bool fills = entry >= 0.0 && c >= 0.0 || i - start > reach * kOneSided ||
                   (from_entry ? goes_on(ray, start - 1.0, -hidden, n, layer)
                               : goes_on(ray, i, hidden, n, layer));
      if (abs(at * n - source) <= reach && fills) {
        source = clamp(source / n, 0.0, 1.0);
        blend(hit, ray.from.xy + ray.span.xy * source, layer, ray.from + ray.span * at);
      }
    }
    last = -1.0;
  }
  return hit;
}
#endif
