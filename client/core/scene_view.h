#pragma once
// The scene as the client knows it: objects, instances, light, sky; and a grid to cull by.

#include <functional>
#include <string>
#include <vector>

#include "protocol/camera.h"
#include "protocol/message.h"
#include "protocol/object_proxy.h"
#include "protocol/scene_types.h"

namespace mirage {

/// An instance with what every frame needs of it precomputed.
struct InstanceView {
  std::uint32_t object = 0;
  Similarity world_from_object;
  glm::dvec3 center{0};  ///< of the bounding sphere, world
  double radius = 0;     ///< world, m
  double clip_offset_s = 0;
};

class SceneView {
 public:
  /// Takes Welcome, ObjectPage and InstancePage. Errors: kWireState when pages do not follow on,
  /// kWireValue when they refer to what is not there.
  Result<void> accept(const wire::WelcomeT& welcome);
  Result<void> accept(const wire::ObjectPageT& page);
  Result<void> accept(const wire::InstancePageT& page);

  bool welcomed() const { return welcomed_; }
  /// Everything the welcome announced has arrived.
  bool complete() const;

  std::uint64_t revision = 0;
  std::string name;
  std::string renderer;
  std::uint64_t triangles = 0;
  Lighting lighting;
  Environment environment;
  HomeView home;
  bool geometry = false;
  bool reference = false;
  std::vector<ObjectDescription> objects;
  std::vector<InstanceView> instances;
  glm::dvec3 bounds_center{0};
  double bounds_radius = 1;

  /// Large scenery that exists once (terrain, water, a room's shell): geometry from the start.
  bool surrounds(std::uint32_t object) const { return surrounds_[object]; }

  /// Calls `visit` for every instance that may be in the view grown by `guard` radians.
  void for_visible(const Camera& camera, double guard,
                   const std::function<void(std::uint32_t)>& visit) const;

 private:
  struct Cell {
    glm::dvec3 center{0};
    double radius = 0;
    std::vector<std::uint32_t> instances;
  };
  void finish();
  void build_grid();
  void find_surroundings();

  bool welcomed_ = false;
  std::size_t expected_objects_ = 0;
  std::size_t expected_instances_ = 0;
  std::vector<Cell> cells_;
  std::vector<bool> surrounds_;  ///< by object
};

}  // namespace mirage
