#pragma once
// The scene as the client knows it: objects, instances, light, sky; and a grid to cull by.

#include <functional>
#include <string>
#include <vector>

#include "protocol/camera.h"
#include "protocol/image_codec.h"
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
  Importance importance = Importance::kNormal;
  std::uint32_t parent = kNoParent;  ///< instance of the group it belongs to

  static constexpr std::uint32_t kNoParent = 0xffffffffu;
};

class SceneView {
 public:
  /// A run of instance indices.
  struct Members {
    const std::uint32_t* first;
    const std::uint32_t* last;
    const std::uint32_t* begin() const { return first; }
    const std::uint32_t* end() const { return last; }
  };

  /// Takes Welcome, ImagePage, ObjectPage and InstancePage. Errors: kWireState when pages do not
  /// follow on, kWireValue when they refer to what is not there.
  Result<void> accept(const wire::WelcomeT& welcome);
  Result<void> accept(const wire::ImagePageT& page);
  Result<void> accept(const wire::ObjectPageT& page);
  Result<void> accept(const wire::InstancePageT& page);

  bool welcomed() const { return welcomed_; }
  /// Some object has blended surfaces.
  bool blends() const;
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
  bool shadows = false;  ///< the sun's are in references, and their tiles may be asked for
  std::vector<ImageDescription> images;
  std::vector<ObjectDescription> objects;
  std::vector<InstanceView> instances;
  glm::dvec3 bounds_center{0};
  double bounds_radius = 1;

  /// Instances (and nested groups) of a group's instance; empty for any other.
  Members members(std::uint32_t group) const {
    return {members_.data() + first_member_[group], members_.data() + first_member_[group + 1]};
  }

  /// Calls `visit` for every instance and group without a parent that may be in the view grown by
  /// `guard` radians.
  void for_visible_roots(const Camera& camera, double guard,
                         const std::function<void(std::uint32_t)>& visit) const;
  /// The same for every instance that is no group.
  void for_visible(const Camera& camera, double guard,
                   const std::function<void(std::uint32_t)>& visit) const;

 private:
  struct Cell {
    glm::dvec3 center{0};
    double radius = 0;
    std::vector<std::uint32_t> instances;
  };
  Result<void> finish();
  Result<void> link_members();
  void build_grid();

  bool welcomed_ = false;
  std::size_t expected_images_ = 0;
  std::size_t expected_objects_ = 0;
  std::size_t expected_instances_ = 0;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> first_member_;  ///< by instance, and one past the last
  std::vector<std::uint32_t> members_;
};

}  // namespace mirage
