#pragma once
// Subjects: a bake shows one, an object as it stands in the scene, or all of the scene.

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/model/scene_types.h"

namespace mirage {

struct PreparedScene;

/// A part of a subject: an object of the scene and its place, in metres. One object keeps the
/// rotation and scale of its first instance, and stands at its own origin.
struct SubjectPart {
  std::uint32_t object = 0;
  Similarity placed;
};

struct BakeSubject {
  std::string name;
  std::vector<SubjectPart> parts;
  std::uint64_t triangles = 0;
  glm::dvec3 center{0};   ///< of the box around the vertices, metres
  glm::dvec3 extent{0};   ///< edges of that box
  double radius = 0;      ///< of the sphere around that centre
  bool animated = false;  ///< shown in its first pose
  bool blended = false;   ///< has blended layers: a texel keeps their sum
};

/// The subjects that are wanted.
struct SubjectChoice {
  std::vector<std::string> names;  ///< names, numbers or globs (* and ?); empty: all objects
  bool whole = false;              ///< all instances together as one subject
  std::string whole_name = "scene";
};

/// Returns the subjects in the scene's order, each name once: a second of a name gets a number.
/// Error kUsage: a name fits nothing; the names that there are stand in the hint.
Result<std::vector<BakeSubject>> bake_subjects(const PreparedScene& scene,
                                               const SubjectChoice& choice);

/// True if `text` fits a pattern with * (anything) and ? (one character).
bool fits_glob(const std::string& pattern, const std::string& text);

}  // namespace mirage
