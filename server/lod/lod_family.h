#pragma once
// Levels of detail that objects of one shape share: copies of a mesh that differ by an uneven scale
// or a shear alone.

#include <map>
#include <memory>

#include "server/lod/lod.h"
#include "server/scene/scene.h"

namespace mirage {

/// The most that `shape` lengthens anything; at most 1 % more.
double longest_stretch(const glm::dmat3& shape);

/// Scenes in which many objects are baked from one mesh. Its levels are made once, before any shape
/// is baked, and a member's are those in its shape. A pure function of the scene.
class LodFamilies {
 public:
  /// Objects that move, large ones, and those so flat that their base cannot be had back are of no
  /// family. `scene` must outlive it.
  explicit LodFamilies(const Scene& scene);

  /// An object of the scene that `object` shares its levels with, maybe itself; nullptr: none.
  const SceneObject* first_of(const SceneObject& object) const;

  /// Levels of an object that has a family, as build_lods() tells of them: errors and spreads are
  /// the base's times longest_stretch(), and a rounding more; shading is measured. Any thread.
  std::vector<MeshLod> lods_of(const SceneObject& object, const Workers& workers) const;

 private:
  struct Family;
  const Family* family_of(const SceneObject& object) const;

  const Scene& scene_;
  std::map<std::uint32_t, std::shared_ptr<Family>> families_;  ///< by BakedShape::base
};

}  // namespace mirage
