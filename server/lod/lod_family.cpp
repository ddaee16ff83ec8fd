#include "server/lod/lod_family.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "server/lod/lod_shading.h"
#include "server/scene/similarity_split.h"

namespace mirage {
namespace {

constexpr std::size_t kFewMembers = 4;         // smaller families make levels per object
constexpr std::size_t kMostIndices = 300'000;  // larger meshes use all workers, one mesh at a time
constexpr double kFlattest = 1.0 / 16;         // least stretch that can be undone
// Largest move of a vertex, relative to the base's reach, from undoing a shape (last places of
// floats times 16) and baking another.
constexpr double kRounding = 4e-6;

bool can_share(const SceneObject& object) {
  if (!object.baked || object.animation || object.mesh.indices.size() > kMostIndices) return false;
  const glm::dmat3& shape = object.baked->shape;
  return std::abs(glm::determinant(shape)) > 1e-6 &&
         longest_stretch(glm::inverse(shape)) < 1 / kFlattest;
}

double reach_of(const Mesh& mesh) {
  double reach = 0;
  for (const Vertex& v : mesh.vertices) {
    reach = std::max(reach, glm::length(glm::dvec3(v.position)));
  }
  return reach;
}

}  // namespace

struct LodFamilies::Family {
  std::size_t members = 0;
  const SceneObject* first = nullptr;
  std::once_flag once;
  double rounding = 0;        ///< object units of the base
  std::vector<MeshLod> lods;  ///< of the base
};

double longest_stretch(const glm::dmat3& shape) {
  // The norm of a matrix power is at least the power of the largest eigenvalue, and at most sqrt(3)
  // times that.
  glm::dmat3 power = glm::transpose(shape) * shape;
  constexpr int kSquarings = 6;
  for (int i = 0; i < kSquarings; ++i) power = power * power;
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += glm::dot(power[c], power[c]);
  return std::pow(sum, 0.25 / (1 << kSquarings)) * (1 + 1e-12);
}

LodFamilies::LodFamilies(const Scene& scene) : scene_(scene) {
  for (const SceneObject& object : scene.objects) {
    if (!can_share(object)) continue;
    std::shared_ptr<Family>& family = families_[object.baked->base];
    if (!family) {
      family = std::make_shared<Family>();
      family->first = &object;
    }
    ++family->members;
  }
  std::erase_if(families_, [](const auto& entry) { return entry.second->members < kFewMembers; });
}

const LodFamilies::Family* LodFamilies::family_of(const SceneObject& object) const {
  if (!can_share(object)) return nullptr;
  const auto at = families_.find(object.baked->base);
  return at == families_.end() ? nullptr : at->second.get();
}

const SceneObject* LodFamilies::first_of(const SceneObject& object) const {
  const Family* family = family_of(object);
  return family ? family->first : nullptr;
}

std::vector<MeshLod> LodFamilies::lods_of(const SceneObject& object, const Workers& workers) const {
  Family& family = *families_.at(object.baked->base);
  std::call_once(family.once, [&] {
    // This runs on one thread: a worker waiting for others could meet this family again.
    const Mesh base = bake(family.first->mesh, glm::inverse(family.first->baked->shape));
    family.rounding = kRounding * reach_of(base);
    family.lods = build_lods(base, scene_.materials, scene_.images);
  });
  const glm::dmat3& shape = object.baked->shape;
  const double stretch = longest_stretch(shape);
  MeshShading shading(object.mesh, scene_.materials, scene_.images, workers);
  std::vector<MeshLod> out;
  for (const MeshLod& lod : family.lods) {
    MeshLod& own = out.emplace_back();
    own.mesh = bake(lod.mesh, shape);
    own.error = static_cast<float>(stretch * (double{lod.error} + family.rounding) * (1 + 1e-6));
    own.spread = static_cast<float>(stretch * double{lod.spread});
    if (lod.spread > 0) continue;
    own.shading = shading.size_of(own.mesh);
  }
  return out;
}

}  // namespace mirage
