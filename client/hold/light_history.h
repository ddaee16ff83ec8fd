#pragma once
// Light history: the lightings that a session has had. It tells which one a tile was lit for, and
// since when that lighting has been past.

#include <cstdint>
#include <vector>

#include "protocol/model/scene_types.h"
namespace mirage {

struct InstanceView;
struct ObjectDescription;
class SceneView;

class LightHistory {
 public:
  /// A lighting. It keeps one serial, however often it returns.
  struct State {
    std::uint32_t serial = 0;
    std::uint64_t turn = 0;     ///< changes of light so far when it last became current
    std::int64_t ended_us = 0;  ///< when it last stopped being current
    Lighting lighting;
    /// Hashes by instance, of object and light on it; 0: not computed yet.
    std::vector<std::uint64_t> keys;
  };

  /// Forgets everything and learns the scene's instances. `lighting` becomes current.
  void reset(const SceneView& scene, const Lighting& lighting);
  /// Learns the instances that have arrived since.
  void grow(const SceneView& scene);
  /// Makes `lighting` current. A lighting that returns is the same state again. At most
  /// limits::kMaxLightingStatesPerClient are kept; the one that was current longest ago goes first.
  void set(const Lighting& lighting, std::int64_t now_us);

  /// Returns the states, the newest last; never empty after reset().
  const std::vector<State>& states() const { return states_; }
  const State& current() const { return states_.back(); }
  /// Returns the serial of the newest state. It grows with every lighting not known before.
  std::uint32_t latest_serial() const { return next_serial_ - 1; }
  /// Returns the state; nullptr if it is no longer kept.
  const State* find(std::uint32_t serial) const;
  /// Returns a key that is equal for instances that look the same under the state: same object,
  /// same light on it.
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
  mutable std::vector<State> states_;  // mutable: keys are computed on demand
  std::uint32_t next_serial_ = 1;
  std::uint64_t turn_ = 0;
};

/// Returns the error, px, that a change of light amounts to (TECHNIQUES row 19). The centre of the
/// object counts as a white surface, facing along each axis of its space. The error is the largest
/// difference of a colour (0..1, as displays clamp) between both lightings, times `radius_px`. A
/// change over the whole range counts as much as showing the object displaced by its radius.
double light_error_px(const Lighting& then, const Lighting& now, const InstanceView& instance,
                      const ObjectDescription& object, double radius_px);

}  // namespace mirage
