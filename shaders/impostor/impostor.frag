// Draws a tile on its proxy. Every fragment finds the tile coordinate it shows and the depth stored
// there, and writes that depth, so impostors meet each other and geometry where the objects would.
//   METHOD_PROJECT  the capture ray through the proxy point (quad, cuboid, hull)
//   METHOD_WARP     one parallax step on the quad
//   METHOD_MARCH    ray marching through the stored depth, inside the bounding box (row 16)
precision highp float;
precision highp int;
precision highp sampler2DArray;
in vec3 v_point;
flat in vec3 v_eye;
flat in vec3 v_right;
flat in vec3 v_up;
flat in vec3 v_ahead;
flat in vec4 v_window;
flat in vec4 v_atlas;
flat in vec4 v_depth;
flat in vec4 v_capture;
flat in vec3 v_view_depth;
flat in vec3 v_box_min;
flat in vec3 v_box_max;
flat in float v_depth_slack;
flat in vec3 v_normal;
layout(location = 0) out vec4 o_color;

uniform sampler2DArray u_color;
uniform sampler2DArray u_depth;
uniform vec2 u_depth_window;  // window depth = x + y / view depth
// First the solid fragments, which write depth; then the soft ones over them, which do not: an edge
// must neither hide what is behind it nor blend with less than all of it.
uniform bool u_soft;

const float kSolid = 0.99;

const float kNothing = -1.0;

// Capture tangents and depth of a point relative to the centre.
vec3 capture_from_point(vec3 p) {
  float z = v_capture.x + dot(p, v_ahead);
  return vec3(dot(p, v_right) / z, dot(p, v_up) / z, z);
}
vec3 point_from_capture(vec2 t, float z) {
  return (v_right * t.x + v_up * t.y) * z + v_ahead * (z - v_capture.x);
}
vec2 texel_from_tangent(vec2 t) { return v_atlas.xy + (t - v_window.xy) * v_atlas.zw; }

bool in_window(vec2 t) {
  return t.x >= v_window.x && t.x <= v_window.z && t.y <= v_window.y && t.y >= v_window.w;
}

// Stored capture depth at a tangent, kNothing where the tile is empty.
float stored_depth(vec2 t) {
  if (!in_window(t)) return kNothing;
  float code = floor(texelFetch(u_depth, ivec3(texel_from_tangent(t), v_depth.z), 0).r * 255.0 + 0.5);
  if (code < 0.5) return kNothing;
  return v_depth.x * v_depth.y / (v_depth.y - (code - 1.0) / 254.0 * (v_depth.y - v_depth.x));
}
vec4 stored_color(vec2 t) {
  vec2 uv = texel_from_tangent(t) / vec2(textureSize(u_color, 0).xy);
  return texture(u_color, vec3(uv, v_depth.z));
}

void emit(vec4 color, vec3 p) {
  o_color = color * v_depth.w;
  bool soft = o_color.a < kSolid;
  if (soft != u_soft || o_color.a < 1.0 / 255.0) discard;
  // Towards the viewer by what quantising may have pushed it back: a shelf at a wall stays before it.
  float view_depth = (v_capture.w + dot(v_view_depth, p) - v_depth_slack) * (1.0 - v_capture.z);
  gl_FragDepth = clamp(u_depth_window.x + u_depth_window.y / max(view_depth, 1e-6), 0.0, 1.0);
}

#ifdef METHOD_MARCH
const int kMaxSteps = 64;
const float kMinSteps = 4.0;
const int kRefinements = 5;

float exit_parameter(vec3 direction) {
  vec3 towards = mix(v_box_min, v_box_max, step(0.0, direction));
  vec3 t = (towards - v_eye) / direction;
  return min(min(abs(direction.x) > 1e-9 ? t.x : 1e9, abs(direction.y) > 1e-9 ? t.y : 1e9),
             abs(direction.z) > 1e-9 ? t.z : 1e9);
}

// Marches from the box's front face to its back. A crossing whose depth agrees after refinement is
// the surface. Where the ray passes behind a silhouette it goes on; if it meets nothing, the surface
// it passed most closely is extended (hole filling, at most 0.3 of the depth range's half).
void main() {
  vec3 direction = v_point - v_eye;
  float t_end = exit_parameter(direction);
  // About a step a texel: none is jumped over, and near the capture ray few are needed.
  vec2 texels = (capture_from_point(v_eye + direction * t_end).xy - capture_from_point(v_point).xy) *
                v_atlas.zw;
  float steps = clamp(ceil(max(abs(texels.x), abs(texels.y))), kMinSteps, float(kMaxSteps));
  float step_size = (t_end - 1.0) / steps;
  float fill_limit = 0.15 * (v_depth.y - v_depth.x);
  float fill_gap = fill_limit;
  vec3 fill = vec3(0.0);
  bool was_in_front = true;
  float before = 1.0;
  for (int i = 1; i <= kMaxSteps; ++i) {
    if (float(i) > steps) break;
    float t = 1.0 + step_size * float(i);
    vec3 c = capture_from_point(v_eye + direction * t);
    float stored = stored_depth(c.xy);
    bool in_front = stored < 0.0 || c.z < stored;
    if (!in_front) {
      float low = before, high = t;
      vec3 at = c;
      float found = stored;
      if (was_in_front) {
        for (int k = 0; k < kRefinements; ++k) {
          float middle = 0.5 * (low + high);
          vec3 m = capture_from_point(v_eye + direction * middle);
          float s = stored_depth(m.xy);
          if (s < 0.0 || m.z < s) {
            low = middle;
          } else {
            high = middle;
            at = m;
            found = s;
          }
        }
      }
      float gap = at.z - found;
      float tolerance = 0.02 * (v_depth.y - v_depth.x) + abs(step_size) * 0.1;
      if (gap < tolerance) {
        emit(stored_color(at.xy), point_from_capture(at.xy, found));
        return;
      }
      if (gap < fill_gap) {
        fill_gap = gap;
        fill = vec3(at.xy, found);
      }
    }
    was_in_front = in_front;
    before = t;
  }
  if (fill_gap >= fill_limit) discard;
  emit(stored_color(fill.xy), point_from_capture(fill.xy, fill.z));
}
#else
void main() {
#ifndef PROXY_QUAD
  // A face turned away from the capture eye was not seen by it: what it would show is elsewhere.
  if (dot(v_normal, -v_ahead * v_capture.x - v_point) <= 0.0) discard;
#endif
  vec2 t = capture_from_point(v_point).xy;
#ifdef METHOD_WARP
  float guess = stored_depth(t);
  if (guess > 0.0) {
    vec3 direction = v_point - v_eye;
    float along = dot(direction, v_ahead);
    if (abs(along) > 1e-9) {
      float k = (guess - v_capture.x - dot(v_eye, v_ahead)) / along;
      t = capture_from_point(v_eye + direction * k).xy;
    }
  }
#endif
  if (!in_window(t)) discard;
  float z = stored_depth(t);
  emit(stored_color(t), point_from_capture(t, z > 0.0 ? z : v_capture.y));
}
#endif
