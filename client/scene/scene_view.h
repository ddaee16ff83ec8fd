#pragma once
// Scene view: the scene as far as the client knows it. It holds objects, light, sky, the instances
// and groups that the server has told, and a grid for culling. Instances have indices of this
// client, in order of arrival, and ids of the server.

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

/// An instance with precomputed values that every frame needs.
struct InstanceView {
  std::uint32_t id = 0;      ///< the server's id
  std::uint32_t object = 0;  ///< index into SceneView::objects
  Similarity world_from_object;
  glm::dvec3 center{0};  ///< centre of the bounding sphere, world space
  double radius = 0;     ///< radius of the bounding sphere, world space, m
  double clip_offset_s = 0;
  glm::dvec3 velocity{0};  ///< on its way (Track), world space, m/s
  Importance importance = Importance::kNormal;
  /// Index of the group it belongs to, or of the instance it is a part of.
  std::uint32_t parent = kNoParent;
  /// Groups and parts: range of the server's ids of the instances in it.
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

  /// Take the pages of the scene. Instance pages keep coming once the scene is complete; known
  /// instances stay unchanged. Errors: kWireState if pages come out of order, kWireValue if they
  /// refer to something that does not exist.
  Result<void> accept(const wire::WelcomeT& welcome);
  Result<void> accept(const wire::LightProbePageT& page, const Bytes& payload);
  Result<void> accept(const wire::ImagePageT& page);
  Result<void> accept(const wire::ObjectPageT& page);
  Result<void> accept(const wire::InstancePageT& page);
  /// Takes from a welcome what may be chosen; two choices may show the same scene.
  void note_choices(const wire::WelcomeT& welcome);

  /// Moves what goes a way (Track) to where it is at a time, s.
  void move_to(double time_s);

  bool welcomed() const { return welcomed_; }
  /// True if some object has blended surfaces.
  bool blends() const;
  /// True if there is a scene to draw: the probe, all images and objects, and everything without a
  /// parent have arrived.
  bool complete() const;
  /// True once everything that the server sends unasked has arrived.
  bool described() const { return described_; }

  std::uint64_t revision = 0;
  std::string name;
  std::string renderer;
  std::uint64_t triangles = 0;
  Lighting lighting;
  std::shared_ptr<const LightProbe> probe;  ///< the probe that lighting.probe names; nullptr: none
  Environment environment;
  HomeView home;
  SceneChoices choices;
  bool geometry = false;
  bool reference = false;
  bool shadows = false;  ///< full renders have the sun's shadows, and shadow tiles may be asked for
  std::vector<ImageDescription> images;
  /// The server's objects, then those of groups in order of arrival.
  std::vector<ObjectDescription> objects;
  std::vector<InstanceView> instances;  ///< grows as pages arrive
  /// Number of instances in the scene, without groups, whether known here or not.
  std::size_t all_instances = 0;
  glm::dvec3 bounds_center{0};
  double bounds_radius = 1;

  /// Returns the instances (and nested groups) of a group, or the parts of an instance. Empty for
  /// anything else, and until they are known.
  Members members(std::uint32_t group) const {
    const Run& run = members_of_[group];
    return {members_.data() + run.first, members_.data() + run.last};
  }
  /// True if members() are known. Always true for an instance that is neither a group nor cut.
  bool opened(std::uint32_t instance) const {
    const ObjectDescription& object = objects[instances[instance].object];
    return !(object.group || object.cut) || members_of_[instance].known;
  }
  /// Returns the indices of all instances and groups without a parent.
  const std::vector<std::uint32_t>& roots() const { return roots_; }
  /// Returns the index of an instance or group from the server's id; kNoParent: not known.
  std::uint32_t index_of(std::uint32_t id) const;
  /// Returns the server's number of the instance's object.
  std::uint32_t object_id(std::uint32_t instance) const;

  /// Calls `visit` for every instance and group without a parent that may be in the view, widened
  /// by `guard` radians.
  void for_visible_roots(const Camera& camera, double guard,
                         const std::function<void(std::uint32_t)>& visit) const;
  /// Calls `visit` for every instance that may be in that view and is not a group.
  void for_visible(const Camera& camera, double guard,
                   const std::function<void(std::uint32_t)>& visit) const;

 private:
  struct Cell {
    glm::dvec3 center{0};
    double radius = 0;
    std::vector<std::uint32_t> instances;
  };
  /// An instance that goes a way, and its place at the start.
  struct Tracked {
    std::uint32_t instance = 0;
    Similarity start;
  };
  /// The members of a group: a range of members_.
  struct Run {
    std::uint32_t first = 0, last = 0;
    bool known = false;
  };
  Result<void> check_page(const wire::InstancePageT& page) const;
  /// Notes how deeply the groups of the page nest. Error kWireLimit if too deeply.
  Result<void> note_depths(const wire::InstancePageT& page);
  void add(InstanceView view, std::uint32_t parent_id);
  void link_members(std::size_t first_new);
  void build_grid();

  std::vector<Tracked> tracked_;
  /// Depths by the server's id of the group.
  std::unordered_map<std::uint32_t, std::uint32_t> group_depth_;
  bool welcomed_ = false;
  bool described_ = false;
  std::size_t expected_images_ = 0;
  std::size_t expected_objects_ = 0;
  std::size_t expected_groups_ = 0;
  std::size_t expected_roots_ = 0;
  std::unordered_map<std::uint32_t, std::uint32_t> index_by_id_;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> roots_;
  std::vector<Run> members_of_;  ///< by instance index
  std::vector<std::uint32_t> members_;
};

}  // namespace mirage
