#pragma once
// Levels of detail shared by objects of one shape: copies of a mesh that differ only by an uneven
// scale or a shear.

#include <map>
#include <memory>

#include "server/lod/lod.h"
#include "server/scene/scene.h"

namespace mirage {

/// Returns the largest factor by which `shape` lengthens anything, at most 1 % too high.
double longest_stretch(const glm::dmat3& shape);

/// Families of objects that are baked from one mesh. The levels of the base mesh are made once;
/// those of a member are these in its shape. A pure function of the scene.
class LodFamilies {
 public:
  /// Objects that move, large ones, and those too flat for undoing their shape have no family.
  /// `scene` must outlive this object.
  explicit LodFamilies(const Scene& scene);

  /// Returns the object with which `object` shares its levels, maybe itself; nullptr: none.
  const SceneObject* first_of(const SceneObject& object) const;

  /// Returns the levels of an object that has a family, in the form of build_lods(). Errors and
  /// spreads are those of the base times longest_stretch(), plus rounding; shading is measured. Any
  /// thread.
  std::vector<MeshLod> lods_of(const SceneObject& object, const Workers& workers) const;

 private:
  struct Family;
  const Family* family_of(const SceneObject& object) const;

  const Scene& scene_;
  std::map<std::uint32_t, std::shared_ptr<Family>> families_;  ///< by BakedShape::base
};

}  // namespace mirage
