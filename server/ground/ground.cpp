#include "server/ground/ground.h"

#include <recastnavigation/Recast.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include "server/prepare/prepared_scene.h"
#include "server/prepare/world_box.h"

namespace mirage {
namespace {

constexpr double kSteepest = 0.6427876096865394;  // cosine of 50 degrees: of walkable slopes
constexpr double kStepShare = 1.0 / 34;           // height of a step of the code, eye heights
constexpr double kMostSteps = 8000;               // Recast's columns have 13 bits of height
constexpr int kBorder = 4;                        // cells around the block that decide on its own
constexpr std::size_t kMostOfACell = 15;          // floors
constexpr std::size_t kBatch = 16'384;            // triangles handed over at once

// The part of the scene around a block.
class Surroundings {
 public:
  /// Receives the three corners of a triangle, relative to the origin.
  using Visit = std::function<void(const glm::vec3 (&)[3])>;

  Surroundings(const PreparedScene& scene, const WalkBody& body, GroundBlockId id)
      : scene_(scene), cell_(body.cell_m()) {
    origin_ = glm::dvec3(id.x * body.block_m(), scene.bounds_center.y, id.z * body.block_m());
    const double border = kBorder * cell_;
    low_ = glm::dvec2(origin_.x, origin_.z) - border;
    high_ = glm::dvec2(origin_.x, origin_.z) + body.block_m() + border;
  }

  /// Begins at the block's lowest corner, at the height of the scene's centre.
  const glm::dvec3& origin() const { return origin_; }

  /// Calls `visit` for each triangle that is solid and may be over the block or its border.
  void each_triangle(const Visit& visit) const {
    for (const std::uint32_t root : scene_.grouping.roots) each_of(root, visit);
  }

 private:
  bool beside(const glm::dvec3& low, const glm::dvec3& high) const {
    return low.x > high_.x || high.x < low_.x || low.z > high_.y || high.z < low_.y;
  }

  void each_of(std::uint32_t member, const Visit& visit) const {
    const auto own = static_cast<std::uint32_t>(scene_.scene.instances.size());
    if (member < own) return each_of(scene_.scene.instances[member], visit);
    const InstanceGroup& group = scene_.grouping.groups[member - own];
    const glm::dvec3 half(group.bounds.half);
    if (beside(group.bounds.center - half, group.bounds.center + half)) return;
    for (std::uint32_t i = 0; i < group.members; ++i) {
      each_of(scene_.grouping.members[group.first_member + i], visit);
    }
  }

  void each_of(const Instance& instance, const Visit& visit) const {
    const ObjectDescription& object = scene_.objects[instance.object];
    const WorldBox box = world_box(instance, object);
    if (object.moves() || beside(box.low, box.high)) return;
    const Mesh& mesh = scene_.scene.objects[instance.object].mesh;
    const Similarity& m = instance.world_from_object;
    const glm::dmat3 turn = glm::mat3_cast(glm::dquat(m.rotation)) * double{m.scale};
    const glm::dvec3 shift = m.position - origin_;
    for (const Primitive& p : mesh.primitives) {
      const bool solid = scene_.scene.materials[p.material].alpha_mode != AlphaMode::kMask;
      if (!solid || p.kind != PrimitiveKind::kTriangles) continue;
      for (std::uint32_t i = p.first_index; i + 2 < p.first_index + p.index_count; i += 3) {
        glm::vec3 corners[3];
        for (std::uint32_t k = 0; k < 3; ++k) {
          const glm::dvec3 at(mesh.vertices[mesh.indices[i + k]].position);
          corners[k] = glm::vec3(shift + turn * at);
        }
        const glm::dvec3 low(glm::min(glm::min(corners[0], corners[1]), corners[2]));
        const glm::dvec3 high(glm::max(glm::max(corners[0], corners[1]), corners[2]));
        if (!beside(low + origin_, high + origin_)) visit(corners);
      }
    }
  }

  const PreparedScene& scene_;
  const double cell_;
  glm::dvec3 origin_;
  glm::dvec2 low_, high_;  // x and z of the block and its border
};

// Hands triangles to Recast in batches.
class Columns {
 public:
  Columns(rcHeightfield& field, int flag_merge) : field_(field), flag_merge_(flag_merge) {}

  void add(const glm::vec3 (&corners)[3]) {
    const glm::vec3 across = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double length = glm::length(glm::dvec3(across));
    const bool walkable = length > 0 && std::abs(across.y) >= kSteepest * length;
    for (const glm::vec3& corner : corners) {
      corners_.insert(corners_.end(), {corner.x, corner.y, corner.z});
    }
    areas_.push_back(walkable ? RC_WALKABLE_AREA : RC_NULL_AREA);
    if (areas_.size() == kBatch) flush();
  }
  /// False: there was no memory.
  bool flush() {
    ok_ = ok_ && (areas_.empty() ||
                  rcRasterizeTriangles(&context_, corners_.data(), areas_.data(),
                                       static_cast<int>(areas_.size()), field_, flag_merge_));
    corners_.clear();
    areas_.clear();
    return ok_;
  }

 private:
  rcContext context_{false};
  rcHeightfield& field_;
  const int flag_merge_;
  std::vector<float> corners_;
  std::vector<unsigned char> areas_;
  bool ok_ = true;
};

struct FreeField {
  void operator()(rcHeightfield* field) const { rcFreeHeightField(field); }
  void operator()(rcCompactHeightfield* field) const { rcFreeCompactHeightfield(field); }
};

int cells(double length, double size) { return static_cast<int>(std::ceil(length / size)); }

// Copies the floors of the block itself.
void take_floors(const rcCompactHeightfield& field, GroundBlock& out) {
  for (int z = 0; z < kGroundCells; ++z) {
    for (int x = 0; x < kGroundCells; ++x) {
      const rcCompactCell& cell = field.cells[(z + kBorder) * field.width + x + kBorder];
      std::uint8_t& count =
          out.counts[static_cast<std::size_t>(z) * kGroundCells + static_cast<std::size_t>(x)];
      for (unsigned i = cell.index, end = cell.index + unsigned{cell.count}; i < end; ++i) {
        if (field.areas[i] == RC_NULL_AREA || count == kMostOfACell) continue;
        if (out.floors.size() == kMostFloors) return;
        out.floors.push_back(field.spans[i].y);
        ++count;
      }
    }
  }
}

}  // namespace

Result<GroundBlock> make_ground(const PreparedScene& scene, const WalkBody& body,
                                GroundBlockId id) {
  GroundBlock out;
  out.id = id;
  out.counts.assign(std::size_t{kGroundCells} * kGroundCells, 0);
  const Surroundings around(scene, body, id);
  float lowest = std::numeric_limits<float>::infinity(), highest = -lowest;
  around.each_triangle([&](const glm::vec3(&corners)[3]) {
    for (const glm::vec3& corner : corners) {
      lowest = std::min(lowest, corner.y);
      highest = std::max(highest, corner.y);
    }
  });
  if (!(lowest <= highest)) return out;
  const auto step = static_cast<float>(
      std::max(kStepShare * body.eye_m, (double{highest} - double{lowest}) / kMostSteps));
  const auto cell = static_cast<float>(body.cell_m());
  const int edge = kGroundCells + 2 * kBorder;
  const float low[3] = {-kBorder * cell, lowest - step, -kBorder * cell};
  const float high[3] = {(kGroundCells + kBorder) * cell, highest + step,
                         (kGroundCells + kBorder) * cell};
  const auto no_memory = [] {
    return make_error(ErrorId::kResources, "there is no memory for a block of ground");
  };
  rcContext context(false);
  const std::unique_ptr<rcHeightfield, FreeField> field(rcAllocHeightfield());
  if (!field || !rcCreateHeightfield(&context, *field, edge, edge, low, high, cell, step)) {
    return no_memory();
  }
  const int climb = static_cast<int>(body.climb_m() / double{step});
  const int height = cells(body.height_m(), double{step});
  Columns columns(*field, climb);
  around.each_triangle([&](const glm::vec3(&corners)[3]) { columns.add(corners); });
  if (!columns.flush()) return no_memory();
  rcFilterLowHangingWalkableObstacles(&context, climb, *field);
  rcFilterLedgeSpans(&context, height, climb, *field);
  rcFilterWalkableLowHeightSpans(&context, height, *field);
  const std::unique_ptr<rcCompactHeightfield, FreeField> compact(rcAllocCompactHeightfield());
  if (!compact || !rcBuildCompactHeightfield(&context, height, climb, *field, *compact)) {
    return no_memory();
  }
  rcErodeWalkableArea(&context, cells(body.radius_m(), body.cell_m()), *compact);
  out.base_m = around.origin().y + double{low[1]};
  out.step_m = double{step};
  take_floors(*compact, out);
  return out;
}

}  // namespace mirage
