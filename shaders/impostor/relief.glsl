// Tracing a ray through a tile's depth, in tile space (relief.vert).
uniform sampler2DArray u_color;
uniform sampler2DArray u_depth;

const int kMaxCells = 1024;
const float kSolid = 0.99;
const float kWall = 6.0;   // codes between neighbours that still are one surface
const float kFillReach = 0.15;  // of the window: how far a surface is extended (0.3 r)

struct Ray {
  vec3 from;  // tile space, first point inside the content's box
  vec3 span;  // to the last one; both along the capture direction
};

struct Hit {
  vec4 color;   // premultiplied, as far as the ray got
  vec3 point;   // of the first thing met, tile space
  bool filled;  // that thing is an extended surface
};

// False where the ray through `point` misses the box.
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
  // From behind, the surface is met from its back: taken in the order of capture all the same.
  if (ray.span.z < 0.0) {
    ray.from += ray.span;
    ray.span = -ray.span;
  }
  return true;
}

// Depth code 0..254, -1 where nothing is.
float code_at(ivec2 texel, int layer) {
  return floor(texelFetch(u_depth, ivec3(texel, layer), 0).r * 255.0 + 0.5) - 1.0;
}

vec4 color_at(vec2 at, int layer) {
  vec2 uv = at / vec2(textureSize(u_color, 0).xy);
  return textureLod(u_color, vec3(uv, float(layer)), 0.0);
}

// Where the ray meets the surface interpolated between texels: one Newton step from parameter s.
float refine(Ray ray, float s, int layer) {
  vec2 at = ray.from.xy + ray.span.xy * s - 0.5;
  ivec2 base = ivec2(floor(at));
  vec2 f = at - vec2(base);
  float c00 = code_at(base, layer), c10 = code_at(base + ivec2(1, 0), layer);
  float c01 = code_at(base + ivec2(0, 1), layer), c11 = code_at(base + ivec2(1, 1), layer);
  float low = min(min(c00, c10), min(c01, c11)), high = max(max(c00, c10), max(c01, c11));
  if (low < 0.0 || high - low > 2.0 * kWall) return s;
  float dx0 = c10 - c00, dx1 = c11 - c01;
  float c0 = c00 + dx0 * f.x, c1 = c01 + dx1 * f.x;
  float c = mix(c0, c1, f.y);
  float slope = ray.span.z - dot(vec2(mix(dx0, dx1, f.y), c1 - c0), ray.span.xy);
  float error = ray.from.z + ray.span.z * s - c;
  return slope > 0.25 * ray.span.z ? clamp(s - error / slope, 0.0, 1.0) : s;
}

// Front to back through the cells the ray crosses, one sample a cell. Where it passes behind a
// surface it goes on, hidden; when it comes out behind or ends, the farther surfaces on either side
// of the hidden stretch are extended into it (disocclusion). Soft texels are blended and passed.
Hit trace(Ray ray, int layer, float reach) {
  Hit hit = Hit(vec4(0.0), vec3(0.0), true);
  float cells = min(ceil(max(abs(ray.span.x), abs(ray.span.y))), float(kMaxCells));
  float n = max(cells, 1.0);
  float rise = ray.span.z / n, per_cell = 1.0 / n;
  bool hidden = false;
  float entry = -1.0, entry_at = 0.0;  // surface left behind when the ray went under, -1: none
  float last = -1.0;                   // code of the cell before
  for (int i = 0; i <= kMaxCells; ++i) {
    if (float(i) > n || hit.color.a >= kSolid) break;
    float s = float(i) * per_cell;
    float d0 = ray.from.z + rise * float(i), d1 = d0 + rise;
    bool over = float(i) >= n;
    float c = over ? -1.0 : code_at(ivec2(floor(ray.from.xy + ray.span.xy * (s + 0.5 * per_cell))), layer);
    bool behind = c >= 0.0 && c < d0 - kWall;
    bool met = c >= 0.0 && !behind && c <= d1;
    float at = -1.0, from_at = 0.0;
    bool real = false;
    bool deeper = behind && hidden && c > last + 2.0 * kWall;
    if (hidden && (!behind || deeper)) {
      // Out again: the hidden stretch runs from entry_at to s.
      float a = entry_at * ray.span.z + ray.from.z - entry;  // < 0 in front of the entry surface
      float b = d0 - c;
      if (entry >= 0.0 && c >= 0.0) {
        if (b > 0.0 && a < 0.0) at = mix(entry_at, s, a / (a - b));
      } else if (entry >= 0.0) {
        at = (entry - ray.from.z) / ray.span.z;
        if (at < entry_at || at > s) at = -1.0;
      } else if (c >= 0.0) {
        at = (c - ray.from.z) / ray.span.z;
        if (at < entry_at || at > s) at = -1.0;
      }
      if (at >= 0.0) {
        bool from_entry = entry >= 0.0 && (c < 0.0 || at - entry_at < s - at);
        from_at = from_entry ? entry_at - 0.5 * per_cell : s + 0.5 * per_cell;
        if (abs(at - from_at) * n > reach) at = -1.0;
      }
    }
    if (at < 0.0 && met) {
      at = clamp((c - ray.from.z) / ray.span.z, 0.0, 1.0);
      real = true;
    }
    if (at >= 0.0) {
      if (real) at = refine(ray, at, layer);
      vec2 place = ray.from.xy + ray.span.xy * (real ? at : from_at);
      vec4 color = color_at(place, layer);
      if (hit.color.a < 0.5) {
        hit.point = ray.from + ray.span * at;
        hit.filled = !real;
      }
      hit.color += (1.0 - hit.color.a) * color;
    }
    bool under = behind || real;
    if (under && !hidden) {
      entry = last > c + kWall ? last : -1.0;
      entry_at = s;
    } else if (deeper) {
      entry = -1.0;
      entry_at = s;
    }
    hidden = under;
    last = c;
  }
  return hit;
}
