#include "server/scene/builtin/sculpture.h"

#include <algorithm>
#include <limits>

#include "server/scene/builtin/random.h"
#include "server/scene/builtin/sculpture_forms.h"

namespace mirage::builtin {
namespace {

constexpr float kMaxRadius = 0.72f;  // metres about the axis that a plinth can hold
constexpr float kSunk = 0.004f;      // metres into the plinth, so that no gap shows

/// Scales the mesh to its height, or less if it would be too wide, and puts it on the ground.
float stand(Mesh& mesh, float height) {
  glm::vec3 low(std::numeric_limits<float>::max()), high = -low;
  for (const Vertex& v : mesh.vertices) {
    low = glm::min(low, v.position);
    high = glm::max(high, v.position);
  }
  const glm::vec3 middle = 0.5f * (low + high);
  float wide = 0;
  for (const Vertex& v : mesh.vertices) {
    wide = std::max(wide, glm::length(glm::vec2(v.position.x - middle.x, v.position.z - middle.z)));
  }
  const float scale = std::min(height / (high.y - low.y), kMaxRadius / wide);
  for (Vertex& v : mesh.vertices) {
    v.position = (v.position - glm::vec3(middle.x, low.y, middle.z)) * scale;
    v.position.y -= kSunk;
  }
  return (high.y - low.y) * scale;
}

std::uint32_t texture_side(std::size_t triangles, Random& random) {
  if (triangles < 50'000) return 256;
  if (triangles < 250'000) return 512;
  return random.chance(0.4f) ? 1024 : 512;
}

}  // namespace

Sculpture make_sculpture(std::uint32_t seed, std::uint32_t number, std::size_t triangles) {
  Random random(seed, 1000 + number);
  const auto own_seed = static_cast<std::uint32_t>(random.bits());
  const SculptureKind& kind = kSculptureKinds[number % kSculptureKinds.size()];
  const SculptureShape shape = kind.shape(own_seed);
  Sculpture out;
  out.name = std::string(kind.name) + " " + std::to_string(number + 1);
  out.mesh = std::visit([&](const auto& s) { return mesh_of(s, triangles); }, shape);
  out.height = stand(out.mesh, kind.height_m * random.range(0.85f, 1.15f));
  // 5 is coprime to the number of kinds, so a kind comes in every finish.
  const std::uint32_t finish = (number * 5 + number / 12 + seed % kFinishKinds) % kFinishKinds;
  const std::uint32_t side = texture_side(triangles, random);
  out.finish = paint_finish(finish, own_seed + 1, side, std::holds_alternative<GridSurface>(shape));
  return out;
}

}  // namespace mirage::builtin
