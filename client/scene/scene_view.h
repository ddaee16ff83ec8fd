#pragma once
// The scene as far as the client knows it: objects, light, sky, the instances and groups it has
// been told of; and a grid to cull by. Instances have indices of this client's, in the order in
// which they came, and ids of the server's.

#include <functional>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"
#include "protocol/codec/image_codec.h"
#include "protocol/impostor/camera.h"
#include "protocol/impostor/object_proxy.h"
#include "protocol/model/scene_types.h"
namespace mirage {

struct LightProbe;
namespace wire {
struct ImagePageT;
struct InstancePageT;
struct LightProbePageT;
struct ObjectPageT;
struct WelcomeT;
}  // namespace wire

/// An instance with what every frame needs of it precomputed.
struct InstanceView {
  std::uint32_t id = 0;      ///< the server's
  std::uint32_t object = 0;  ///< index into SceneView::objects
  Similarity world_from_object;
  glm::dvec3 center{0};  ///< of the bounding sphere, world
  double radius = 0;     ///< world, m
  double clip_offset_s = 0;
  Importance importance = Importance::kNormal;
  std::uint32_t parent = kNoParent;  ///< index of the group it belongs to, or is a part of
  /// Groups and parts: ids of the instances in it.
  std::uint32_t first_leaf = 0, leaves = 0;

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
    bool empty() const { return first == last; }
  };

  /// Takes Welcome, LightProbePage, ImagePage, ObjectPage and InstancePage. Instance pages go on
  /// coming once the scene is complete; what is known already changes nothing. Errors: kWireState
  /// when pages do not follow on, kWireValue when they refer to what is not there.
  Result<void> accept(const wire::WelcomeT& welcome);
  Result<void> accept(const wire::LightProbePageT& page, const Bytes& payload);
  Result<void> accept(const wire::ImagePageT& page);
  Result<void> accept(const wire::ObjectPageT& page);
  Result<void> accept(const wire::InstancePageT& page);

  bool welcomed() const { return welcomed_; }
  /// Some object has blended surfaces.
  bool blends() const;
  /// The probe, all images and objects are there, and all that has no parent: there is a scene to
  /// draw.
  bool complete() const;
  /// All that comes unasked is there.
  bool described() const { return described_; }

  std::uint64_t revision = 0;
  std::string name;
  std::string renderer;
  std::uint64_t triangles = 0;
  Lighting lighting;
  std::shared_ptr<const LightProbe> probe;  ///< that lighting.probe names; nullptr: none
  Environment environment;
  HomeView home;
  bool geometry = false;
  bool reference = false;
  bool shadows = false;  ///< the sun's are in references, and their tiles may be asked for
  std::vector<ImageDescription> images;
  std::vector<ObjectDescription> objects;  ///< the server's, then those of groups as they come
  std::vector<InstanceView> instances;     ///< grows
  std::size_t all_instances = 0;           ///< of the scene, known here or not; without groups
  glm::dvec3 bounds_center{0};
  double bounds_radius = 1;

  /// Instances (and nested groups) of a group, or the parts of an instance; empty for any other,
  /// and until they are known.
  Members members(std::uint32_t group) const {
    const Run& run = members_of_[group];
    return {members_.data() + run.first, members_.data() + run.last};
  }
  /// Whether members() are known. True for an instance that is neither a group nor cut.
  bool opened(std::uint32_t instance) const {
    const ObjectDescription& object = objects[instances[instance].object];
    return !(object.group || object.cut) || members_of_[instance].known;
  }
  /// What has no parent, by index.
  const std::vector<std::uint32_t>& roots() const { return roots_; }
  /// Index of an instance or group by the server's id; kNoParent: not known.
  std::uint32_t index_of(std::uint32_t id) const;
  /// Its object's number at the server.
  std::uint32_t object_id(std::uint32_t instance) const;

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
  /// The members of a group, in members_.
  struct Run {
    std::uint32_t first = 0, last = 0;
    bool known = false;
  };
  Result<void> check_page(const wire::InstancePageT& page) const;
  /// Error kWireLimit.
  Result<void> note_depths(const wire::InstancePageT& page);
  void add(InstanceView view, std::uint32_t parent_id);
  void link_members(std::size_t first_new);
  void build_grid();

  std::unordered_map<std::uint32_t, std::uint32_t> group_depth_;  ///< by the server's id
  bool welcomed_ = false;
  bool described_ = false;
  std::size_t expected_images_ = 0;
  std::size_t expected_objects_ = 0;
  std::size_t expected_groups_ = 0;
  std::size_t expected_roots_ = 0;
  std::unordered_map<std::uint32_t, std::uint32_t> index_by_id_;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> roots_;
  std::vector<Run> members_of_;  ///< by instance
  std::vector<std::uint32_t> members_;
};

}  // namespace mirage
