#pragma once
// Where the models and pictures are that tests read.

#include <cstdlib>
#include <filesystem>

namespace mirage::test {

/// $MIRAGE_SHARED, or `../shared` beside the checkout, which also has what is swept over (assets
/// and assets_broken with their MANIFEST.tsv); else the choice in the repository, alike within.
inline std::filesystem::path data_folder() {
  namespace fs = std::filesystem;
  if (const char* chosen = std::getenv("MIRAGE_SHARED")) return chosen;
  const fs::path beside = fs::path(MIRAGE_SOURCE_DIR) / ".." / "shared";
  return fs::is_directory(beside / "assets") ? beside : fs::path(MIRAGE_SOURCE_DIR) / "tests/data";
}

}  // namespace mirage::test
