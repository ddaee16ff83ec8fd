#include "protocol/impostor/lighting_state.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "protocol/base/limits.h"
#include "protocol/base/stable_math.h"

namespace mirage {
namespace {

// -0 becomes 0, so that both give one key.
float positive_zero(float v) { return v == 0.0f ? 0.0f : v; }

float quantise(double v, double step) {
  return positive_zero(static_cast<float>(std::round(v / step) * step));
}

glm::vec3 quantise(const glm::dvec3& v, double step) {
  return {quantise(v.x, step), quantise(v.y, step), quantise(v.z, step)};
}

using LightWords = std::array<float, 13>;

LightWords words(const ObjectLight& l) {
  return {static_cast<float>(l.kind),
          l.color.r,
          l.color.g,
          l.color.b,
          l.position.x,
          l.position.y,
          l.position.z,
          l.direction.x,
          l.direction.y,
          l.direction.z,
          l.range,
          l.cos_inner,
          l.cos_outer};
}

// Two quaternions give the same rotation. This picks the one with w >= 0; if w is 0, the sign of
// the next non-zero component decides.
glm::dquat canonical(const glm::dquat& q) {
  for (const double v : {q.w, q.x, q.y, q.z}) {
    if (v != 0) return v < 0 ? -q : q;
  }
  return {1, 0, 0, 0};
}

// Turns the probe into an object's space, by the object's `rotation`. A probe that adds nothing
// becomes empty.
ProbeLight to_object_space(const ProbeLight& probe, const glm::quat& rotation) {
  if (!probe.shines()) return {};
  const glm::dquat seen =
      canonical(glm::conjugate(glm::dquat(rotation)) * glm::dquat(probe.rotation));
  ProbeLight out = probe;
  const double step = 1.0 / 4096.0;
  const glm::dquat even =
      canonical({double{quantise(seen.w, step)}, double{quantise(seen.x, step)},
                 double{quantise(seen.y, step)}, double{quantise(seen.z, step)}});
  const double length =
      std::sqrt(even.w * even.w + even.x * even.x + even.y * even.y + even.z * even.z);
  const auto part = [&](double v) { return positive_zero(static_cast<float>(v / length)); };
  out.rotation = {part(even.w), part(even.x), part(even.y), part(even.z)};
  return out;
}

bool same_probe(const ProbeLight& a, const ProbeLight& b) {
  if (!a.shines() || !b.shines()) return a.shines() == b.shines();
  return a.id == b.id && a.strength == b.strength && a.rotation == b.rotation;
}

bool is_black(const Light& light) { return light.color == glm::vec3(0); }

ObjectLight to_object_space(const Light& light, const Similarity& m, double radius) {
  const glm::dquat inverse = glm::conjugate(glm::dquat(m.rotation));
  ObjectLight out;
  out.kind = light.kind;
  out.color = light.color;
  if (light.kind != LightKind::kPoint) {
    const glm::dvec3 direction = inverse * safe_normalize(glm::dvec3(light.direction));
    out.direction = quantise(direction, 1.0 / 4096.0);
  }
  if (light.kind != LightKind::kDirectional) {
    const double scale = m.scale;
    const glm::dvec3 position = inverse * (light.position - m.position) / scale;
    out.position = quantise(position, radius > 0 ? radius / 256.0 : 1e-6);
    // Light falls off with the squared world distance, and an object unit is `scale` metres.
    out.color = glm::vec3(glm::dvec3(light.color) / (scale * scale));
    out.range = static_cast<float>(light.range / scale);
  }
  if (light.kind == LightKind::kSpot) {
    out.cos_inner = light.cos_inner;
    out.cos_outer = light.cos_outer;
  }
  return out;
}

bool out_of_range(const ObjectLight& light, const glm::vec3& center, float radius) {
  if (light.kind == LightKind::kDirectional || light.range <= 0) return false;
  return glm::length(light.position - center) > light.range + radius;
}

// True if no point of the sphere lies inside the outer cone. From the light, the sphere covers the
// half angle asin(r / d) about its centre. The margin allows for rounding here and in the shader.
bool out_of_cone(const ObjectLight& light, const glm::vec3& center, float radius) {
  if (light.kind != LightKind::kSpot) return false;
  const glm::dvec3 to_center = glm::dvec3(center) - glm::dvec3(light.position);
  const double distance = glm::length(to_center);
  if (!(distance > 1.001 * double{radius})) return false;
  const double axis =
      angle_between(to_center / distance, safe_normalize(glm::dvec3(light.direction)));
  const double cone = std::acos(std::clamp(double{light.cos_outer}, -1.0, 1.0));
  return axis - std::asin(double{radius} / distance) > cone + 1e-3;
}

}  // namespace

std::vector<float> ObjectLighting::canonical() const {
  std::vector<float> bytes = {positive_zero(ambient.r), positive_zero(ambient.g),
                              positive_zero(ambient.b)};
  for (const ObjectLight& light : lights) {
    for (const float word : words(light)) bytes.push_back(positive_zero(word));
  }
  if (probe.shines()) {
    for (int i = 0; i < 64; i += 16) {  // a float holds 16 bits of the id exactly
      bytes.push_back(static_cast<float>((probe.id >> i) & 0xffffu));
    }
    const glm::quat& q = probe.rotation;
    for (const float v : {q.w, q.x, q.y, q.z, probe.strength}) bytes.push_back(positive_zero(v));
  }
  return bytes;
}

std::uint64_t ObjectLighting::hash() const {
  const std::vector<float> values = canonical();
  return XXH3_64bits(values.data(), values.size() * sizeof(float));
}

Result<Lighting> checked_lighting(Lighting lighting) {
  const auto bad_color = [](const glm::vec3& c) {
    for (int i = 0; i < 3; ++i) {
      if (!std::isfinite(c[i]) || c[i] < 0) return true;
    }
    return false;
  };
  if (bad_color(lighting.ambient)) {
    return make_error(ErrorId::kWireValue, "ambient light is negative or not finite");
  }
  if (lighting.lights.size() > limits::kMaxLights) {
    return make_error(ErrorId::kWireValue,
                      "lighting state has " + std::to_string(lighting.lights.size()) +
                          " lights, at most " + std::to_string(limits::kMaxLights));
  }
  for (std::size_t i = 0; i < lighting.lights.size(); ++i) {
    Light& light = lighting.lights[i];
    const std::string name = "light " + std::to_string(i);
    const bool finite = is_finite(light.position) && std::isfinite(light.range) &&
                        std::isfinite(light.cos_inner) && std::isfinite(light.cos_outer);
    if (bad_color(light.color) || !finite || light.range < 0) {
      return make_error(ErrorId::kWireValue, name + " has a negative or not finite value");
    }
    if (light.kind != LightKind::kPoint) {
      const glm::dvec3 direction = safe_normalize(glm::dvec3(light.direction));
      if (direction == glm::dvec3(0)) {
        return make_error(ErrorId::kWireValue, name + " has no direction");
      }
      light.direction = glm::vec3(direction);
    }
  }
  if (lighting.probe.id == 0) lighting.probe = {};
  glm::quat& turn = lighting.probe.rotation;
  const float length = glm::length(turn);
  const float strength = lighting.probe.strength;
  if (!(std::abs(length - 1.0f) < 1e-3f) || !std::isfinite(strength) || strength < 0) {
    return make_error(ErrorId::kWireValue, "light probe has no rotation or a negative strength");
  }
  if (turn != glm::quat(1, 0, 0, 0)) turn = turn / length;
  return lighting;
}

bool same_lighting(const Lighting& a, const Lighting& b) {
  const auto same = [](const Light& x, const Light& y) {
    return x.kind == y.kind && x.color == y.color && x.position == y.position &&
           x.direction == y.direction && x.range == y.range && x.cos_inner == y.cos_inner &&
           x.cos_outer == y.cos_outer;
  };
  return a.ambient == b.ambient && same_probe(a.probe, b.probe) &&
         std::equal(a.lights.begin(), a.lights.end(), b.lights.begin(), b.lights.end(), same);
}

std::vector<double> canonical_values(const Lighting& lighting) {
  std::vector<double> values;
  const auto put = [&](const auto& v) {
    for (int i = 0; i < 3; ++i) values.push_back(v[i] == 0 ? 0.0 : static_cast<double>(v[i]));
  };
  put(lighting.ambient);
  for (const Light& light : lighting.lights) {
    if (is_black(light)) continue;
    put(light.color);
    put(light.position);
    put(light.direction);
    put(glm::vec3(light.range, light.cos_inner, light.cos_outer));
    values.push_back(static_cast<double>(light.kind));
  }
  if (lighting.probe.shines()) {
    const ProbeLight& p = lighting.probe;
    for (const std::uint32_t half :
         {static_cast<std::uint32_t>(p.id), static_cast<std::uint32_t>(p.id >> 32)}) {
      values.push_back(static_cast<double>(half));
    }
    const glm::dquat q = canonical(glm::dquat(p.rotation));
    for (const double v : {q.w, q.x, q.y, q.z, double{p.strength}}) values.push_back(v + 0.0);
  }
  return values;
}

std::uint64_t lighting_hash(const Lighting& lighting) {
  const std::vector<double> values = canonical_values(lighting);
  return XXH3_64bits(values.data(), values.size() * sizeof(double));
}

ObjectLighting whole_object_lighting(const Lighting& lighting, const Similarity& world_from_object,
                                     float radius) {
  ObjectLighting out;
  out.ambient = lighting.ambient;
  out.probe = to_object_space(lighting.probe, world_from_object.rotation);
  for (const Light& light : lighting.lights) {
    const ObjectLight object_light = to_object_space(light, world_from_object, radius);
    // A tiny scale can move a light beyond the range of float. Such a light is dropped.
    const LightWords w = words(object_light);
    const bool finite = std::all_of(w.begin(), w.end(), [](float v) { return std::isfinite(v); });
    if (finite) out.lights.push_back(object_light);
  }
  std::sort(out.lights.begin(), out.lights.end(),
            [](const ObjectLight& a, const ObjectLight& b) { return words(a) < words(b); });
  return out;
}

ObjectLighting object_lighting(const Lighting& lighting, const Similarity& world_from_object,
                               const glm::vec3& center, float radius) {
  ObjectLighting out = whole_object_lighting(lighting, world_from_object, radius);
  const auto adds_nothing = [&](const ObjectLight& light) {
    return light.color == glm::vec3(0) || out_of_range(light, center, radius) ||
           out_of_cone(light, center, radius);
  };
  out.lights.erase(std::remove_if(out.lights.begin(), out.lights.end(), adds_nothing),
                   out.lights.end());
  return out;
}

}  // namespace mirage
