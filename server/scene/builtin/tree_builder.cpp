#include "server/scene/builtin/tree_builder.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/scene/builtin/scene_parts.h"
#include "server/scene/builtin/texture_paint.h"

namespace mirage::builtin {
namespace {

constexpr int kNoParent = -1;

struct Node {
  glm::vec3 position;
  int parent;
  float path_m;  ///< length from the root
  float radius = 0;
  int heir = kNoParent;  ///< thickest child, which continues the branch
};

struct Skeleton {
  std::vector<Node> nodes;
  std::vector<int> tips;

  int add(glm::vec3 position, int parent) {
    const float path =
        parent == kNoParent
            ? 0
            : nodes[static_cast<std::size_t>(parent)].path_m +
                  glm::length(position - nodes[static_cast<std::size_t>(parent)].position);
    nodes.push_back({position, parent, path});
    return static_cast<int>(nodes.size()) - 1;
  }
};

/// Shape of the crown: an ellipsoid, its surface broken into lumps.
struct Crown {
  glm::vec3 center;
  glm::vec3 radii;
  std::uint32_t seed;

  /// Returns 0 at the centre, 1 on the surface.
  float depth(glm::vec3 p) const {
    const glm::vec3 d = (p - center) / radii;
    const float lump = value_noise(d * 2.2f + 20.0f, seed);
    return glm::length(d) / (0.8f + 0.4f * lump);
  }
};

std::vector<glm::vec3> twig_ends(const TreeSpecies& species, const Crown& crown, Random& random) {
  std::vector<glm::vec3> ends;
  const auto wanted = static_cast<std::size_t>(species.tips);
  while (ends.size() < wanted) {
    const glm::vec3 out = random.direction();
    // Most foliage sits near the surface, where the light is.
    const float reach = 1 - 0.62f * random.unit() * random.unit();
    const glm::vec3 p = crown.center + out * crown.radii * reach;
    if (crown.depth(p) > 1 || p.y < species.crown_base * 0.8f) continue;
    ends.push_back(p);
  }
  const glm::vec3 root(0, species.crown_base, 0);
  std::sort(ends.begin(), ends.end(), [&](glm::vec3 a, glm::vec3 b) {
    return glm::dot(a - root, a - root) < glm::dot(b - root, b - root);
  });
  return ends;
}

/// Returns the node to which a twig end is joined: the one with the shortest way to the root and
/// the least new wood (a greedy minimum of new length + 0.4 times old length).
int best_joint(const Skeleton& skeleton, glm::vec3 end, float lowest) {
  int best = 0;
  float best_cost = 1e30f;
  for (std::size_t i = 0; i < skeleton.nodes.size(); ++i) {
    const Node& node = skeleton.nodes[i];
    if (node.position.y < lowest) continue;
    const glm::vec3 d = end - node.position;
    const float length = glm::length(d);
    // Branches rise, so joining from above costs more.
    const float fall = glm::max(0.0f, -d.y) * 0.9f;
    const float cost = length + fall + 0.4f * node.path_m;
    if (cost < best_cost) {
      best_cost = cost;
      best = static_cast<int>(i);
    }
  }
  return best;
}

void grow_twig(Skeleton& skeleton, int from, glm::vec3 end, float droop, Random& random) {
  const glm::vec3 start = skeleton.nodes[static_cast<std::size_t>(from)].position;
  const float length = glm::length(end - start);
  const int steps = glm::clamp(static_cast<int>(length / 0.7f), 1, 4);
  const glm::vec3 sideways = random.direction() * (0.1f * length);
  int parent = from;
  for (int i = 1; i <= steps; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(steps);
    const float bow = std::sin(t * 3.14159f);
    glm::vec3 p = glm::mix(start, end, t) + sideways * bow;
    p.y += bow * 0.12f * length - (i == steps ? droop : 0.0f);
    parent = skeleton.add(p, parent);
  }
  skeleton.tips.push_back(parent);
}

Skeleton grow_skeleton(const TreeSpecies& species, const Crown& crown, Random& random) {
  Skeleton skeleton;
  const float top = species.height * species.trunk_top;
  const glm::vec3 lean(random.range(-0.04f, 0.04f), 0, random.range(-0.04f, 0.04f));
  const float phase = random.angle();
  int node = skeleton.add({0, -0.4f, 0}, kNoParent);
  const int steps = static_cast<int>(top / 0.45f);
  for (int i = 1; i <= steps; ++i) {
    const float y = top * static_cast<float>(i) / static_cast<float>(steps);
    const float wave = 0.05f * std::sin(y * 1.1f + phase) * glm::smoothstep(0.0f, 2.0f, y);
    node = skeleton.add(lean * y + glm::vec3(wave, y, wave * 0.7f), node);
  }
  skeleton.tips.push_back(node);
  for (const glm::vec3& end : twig_ends(species, crown, random)) {
    const int joint = best_joint(skeleton, end, species.crown_base * 0.75f);
    grow_twig(skeleton, joint, end, species.droop * random.unit(), random);
  }
  return skeleton;
}

/// Pipe model: a branch's cross-section carries the sum of its children's (exponent 2.2).
void thicken(Skeleton& skeleton, float trunk_radius) {
  auto& nodes = skeleton.nodes;
  std::vector<float> load(nodes.size(), 0.0f);
  for (const int tip : skeleton.tips) load[static_cast<std::size_t>(tip)] = 1;
  for (std::size_t i = nodes.size(); i-- > 1;) {
    const auto parent = static_cast<std::size_t>(nodes[i].parent);
    load[parent] += load[i];
    const int heir = nodes[parent].heir;
    if (heir == kNoParent || load[static_cast<std::size_t>(heir)] < load[i]) {
      nodes[parent].heir = static_cast<int>(i);
    }
  }
  const float scale = trunk_radius / std::pow(load[0], 1 / 2.2f);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    nodes[i].radius = glm::max(0.008f, scale * std::pow(load[i], 1 / 2.2f));
    const float y = nodes[i].position.y;
    if (nodes[i].parent == kNoParent || y < 0.8f) {
      nodes[i].radius *= 1 + 0.7f * glm::smoothstep(0.9f, 0.0f, y);  // root flare
    }
  }
}

void add_branches(MeshBuilder& builder, const Skeleton& skeleton) {
  const auto& nodes = skeleton.nodes;
  std::vector<glm::vec3> path;
  std::vector<float> radii;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const int parent = nodes[i].parent;
    const bool starts =
        parent == kNoParent || nodes[static_cast<std::size_t>(parent)].heir != static_cast<int>(i);
    if (!starts) continue;
    path.clear();
    radii.clear();
    if (parent != kNoParent) {
      path.push_back(nodes[static_cast<std::size_t>(parent)].position);
      radii.push_back(
          glm::min(nodes[i].radius * 1.15f, nodes[static_cast<std::size_t>(parent)].radius));
    }
    for (int k = static_cast<int>(i); k != kNoParent; k = nodes[static_cast<std::size_t>(k)].heir) {
      path.push_back(nodes[static_cast<std::size_t>(k)].position);
      radii.push_back(nodes[static_cast<std::size_t>(k)].radius);
    }
    radii.back() = 0;
    const float thick = *std::max_element(radii.begin(), radii.end());
    builder.tube(path, radii, thick > 0.12f ? 12 : thick > 0.05f ? 7 : thick > 0.02f ? 5 : 3, 0.8f);
  }
}

void add_foliage(MeshBuilder& builder, const Skeleton& skeleton, const TreeSpecies& species,
                 const Crown& crown, Random& random) {
  for (const int tip : skeleton.tips) {
    const glm::vec3 center = skeleton.nodes[static_cast<std::size_t>(tip)].position;
    const glm::vec3 hue = glm::vec3(random.range(0.85f, 1.1f), 1.0f, random.range(0.75f, 1.05f));
    const float tone = random.range(0.78f, 1.0f);
    for (int i = 0; i < species.cards_per_tip; ++i) {
      const glm::vec3 away = random.direction();
      glm::vec3 offset = away * (species.card * 1.25f * std::sqrt(random.unit()));
      offset.y *= 0.7f;
      offset.y -= species.droop * random.unit() * 1.5f;
      const glm::vec3 p = center + offset;
      const glm::vec3 from_crown = glm::normalize((p - crown.center) / crown.radii + 1e-4f);
      const glm::vec3 out = glm::normalize(from_crown + 0.6f * away + glm::vec3(0, 0.25f, 0));
      // Inner and lower leaves see less sky.
      const float open = glm::smoothstep(0.35f, 1.05f, crown.depth(p) + 0.12f * away.y);
      const float height = 0.5f + 0.5f * glm::clamp(from_crown.y, -1.0f, 1.0f);
      const float light = (0.32f + 0.68f * open) * (0.62f + 0.38f * height) * tone;
      builder.paint(hue * light);
      const glm::vec3 facing = glm::normalize(out + 1.1f * random.direction());
      const float side = species.card * random.range(0.8f, 1.2f);
      add_leaf_card(builder, p, facing, out, side, random.angle());
    }
  }
}

void grow_broadleaf(MeshBuilder& builder, std::uint32_t bark, std::uint32_t leaves,
                    const TreeSpecies& species, std::uint32_t seed) {
  Random random(seed, 21);
  const float half = 0.5f * (species.height - species.crown_base);
  const Crown crown{
      {0, species.crown_base + half, 0}, {species.crown_radius, half, species.crown_radius}, seed};
  Skeleton skeleton = grow_skeleton(species, crown, random);
  thicken(skeleton, species.trunk_radius);
  builder.use(bark).paint(glm::vec3(1));
  add_branches(builder, skeleton);
  builder.shade([&](glm::vec3 p, glm::vec3) {
    const float foot = 0.55f + 0.45f * glm::smoothstep(0.0f, 0.6f, p.y);
    const float shaded =
        glm::mix(1.0f, 0.5f, glm::smoothstep(0.8f, 1.4f, p.y / species.crown_base));
    return foot * shaded;
  });
  builder.use(leaves);
  add_foliage(builder, skeleton, species, crown, random);
}

/// Adds a frond card bent along its middle: two quads, base to tip.
void add_frond(MeshBuilder& builder, glm::vec3 base, glm::vec3 along, glm::vec3 across,
               float length, float width, float bend, glm::vec3 out, glm::vec3 seen_from) {
  const glm::vec3 up = glm::normalize(glm::cross(across, along));
  const glm::vec3 side = across * (width * 0.5f);
  const std::uint32_t i = builder.vertex_count();
  for (int k = 0; k < 3; ++k) {
    const float t = static_cast<float>(k) * 0.5f;
    const glm::vec3 p = base + along * (length * t) - up * (bend * length * t * t);
    const glm::vec3 n = glm::normalize(up * 0.3f + out);
    builder.vertex(p - side, n, {0, 1 - t});
    builder.vertex(p + side, n, {1, 1 - t});
  }
  // The front is the face a walker sees; a renderer does not flip its normal.
  if (glm::dot(up, seen_from) >= 0) {
    builder.quad(i, i + 1, i + 3, i + 2);
    builder.quad(i + 2, i + 3, i + 5, i + 4);
  } else {
    builder.quad(i, i + 2, i + 3, i + 1);
    builder.quad(i + 2, i + 4, i + 5, i + 3);
  }
}

void add_conifer_branch(MeshBuilder& builder, std::uint32_t bark, std::uint32_t leaves,
                        const TreeSpecies& species, float t, Random& random) {
  const float y = glm::mix(species.crown_base, species.height * 0.985f, t);
  const float reach =
      species.crown_radius * std::pow(1 - t, 0.85f) * random.range(0.8f, 1.1f) + 0.15f;
  const float angle = random.angle();
  const glm::vec3 out(std::cos(angle), 0, std::sin(angle));
  const float sag = species.droop * (1 - 0.9f * t) - 0.35f * t;
  std::array<glm::vec3, 4> path;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const float s = static_cast<float>(i) / 3.0f;
    path[i] = {0, y - reach * sag * (1.5f * s - 0.7f * s * s), 0};
    path[i] += out * (reach * s);
  }
  const std::array<float, 4> radii = {0.012f + 0.012f * reach, 0.01f + 0.006f * reach, 0.008f, 0};
  builder.use(bark).paint(glm::vec3(0.45f));
  builder.tube(path, radii, 3);
  builder.use(leaves);
  const int count = glm::max(3, static_cast<int>(static_cast<float>(species.cards_per_tip) *
                                                 (0.35f + 0.8f * reach / species.crown_radius)));
  const float tone = random.range(0.75f, 1.0f);
  const float low = glm::smoothstep(5.0f, 1.5f, y);
  const glm::vec3 seen_from = out + glm::vec3(0, glm::mix(-0.8f, 0.9f, low), 0);
  for (int k = 0; k < count; ++k) {
    const float s =
        0.12f + 0.88f * (static_cast<float>(k) + random.unit()) / static_cast<float>(count);
    const float at = s * 2.999f;
    const auto segment = static_cast<std::size_t>(at);
    const glm::vec3 base = glm::mix(path[segment], path[segment + 1], glm::fract(at));
    const glm::vec3 along0 = glm::normalize(path[segment + 1] - path[segment]);
    const float turn = (k % 2 == 0 ? 1.0f : -1.0f) * random.range(0.15f, 1.0f) * (1.1f - 0.7f * s);
    const glm::vec3 across0 = glm::normalize(glm::cross(along0, glm::vec3(0, 1, 0)));
    const glm::vec3 along = glm::normalize(along0 * std::cos(turn) + across0 * std::sin(turn) +
                                           glm::vec3(0, random.range(-0.3f, 0.12f), 0));
    const float roll = random.range(-0.6f, 0.6f);
    const glm::vec3 flat = glm::normalize(glm::cross(along, glm::vec3(0, 1, 0)));
    const glm::vec3 across = flat * std::cos(roll) + glm::cross(along, flat) * std::sin(roll);
    const float open = glm::smoothstep(0.1f, 1.0f, s);
    const float light = (0.28f + 0.72f * open) * (0.7f + 0.3f * t) * tone;
    builder.paint(glm::vec3(random.range(0.88f, 1.05f), 1, random.range(0.85f, 1.1f)) * light);
    const float length = species.card * (0.6f + 0.5f * (1 - t)) * random.range(0.8f, 1.15f);
    add_frond(builder, base, along, across, length, length * 0.75f, 0.25f,
              glm::normalize(out + glm::vec3(0, 0.75f, 0)), seen_from);
  }
}

void grow_conifer(MeshBuilder& builder, std::uint32_t bark, std::uint32_t leaves,
                  const TreeSpecies& species, std::uint32_t seed) {
  Random random(seed, 22);
  std::vector<glm::vec3> path;
  std::vector<float> radii;
  const int steps = 22;
  for (int i = 0; i <= steps; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(steps);
    const float y = t * species.height;
    path.emplace_back(0.04f * std::sin(y), i == 0 ? -0.4f : y, 0.04f * std::cos(y * 0.8f));
    const float flare = 1 + 0.6f * glm::smoothstep(0.9f, 0.0f, y);
    radii.push_back(i == steps ? 0 : species.trunk_radius * flare * (1 - 0.93f * t));
  }
  builder.use(bark).paint(glm::vec3(1));
  builder.tube(path, radii, 12, 0.8f);
  builder.shade([&](glm::vec3 p, glm::vec3) {
    return 0.4f + 0.6f * glm::smoothstep(species.crown_base + 1.5f, species.crown_base * 0.4f, p.y);
  });
  for (int i = 0; i < species.tips; ++i) {
    // Lower branches are longer and need denser neighbours.
    const float t =
        std::pow((static_cast<float>(i) + 0.5f) / static_cast<float>(species.tips), 1.15f);
    add_conifer_branch(builder, bark, leaves, species, t, random);
  }
}

}  // namespace

void add_leaf_card(MeshBuilder& builder, glm::vec3 center, glm::vec3 facing, glm::vec3 out,
                   float side, float spin) {
  if (glm::dot(facing, out) < 0) facing = -facing;
  const glm::vec3 axis = std::abs(facing.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::vec3 a = glm::normalize(glm::cross(axis, facing));
  const glm::vec3 b = glm::cross(facing, a);
  const glm::vec3 u = (a * std::cos(spin) + b * std::sin(spin)) * (side * 0.5f);
  const glm::vec3 v = (b * std::cos(spin) - a * std::sin(spin)) * (side * 0.5f);
  const glm::vec3 n = glm::normalize(facing * 0.35f + out);
  const std::uint32_t i = builder.vertex(center - u - v, n, {0, 1});
  builder.vertex(center + u - v, n, {1, 1});
  builder.vertex(center + u + v, n, {1, 0});
  builder.vertex(center - u + v, n, {0, 0});
  builder.quad(i, i + 1, i + 2, i + 3);
}

Mesh grow_tree(SceneParts& parts, const TreeSpecies& species, std::uint32_t seed) {
  LeafStyle style;
  style.count = species.conifer ? 56 : 15;
  style.length = species.leaf_length;
  style.width = species.leaf_width;
  style.dark = species.leaf_dark;
  style.light = species.leaf_light;
  style.lobed = species.lobed;
  const std::int32_t foliage = parts.add(species.conifer ? paint_needle_frond(seed, style)
                                                         : paint_leaf_cluster(seed, style));
  const std::int32_t bark_image =
      parts.add(species.birch_bark ? paint_birch_bark(seed)
                                   : paint_bark(seed, species.bark, species.bark * 0.3f));
  const std::uint32_t bark = parts.add(textured_material(bark_image, 0.9f));
  const std::uint32_t leaves = parts.add(card_material(foliage, 1));
  MeshBuilder builder;
  if (species.conifer) {
    grow_conifer(builder, bark, leaves, species, seed);
  } else {
    grow_broadleaf(builder, bark, leaves, species, seed);
  }
  return builder.take();
}

}  // namespace mirage::builtin
