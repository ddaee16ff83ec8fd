#pragma once
// The lightings a session has had: which of them a tile was lit for, and since when that is past.

#include <cstdint>
#include <vector>

#include "protocol/model/scene_types.h"
namespace mirage {

struct InstanceView;
struct ObjectDescription;
class SceneView;

class LightHistory {
 public:
  /// A lighting, kept under one serial however often it returns.
  struct State {
    std::uint32_t serial = 0;
    std::uint64_t turn = 0;     ///< when it last became current, counted in changes
    std::int64_t ended_us = 0;  ///< when it last ceased to be
    Lighting lighting;
    std::vector<std::uint64_t> keys;  ///< by instance: object and light on it; 0: not yet asked for
  };

  /// Learns the scene's instances; `lighting` is current.
  void reset(const SceneView& scene, const Lighting& lighting);
  /// Learns the instances that have come since.
  void grow(const SceneView& scene);
  /// Makes `lighting` current; a former one when it returns is the same state again. At most
  /// limits::kMaxLightingStatesPerClient are kept, the one shown longest ago goes first.
  void set(const Lighting& lighting, std::int64_t now_us);

  /// Newest last; never empty after reset().
  const std::vector<State>& states() const { return states_; }
  const State& current() const { return states_.back(); }
  /// Serial of the newest state: grows with every lighting not known before.
  std::uint32_t latest_serial() const { return next_serial_ - 1; }
  /// nullptr when it is kept no longer.
  const State* find(std::uint32_t serial) const;
  /// Equal for instances that look the same under the state: same object, same light on it.
  std::uint64_t key(std::uint32_t instance, const State& state) const;

  std::uint32_t object_of(std::uint32_t instance) const { return instances_[instance].object; }
  bool lit(std::uint32_t instance) const { return objects_[object_of(instance)].lit; }
  bool can_relight(std::uint32_t instance) const { return objects_[object_of(instance)].relight; }
  std::size_t instances() const { return instances_.size(); }

 private:
  struct Object {
    glm::vec3 center{0};
    float radius = 0;
    bool lit = false, relight = false;
  };
  struct Placed {
    std::uint32_t object = 0;
    Similarity world_from_object;
  };
  std::vector<Object> objects_;
  std::vector<Placed> instances_;
  mutable std::vector<State> states_;  // their keys are computed when first asked for
  std::uint32_t next_serial_ = 1;
  std::uint64_t turn_ = 0;
};

/// What a change of light is worth in px (TECHNIQUES row 19): the centre of the object as a white
/// surface, facing along each axis of its space, under both lightings; the largest difference of a
/// colour (0..1, as displays clamp) times `radius_px`. A change of the whole range over the object
/// counts as much as showing it displaced by its radius.
double light_error_px(const Lighting& then, const Lighting& now, const InstanceView& instance,
                      const ObjectDescription& object, double radius_px);

}  // namespace mirage
