#pragma once
// The JSON files of a bake: one for each object, and the index of the folder. They hold no times
// and no paths, so that equal bakes have equal bytes.

#include <optional>
#include <string>
#include <vector>

#include "server/bake/bake_error.h"
#include "server/bake/bake_options.h"
#include "server/bake/export.h"

namespace mirage {

struct BakedFile {
  std::string name;
  std::uint64_t bytes = 0;
  std::uint64_t hash = 0;  ///< XXH3
};

/// One object, as far as it is known when its files are written.
struct BakedObject {
  std::string name;
  std::uint64_t triangles = 0;
  glm::dvec3 extent{0};  ///< edges of the box around its vertices, metres
  BakeShot shot;
  std::vector<BakeMapFacts> maps;
  std::vector<BakedFile> files;
  std::vector<BakeErrorRow> error;
  std::vector<std::string> warnings;
};

/// Returns a hash of all that the files of a run depend on: equal hashes, equal files.
std::string run_hash(const BakeOptions& options, std::uint64_t revision);

std::string object_json(const BakedObject& object, const BakeOptions& options,
                        const std::string& run);

/// The part of an object's JSON that the index needs.
struct ObjectEntry {
  std::string run;  ///< run_hash() of the run that wrote it
  std::vector<BakedFile> files;
  std::string text;  ///< the JSON itself
};
/// Reads an object's JSON; nullopt: it is none.
std::optional<ObjectEntry> read_object_json(const std::string& text);

/// Returns the index of the objects in the scene's order. `missing`: objects that are not baked.
std::string index_json(const std::vector<ObjectEntry>& objects,
                       const std::vector<std::string>& missing, const BakeOptions& options,
                       const std::string& run);

}  // namespace mirage
