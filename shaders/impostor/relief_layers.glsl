// Traces a ray through both layers of a tile; relief.glsl has the one-layer functions. A ray behind
// the front becomes visible again where it meets the layer behind. A texel without that layer has
// nothing behind its front. Hidden is only the space behind both.
flat in vec3 v_front;   // offset from the tile's place to its front: texels; atlas layer
flat in vec3 v_behind;  // the same for the layer behind

// Codes of either layer, -1: none.
float front_at(ivec2 texel) { return code_at(texel + ivec2(v_front.xy), int(v_front.z)); }
float behind_at(ivec2 texel) { return code_at(texel + ivec2(v_behind.xy), int(v_behind.z)); }
vec2 codes_at(ivec2 texel) { return vec2(front_at(texel), behind_at(texel)); }

// The nearer of a texel's codes that is not in front of `deep`; -1: none.
float ahead(vec2 codes, float deep) { return codes.x >= deep ? codes.x : codes.y >= deep ? codes.y : -1.0; }

// The code nearest to `c`.
float like(vec2 codes, float c) {
  return codes.y >= 0.0 && abs(codes.y - c) < abs(codes.x - c) ? codes.y : codes.x;
}
float like_at(ivec2 texel, float c) { return like(codes_at(texel), c); }

// Versions of one_surface() and refine() that follow, in each texel, the layer nearest to the
// surface.
bool layers_rise(Ray ray, float i, float n, float last, float c) {
  ivec2 from = cell(ray, i - 1.0, n), to = cell(ray, i, n);
  float before = like_at(2 * from - to, 2.0 * last - c);
  float next = like_at(2 * to - from, 2.0 * c - last);
  return (before >= 0.0 && abs(before - 2.0 * last + c) <= kWall) ||
         (next >= 0.0 && abs(next - 2.0 * c + last) <= kWall);
}

float refine_layers(Ray ray, float s, float c) {
  ivec2 base = ivec2(floor(ray.from.xy + ray.span.xy * s - 0.5));
  return refined(ray, s, vec4(like_at(base, c), like_at(base + ivec2(1, 0), c),
                              like_at(base + ivec2(0, 1), c),
                              like_at(base + ivec2(1, 1), c)));
}

void blend_layer(inout Hit hit, Ray ray, float at, float s, bool behind) {
  vec3 place = behind ? v_behind : v_front;
  blend(hit, ray.from.xy + ray.span.xy * at + place.xy, int(place.z), ray.from + ray.span * s);
}

// Blends the surface that the ray meets in cell i: code `c`, of the layer behind or of the front.
// `last`: among the surfaces that the ray was in front of in the cell before, the one nearest to c.
void meet(inout Hit hit, Ray ray, float i, float n, float c, float last, bool behind) {
  float rise = ray.span.z / n, deep = ray.from.z + rise * i;
  bool risen = !behind && last - c > kWall && layers_rise(ray, i, n, last, c);
  float depth = last >= 0.0 && last - c <= kWall ? kWall : kRounding;
  if (!risen && c < deep - depth) return;
  float met = risen ? (i - 0.5 + (last - deep + 0.5 * rise) / (last - c + rise)) / n
                    : (c - ray.from.z) / ray.span.z;
  float s = refine_layers(ray, clamp(met, 0.0, 1.0), c);
  blend_layer(hit, ray, s, s, behind);
}

// Fills the hidden cells [start, i) like trace() in relief.glsl. `behind`: true where `entry`,
// `leave` are of the layer behind.
void fill(inout Hit hit, Ray ray, float start, float i, float n, int layer, float entry, float leave,
          bvec2 behind, float reach) {
  float at = extended(ray, start / n, entry, i / n, leave);
  if (at < 0.0) return;
  bool from_entry = entry >= 0.0 && (leave < 0.0 || at * n - start < i - at * n);
  float source = from_entry ? start - kClear : i + 1.0 + kClear;
  float hidden = max(i - start, 1.0);
  bool fills = entry >= 0.0 && leave >= 0.0 || i - start > reach * kOneSided ||
               (from_entry ? goes_on(ray, start - 1.0, -hidden, n, layer)
                           : goes_on(ray, i, hidden, n, layer));
  if (abs(at * n - source) > reach || !fills) return;
  blend_layer(hit, ray, clamp(source / n, 0.0, 1.0), at, from_entry ? behind.x : behind.y);
}

Hit trace(Ray ray, int layer, float reach) {
  Hit hit = nothing();
  float n = clamp(ceil(max(abs(ray.span.x), abs(ray.span.y))), 1.0, kMaxCells);
  float rise = ray.span.z / n;
  bool hidden = false;
  float start = 0.0, entry = -1.0, under = 0.0;
  bvec2 behind = bvec2(false);  // entry, leave are of the layer behind
  for (float i = 0.0; i <= n && hit.color.a < kSolid; i += 1.0) {
    float deep = ray.from.z + rise * i;
    vec2 codes = vec2(-1.0);
    if (i < n) codes.x = front_at(cell(ray, i, n));
    bool in_front = codes.x < 0.0 || codes.x > deep + rise;
    if (in_front && !hidden) continue;
    if (i < n) codes.y = behind_at(cell(ray, i, n));
    vec2 before = vec2(-1.0);
    if (!hidden && i > 0.0) before = codes_at(cell(ray, i - 1.0, n));
    float deepest = max(codes.x, codes.y);
    bool unknown = codes.y >= 0.0 && codes.y <= deep + rise;
    for (int k = 0; k < 2 && !in_front && hit.color.a < kSolid; ++k) {
      float c = codes[k];
      if (c < 0.0 || c > deep + rise) break;
      if (hidden && c < deep - kRounding) continue;
      vec2 passed = mix(vec2(-1.0), before, greaterThan(before, vec2(deep)));
      float last = passed.x < 0.0 ? passed.y : like(passed, c);
      meet(hit, ray, i, n, c, last, k == 1);
    }
    if (hit.color.a >= kSolid) break;
    if (!hidden) {
      if (!unknown) continue;
      float last = ahead(before, deep);
      entry = last > deepest + kWall ? last : -1.0;
      behind.x = entry >= 0.0 && entry != before.x;
    } else {
      if (unknown && deepest < deep - kRounding && deepest <= under + 2.0 * kWall) {
        under = deepest;
        continue;
      }
      float leave = ahead(codes, deep - kRounding);
      if (leave < 0.0 && unknown) leave = deepest;
      behind.y = leave >= 0.0 && leave != codes.x;
      fill(hit, ray, start, i, n, layer, entry, leave, behind, reach);
      hidden = false;
      if (!unknown || deepest >= deep - kRounding) continue;
      entry = -1.0;
    }
    hidden = true;
    start = i;
    under = deepest;
  }
  return hit;
}
