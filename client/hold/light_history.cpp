#include "client/hold/light_history.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "client/scene/scene_view.h"
#include "protocol/base/limits.h"
#include "protocol/impostor/lighting_state.h"
#include "protocol/impostor/object_proxy.h"
#include "protocol/model/need_mask.h"

namespace mirage {
namespace {

using Cardinal = std::array<glm::vec3, 6>;

// Returns the light that arrives at the centre, and sets the direction towards it, as lighting.glsl
// does. The surface is about a radius from the centre, so a lamp inside the object counts as that
// far away.
glm::vec3 arriving(const ObjectLight& light, const glm::vec3& center, float radius,
                   glm::vec3& to_light) {
  if (light.kind == LightKind::kDirectional) {
    to_light = -light.direction;
    return light.color;
  }
  const glm::vec3 d = light.position - center;
  const float distance = std::max(glm::length(d), 1e-6f);
  const float away = std::max(distance, radius);
  to_light = d / distance;
  const float x = light.range > 0 ? away / light.range : 0.0f;
  glm::vec3 color = light.color * std::max(1.0f - x * x * x * x, 0.0f) / (away * away);
  if (light.kind == LightKind::kSpot) {
    const float cosine = glm::dot(-to_light, light.direction);
    const float width = std::max(light.cos_inner - light.cos_outer, 1e-4f);
    const float spot = std::clamp((cosine - light.cos_outer) / width, 0.0f, 1.0f);
    color *= spot * spot;
  }
  return color;
}

Cardinal cardinal_light(const Lighting& lighting, const InstanceView& instance,
                        const ObjectDescription& object) {
  const ObjectLighting seen =
      object_lighting(lighting, instance.world_from_object, object.center, object.radius);
  Cardinal out;
  out.fill(seen.ambient);
  for (const ObjectLight& light : seen.lights) {
    glm::vec3 to_light;
    const glm::vec3 color = arriving(light, object.center, object.radius, to_light);
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<std::size_t>(2 * axis) + (to_light[axis] < 0 ? 1 : 0);
      out[at] += color * std::abs(to_light[axis]);
    }
  }
  return out;
}

}  // namespace

void LightHistory::reset(const SceneView& scene, const Lighting& lighting) {
  objects_.clear();
  instances_.clear();
  grow(scene);
  State first;
  first.serial = next_serial_++;
  first.turn = ++turn_;
  first.lighting = lighting;
  states_ = {std::move(first)};
}

void LightHistory::grow(const SceneView& scene) {
  for (std::size_t i = objects_.size(); i < scene.objects.size(); ++i) {
    const ObjectDescription& o = scene.objects[i];
    objects_.push_back(
        {o.center, o.radius, (o.needs & kNeedLighting) != 0, mirage::can_relight(o.needs)});
  }
  for (std::size_t i = instances_.size(); i < scene.instances.size(); ++i) {
    instances_.push_back({scene.instances[i].object, scene.instances[i].world_from_object});
  }
}

void LightHistory::set(const Lighting& lighting, std::int64_t now_us) {
  if (states_.empty() || same_lighting(current().lighting, lighting)) return;
  states_.back().ended_us = now_us;
  const auto known = std::find_if(states_.begin(), states_.end(), [&](const State& state) {
    return same_lighting(state.lighting, lighting);
  });
  if (known != states_.end()) {
    std::rotate(known, known + 1, states_.end());
  } else {
    if (states_.size() >= limits::kMaxLightingStatesPerClient) states_.erase(states_.begin());
    states_.emplace_back();
    states_.back().serial = next_serial_++;
    states_.back().lighting = lighting;
  }
  states_.back().turn = ++turn_;
}

const LightHistory::State* LightHistory::find(std::uint32_t serial) const {
  for (const State& state : states_) {
    if (state.serial == serial) return &state;
  }
  return nullptr;
}

std::uint64_t LightHistory::key(std::uint32_t instance, const State& state) const {
  std::vector<std::uint64_t>& keys =
      states_[static_cast<std::size_t>(&state - states_.data())].keys;
  keys.resize(instances_.size());
  std::uint64_t& key = keys[instance];
  if (key != 0) return key;
  const Placed& placed = instances_[instance];
  const Object& object = objects_[placed.object];
  key = placed.object + 1ull;
  if (object.lit) {
    key ^= object_lighting(state.lighting, placed.world_from_object, object.center, object.radius)
               .hash() *
           0x9e3779b97f4a7c15ull;
  }
  key = std::max<std::uint64_t>(key, 1);
  return key;
}

namespace {

// Returns the most that a change of the probe can change. A white surface at strength 1 counts as
// 1. It adds the difference in strength and the angle that the probe turned by (0 to 1).
float probe_change(const ProbeLight& a, const ProbeLight& b) {
  const float before = a.shines() ? a.strength : 0, after = b.shines() ? b.strength : 0;
  if (before == 0 || after == 0) return std::max(before, after);
  if (a.id != b.id) return before + after;
  const float sine2 = 1 - std::min(std::abs(glm::dot(a.rotation, b.rotation)), 1.0f);
  const float turned = std::min(2 * std::sqrt(2 * sine2), 1.0f);  // the angle, for small ones
  return std::abs(before - after) + turned * std::min(before, after);
}

}  // namespace

double light_error_px(const Lighting& then, const Lighting& now, const InstanceView& instance,
                      const ObjectDescription& object, double radius_px) {
  const Cardinal a = cardinal_light(then, instance, object);
  const Cardinal b = cardinal_light(now, instance, object);
  float worst = probe_change(then.probe, now.probe);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      worst = std::max(worst, std::abs(std::min(a[i][c], 1.0f) - std::min(b[i][c], 1.0f)));
    }
  }
  return worst > 0 ? static_cast<double>(worst) * radius_px : 0.0;
}

}  // namespace mirage
