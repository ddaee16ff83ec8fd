#include "server/prepare/find_track.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "protocol/base/limits.h"
#include "server/prepare/posed_extent.h"

namespace mirage {
namespace {

constexpr std::size_t kSamples = 2048;  // vertices that stand for all
constexpr float kLocalShare = 0.5f;     // of the reach of all poses: one alone must be smaller

/// Some of the vertices that the mesh draws, with their bindings; no morphs.
struct Sampled {
  std::vector<Vertex> vertices;
  Animation animation;
};

Sampled sample(const Mesh& mesh, const Animation& animation) {
  Sampled out;
  out.animation.clip_s = animation.clip_s;
  out.animation.joints = animation.joints;
  out.animation.bindings = animation.bindings;
  for (const Channel& channel : animation.channels) {
    if (channel.path != ChannelPath::kWeights) out.animation.channels.push_back(channel);
  }
  const std::size_t step = std::max<std::size_t>(1, mesh.indices.size() / kSamples);
  for (std::size_t i = 0; i < mesh.indices.size(); i += step) {
    out.vertices.push_back(mesh.vertices[mesh.indices[i]]);
    out.animation.vertices.push_back(animation.vertices[mesh.indices[i]]);
  }
  return out;
}

float reach(const PointBox& box) { return 0.5f * glm::length(box.high - box.low); }

PointBox box_at(const Sampled& sampled, double time_s) {
  std::vector<glm::vec3> points;
  pose_positions(sampled.vertices, sampled.animation, time_s, points);
  PointBox box;
  box.add(points);
  return box;
}

glm::vec3 middle(const PointBox& box) { return 0.5f * (box.low + box.high); }

/// Adds a joint above all others that takes the object back along its way.
Animation relative_to(const Track& track, const Animation& animation) {
  Animation out = animation;
  for (Joint& joint : out.joints) ++joint.parent;
  for (JointBinding& binding : out.bindings) ++binding.joint;
  for (Channel& channel : out.channels) {
    if (channel.path != ChannelPath::kWeights) ++channel.target;
  }
  Joint back;
  back.moves = true;
  out.joints.insert(out.joints.begin(), back);
  Channel way;
  way.target = 0;
  way.path = ChannelPath::kTranslation;
  for (std::size_t i = 0; i < track.places.size(); ++i) {
    way.times.push_back(track.clip_s * static_cast<float>(i) /
                        static_cast<float>(limits::kTrackSteps));
    const glm::vec3 place = -track.places[i];
    way.values.insert(way.values.end(), {place.x, place.y, place.z});
  }
  out.channels.push_back(std::move(way));
  return out;
}

bool has_room(const Animation& animation) {
  return animation.joints.size() < limits::kMaxJoints &&
         animation.channels.size() < limits::kMaxChannels;
}

}  // namespace

double take_track(SceneObject& object) {
  if (!object.animation || object.mesh.indices.empty() || !has_room(*object.animation)) return 0;
  const Sampled sampled = sample(object.mesh, *object.animation);
  const double clip_s = object.animation->clip_s;
  const auto time_of = [&](double step) {
    return clip_s * step / static_cast<double>(limits::kTrackSteps);
  };
  Track track;
  track.clip_s = object.animation->clip_s;
  PointBox all, way;
  float local = 0;
  for (std::size_t i = 0; i <= limits::kTrackSteps; ++i) {
    const PointBox box = box_at(sampled, time_of(static_cast<double>(i)));
    track.places.push_back(middle(box));
    local = std::max(local, reach(box));
    all.add({box.low, box.high});
    way.add({track.places.back()});
  }
  // A jump, or a bend between two places, carries the object away from the straight line.
  float away = 0;
  for (std::size_t i = 0; i < limits::kTrackSteps; ++i) {
    const double time = time_of(static_cast<double>(i) + 0.5);
    const glm::vec3 there = middle(box_at(sampled, time));
    away = std::max(away, glm::distance(there, glm::vec3(track.at(time))));
  }
  if (!(local + away < kLocalShare * reach(all))) return 0;
  // The object begins where its instance is.
  const glm::vec3 start = track.places.front();
  for (glm::vec3& place : track.places) place -= start;
  object.animation = std::make_shared<const Animation>(relative_to(track, *object.animation));
  object.track = std::move(track);
  return 2.0 * double{reach(way)};
}

}  // namespace mirage
