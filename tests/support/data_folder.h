#pragma once
// Data folder: the folder with the models and pictures that tests read.

#include <cstdlib>
#include <filesystem>

namespace mirage::test {

/// Returns $MIRAGE_SHARED, or `../shared` beside the checkout, which also has the files of the
/// sweeps (assets and assets_broken with their MANIFEST.tsv). Otherwise it is the choice in the
/// repository, with the same layout.
inline std::filesystem::path data_folder() {
  namespace fs = std::filesystem;
  if (const char* chosen = std::getenv("MIRAGE_SHARED")) return chosen;
  const fs::path beside = fs::path(MIRAGE_SOURCE_DIR) / ".." / "shared";
  return fs::is_directory(beside / "assets") ? beside : fs::path(MIRAGE_SOURCE_DIR) / "tests/data";
}

}  // namespace mirage::test
