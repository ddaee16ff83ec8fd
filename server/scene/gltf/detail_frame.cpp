#include "server/scene/gltf/detail_frame.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

namespace mirage::gltf {
namespace {

constexpr std::size_t kSamples = 200'000;     // triangles looked at in a scene
constexpr std::size_t kMostPerObject = 4096;  // of one object
constexpr std::size_t kMostShells = 8;        // sky, clouds, stars
constexpr double kHollow = 4;                 // of a shell, over the radius of what it holds
constexpr double kSeenShare = 1.0 / 500;      // of the frame: a triangle of that size is seen whole
constexpr double kMuchSmaller = 1.0 / 50;     // the full frame shows the detail as a dot
constexpr double kSmaller = 1.0 / 4;          // enough, if next to nothing is left out
constexpr double kNextToNothing = 1.0 / 100;  // of the triangles
constexpr double kLadder = 1.1;               // between the radii that are compared

/// A triangle that stands for some of its neighbours.
struct Sample {
  glm::dvec3 corner[3];
  double weight = 0;  ///< how many triangles it stands for
  std::size_t instance = 0;

  glm::dvec3 center() const { return (corner[0] + corner[1] + corner[2]) / 3.0; }
  double size() const {
    return std::max({glm::distance(corner[0], corner[1]), glm::distance(corner[1], corner[2]),
                     glm::distance(corner[2], corner[0])});
  }
};

std::vector<Sample> sample_scene(const Scene& scene) {
  std::vector<Sample> samples;
  if (scene.instances.empty()) return samples;
  const std::size_t step = std::max<std::size_t>(1, scene.instances.size() / kSamples);
  const std::size_t used = scene.instances.size() / step;
  const std::size_t most = std::clamp<std::size_t>(kSamples / used, 1, kMostPerObject);
  ShownPositions shown(scene);
  for (std::size_t i = 0; i < scene.instances.size(); i += step) {
    const Instance& instance = scene.instances[i];
    const SceneObject& object = scene.objects[instance.object];
    const std::vector<std::uint32_t>& indices = object.mesh.indices;
    const std::size_t triangles = indices.size() / 3;
    const std::size_t stride = std::max<std::size_t>(1, triangles / most);
    const Similarity& world = instance.world_from_object;
    for (std::size_t t = 0; t < triangles; t += stride) {
      Sample& sample = samples.emplace_back();
      sample.instance = i;
      sample.weight = static_cast<double>(stride * step);
      for (std::size_t c = 0; c < 3; ++c) {
        const glm::dvec3 point(shown.at(instance.object, indices[3 * t + c]));
        sample.corner[c] =
            world.position + glm::dquat(world.rotation) * (double{world.scale} * point);
      }
    }
  }
  return samples;
}

Bounds bounds_of(const std::vector<Sample>& samples) {
  Bounds out;
  for (const Sample& sample : samples) {
    for (const glm::dvec3& corner : sample.corner) out.add(corner);
  }
  return out;
}

/// Returns the distance from a point to a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
double distance_to(const Sample& t, const glm::dvec3& p) {
  const glm::dvec3 ab = t.corner[1] - t.corner[0], ac = t.corner[2] - t.corner[0];
  const glm::dvec3 normal = glm::cross(ab, ac);
  const double area2 = glm::dot(normal, normal);
  if (area2 > 0) {
    const glm::dvec3 ap = p - t.corner[0];
    const double v = glm::dot(glm::cross(ap, ac), normal) / area2;
    const double w = glm::dot(glm::cross(ab, ap), normal) / area2;
    if (v >= 0 && w >= 0 && v + w <= 1) return std::abs(glm::dot(ap, normal)) / std::sqrt(area2);
  }
  double least = std::numeric_limits<double>::infinity();
  for (int edge = 0; edge < 3; ++edge) {
    const glm::dvec3& from = t.corner[edge];
    const glm::dvec3 along = t.corner[(edge + 1) % 3] - from;
    const double length2 = glm::dot(along, along);
    const double share =
        length2 > 0 ? std::clamp(glm::dot(p - from, along) / length2, 0.0, 1.0) : 0;
    least = std::min(least, glm::distance(p, from + share * along));
  }
  return least;
}

bool holds(const Bounds& outer, const Bounds& inner) {
  return glm::all(glm::lessThanEqual(outer.low, inner.low)) &&
         glm::all(glm::greaterThanEqual(outer.high, inner.high));
}

/// The samples of one instance.
struct Group {
  std::size_t instance = 0;
  std::vector<Sample> samples;
  Bounds bounds;
};

/// Divides samples, which are in the order of their instances; the largest group comes first.
std::vector<Group> group_by_size(const std::vector<Sample>& samples) {
  std::vector<Group> groups;
  for (const Sample& sample : samples) {
    if (groups.empty() || groups.back().instance != sample.instance) {
      groups.push_back({sample.instance, {}, {}});
    }
    groups.back().samples.push_back(sample);
  }
  for (Group& group : groups) group.bounds = bounds_of(group.samples);
  std::stable_sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) {
    return a.bounds.radius() > b.bounds.radius();
  });
  return groups;
}

/// Returns how many of the largest groups hold all others in a hollow.
std::size_t count_shells(const std::vector<Group>& groups) {
  const std::size_t most = std::min(kMostShells, groups.empty() ? 0 : groups.size() - 1);
  for (std::size_t count = most; count > 0; --count) {
    Bounds rest;
    for (std::size_t i = count; i < groups.size(); ++i) {
      rest.add(groups[i].bounds.low);
      rest.add(groups[i].bounds.high);
    }
    const double hollow = kHollow * rest.radius();
    const glm::dvec3 center = rest.center();
    const bool all = std::all_of(
        groups.begin(), groups.begin() + static_cast<std::ptrdiff_t>(count), [&](const Group& g) {
          return holds(g.bounds, rest) &&
                 std::all_of(g.samples.begin(), g.samples.end(), [&](const Sample& sample) {
                   return distance_to(sample, center) >= hollow;
                 });
        });
    if (all) return count;
  }
  return 0;
}

/// Returns the point in whose middle, along each axis, half of the triangles lie.
glm::dvec3 middle_of(const std::vector<Sample>& samples, double weight) {
  glm::dvec3 middle(0);
  std::vector<std::pair<double, double>> line(samples.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      line[i] = {samples[i].center()[axis], samples[i].weight};
    }
    std::sort(line.begin(), line.end());
    double sum = 0;
    for (const auto& [at, part] : line) {
      middle[axis] = at;
      sum += part;
      if (sum >= 0.5 * weight) break;
    }
  }
  return middle;
}

/// A frame around the samples nearest to the middle.
struct Frame {
  Bounds bounds;
  double inside = 0;  ///< triangles
  double seen = 0;    ///< triangles that are large enough in it to be seen, in part or whole
};

/// Returns the frame in which most triangles are seen.
Frame best_frame(const std::vector<Sample>& samples, double weight) {
  const glm::dvec3 middle = middle_of(samples, weight);
  struct Reached {
    double reach, size;
    std::size_t sample;
  };
  std::vector<Reached> order(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double size = samples[i].size();
    order[i] = {glm::distance(samples[i].center(), middle) + size, size, i};
  }
  std::sort(order.begin(), order.end(), [](const Reached& a, const Reached& b) {
    return a.reach != b.reach ? a.reach < b.reach : a.sample < b.sample;
  });
  Frame best, frame;
  double compared = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Sample& nearest = samples[order[i].sample];
    for (const glm::dvec3& corner : nearest.corner) frame.bounds.add(corner);
    frame.inside += nearest.weight;
    const double radius = frame.bounds.radius();
    if (radius < kLadder * compared && i + 1 < order.size()) continue;
    compared = radius;
    frame.seen = 0;
    for (std::size_t k = 0; k <= i; ++k) {
      const double share = std::min(1.0, order[k].size / (kSeenShare * radius));
      frame.seen += samples[order[k].sample].weight * share;
    }
    if (frame.seen > best.seen) best = frame;
  }
  return best;
}

}  // namespace

std::string DetailFrame::told() const {
  if (!leaves_out()) return {};
  std::string out = "the home view leaves out";
  for (std::size_t i = 0; i < surrounding.size(); ++i) {
    out += (i > 0 ? ", '" : " '") + surrounding[i] + "'";
  }
  if (!surrounding.empty()) out += ", around everything else";
  if (far_share > 0) {
    char text[64];
    std::snprintf(text, sizeof text, "%.2g %% of the triangles, far from the rest",
                  100 * far_share);
    out += (surrounding.empty() ? " " : ", and ") + std::string(text);
  }
  return out;
}

DetailFrame frame_detail(const Scene& scene, const Bounds& all) {
  DetailFrame out;
  out.bounds = all;
  const std::vector<Group> groups = group_by_size(sample_scene(scene));
  const std::size_t shells = count_shells(groups);
  std::vector<Sample> rest;
  for (std::size_t i = shells; i < groups.size(); ++i) {
    rest.insert(rest.end(), groups[i].samples.begin(), groups[i].samples.end());
  }
  if (rest.empty()) return out;
  for (std::size_t i = 0; i < shells; ++i) {
    out.surrounding.push_back(scene.objects[scene.instances[groups[i].instance].object].name);
  }
  const Bounds whole = bounds_of(rest);
  if (shells > 0) out.bounds = whole;
  double weight = 0;
  for (const Sample& sample : rest) weight += sample.weight;
  const Frame best = best_frame(rest, weight);
  const double ratio = best.bounds.radius() / whole.radius();
  const double outside = 1 - best.inside / weight;
  const bool much = ratio < kMuchSmaller || (ratio < kSmaller && outside < kNextToNothing);
  if (much && best.bounds.radius() > 0) {
    out.bounds = best.bounds;
    out.far_share = std::max(outside, 1e-4);
  }
  return out;
}

}  // namespace mirage::gltf
