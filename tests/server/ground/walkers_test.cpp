// Walkers: people who walk at random through whole scenes, on the ground as a server makes it and a
// client knows it. What they must not pass is told by the scene's own triangles.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>

#include "client/scene/ground_map.h"
#include "client/scene/scene_view.h"
#include "client/screen/pilot.h"
#include "protocol/codec/ground_codec.h"
#include "server/ground/ground.h"
#include "server/prepare/prepared_scene.h"
#include "server/prepare/world_box.h"

namespace mirage::test {
namespace {

constexpr int kSeeds = 20;
constexpr double kSeconds = 60, kFrameS = 1.0 / 30;
constexpr double kNone = std::numeric_limits<double>::infinity();

using Triangle = std::array<glm::dvec3, 3>;

/// The solid triangles of a scene that stand still, by squares of the world.
class Solid {
 public:
  explicit Solid(const PreparedScene& scene, double square) : square_(square) {
    for (const Instance& instance : scene.scene.instances) {
      if (!scene.objects[instance.object].moves()) add(scene, instance);
    }
  }
  /// Returns the share of the way from `a` to `b` at which it meets a triangle; kNone: it is free.
  /// Both are less than a square apart.
  double meets(const glm::dvec3& a, const glm::dvec3& b) const {
    double nearest = kNone;
    for (const double x : {-1.0, 0.0, 1.0}) {
      for (const double z : {-1.0, 0.0, 1.0}) {
        const auto found = squares_.find(square_of(a.x + x * square_, a.z + z * square_));
        if (found == squares_.end()) continue;
        for (const Triangle& t : found->second) nearest = std::min(nearest, entry(t, a, b));
      }
    }
    return nearest;
  }

 private:
  std::pair<int, int> square_of(double x, double z) const {
    return {static_cast<int>(std::floor(x / square_)), static_cast<int>(std::floor(z / square_))};
  }
  void add(const PreparedScene& scene, const Instance& instance) {
    const Mesh& mesh = scene.scene.objects[instance.object].mesh;
    const Similarity& m = instance.world_from_object;
    const auto at = [&](std::uint32_t i) {
      return m.position +
             glm::dquat(m.rotation) *
                 (double{m.scale} * glm::dvec3(mesh.vertices[mesh.indices[i]].position));
    };
    for (const Primitive& p : mesh.primitives) {
      if (scene.scene.materials[p.material].alpha_mode == AlphaMode::kMask) continue;
      for (std::uint32_t i = p.first_index; i + 2 < p.first_index + p.index_count; i += 3) {
        const Triangle t = {at(i), at(i + 1), at(i + 2)};
        const glm::dvec3 low = glm::min(glm::min(t[0], t[1]), t[2]);
        const glm::dvec3 high = glm::max(glm::max(t[0], t[1]), t[2]);
        const auto [x0, z0] = square_of(low.x, low.z);
        const auto [x1, z1] = square_of(high.x, high.z);
        for (int x = x0; x <= x1; ++x) {
          for (int z = z0; z <= z1; ++z) squares_[{x, z}].push_back(t);
        }
      }
    }
  }
  static double entry(const Triangle& t, const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
    const double from = glm::dot(n, a - t[0]), to = glm::dot(n, b - t[0]);
    if (from * to > 0 || from == to) return kNone;
    const double share = from / (from - to);
    const glm::dvec3 p = a + share * (b - a);
    for (int i = 0; i < 3; ++i) {
      const glm::dvec3 &u = t[i], &v = t[(i + 1) % 3];
      if (glm::dot(glm::cross(v - u, p - u), n) < 0) return kNone;
    }
    return share;
  }

  double square_;
  std::map<std::pair<int, int>, std::vector<Triangle>> squares_;
};

/// The cost of the ground of a scene.
struct Made {
  double blocks = 0, ms = 0, bytes = 0;
};

/// One person: keys are pressed at random.
class Walker {
 public:
  Walker(const PreparedScene& scene, const SceneView& view, GroundMap& ground, unsigned seed,
         Made& made)
      : scene_(scene), ground_(ground), made_(made), random_(seed) {
    pilot_.meet(view);
    pose_ = look_at(view.home.eye, view.home.target);
  }
  const glm::dvec3& eye() const { return pose_.eye; }
  void frame(int number) {
    for (const GroundBlockId& id : ground_.missing_around(eye().x, eye().z)) {
      const auto began = std::chrono::steady_clock::now();
      GroundBlock block = make_ground(scene_, ground_.body(), id).take();
      const std::chrono::duration<double, std::milli> took =
          std::chrono::steady_clock::now() - began;
      made_.ms += took.count();
      made_.bytes += static_cast<double>(encode_ground(block).size());
      ++made_.blocks;
      ground_.add(std::move(block));
    }
    if (number % 15 == 0) {  // twice a second
      std::uniform_real_distribution<double> any(-1, 1);
      by_.turn = {0.06 * any(random_), 0.02 * any(random_)};
      const double boost = any(random_) > 0.5 ? 5 : 1;  // Shift
      by_.move = glm::dvec3(any(random_), any(random_), 1.5 + any(random_)) * (boost * kFrameS);
      by_.zoom = any(random_) > 0.9 ? 1 : 0;
    }
    pilot_.steer(by_, 1, ground_, pose_);
  }

 private:
  const PreparedScene& scene_;
  GroundMap& ground_;
  Made& made_;
  Pilot pilot_;
  Pose pose_;
  Steering by_;
  std::mt19937 random_;
};

struct Walked {
  int frames = 0, through = 0, low = 0, without_ground = 0;
  double way_m = 0;
};

Walked walk(const std::string& spec) {
  const Result<std::shared_ptr<const PreparedScene>> scene = load_scene(spec);
  EXPECT_TRUE(scene.ok());
  Walked out;
  if (!scene) return out;
  SceneView view;
  view.home = (*scene)->scene.home;
  view.bounds_center = (*scene)->bounds_center;
  view.bounds_radius = (*scene)->bounds_radius;
  const double height = view.home.walk_eye_m;
  EXPECT_GT(height, 0) << spec << " has no ground";
  if (!(height > 0)) return out;
  GroundMap ground;
  ground.reset({height});
  const Solid solid(**scene, height);
  Made made;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    Walker walker(**scene, view, ground, seed, made);
    for (int i = 0; i < static_cast<int>(kSeconds / kFrameS); ++i) {
      const glm::dvec3 before = walker.eye();
      walker.frame(i);
      const glm::dvec3 way = walker.eye() - before;
      ++out.frames;
      out.way_m += glm::length(way);
      // A longer way may go round a corner.
      const bool straight = glm::length(way) > 0 && glm::length(way) < 0.5 * height;
      if (straight) out.through += solid.meets(before, walker.eye()) <= 1;
      const double under =
          3 * height * solid.meets(walker.eye(), walker.eye() - glm::dvec3(0, 3 * height, 0));
      out.without_ground += under == kNone;
      out.low += under < 0.5 * height;
    }
  }
  std::printf(
      "%s: eye %.2f m, %.0f m walked in %d x %.0f s; frames through something %d, low over "
      "the ground %d, without ground %d; a block has %.0f bytes and takes %.1f ms\n",
      spec.c_str(), height, out.way_m, kSeeds, kSeconds, out.through, out.low, out.without_ground,
      made.bytes / made.blocks, made.ms / made.blocks);
  return out;
}

class ServerWalkers : public testing::TestWithParam<const char*> {};

TEST_P(ServerWalkers, NobodyGoesThroughWallsOrUnderTheGround) {
  const Walked walked = walk(GetParam());
  EXPECT_GT(walked.way_m, 20 * kSeeds) << "they do walk";
  EXPECT_EQ(walked.through, 0);
  EXPECT_EQ(walked.low, 0);
  EXPECT_EQ(walked.without_ground, 0);
}

INSTANTIATE_TEST_SUITE_P(Places, ServerWalkers,
                         testing::Values("builtin:forest?trees=100", "builtin:city",
                                         "builtin:museum?objects=12&triangles=4000",
                                         "builtin:clutter"));

}  // namespace
}  // namespace mirage::test
