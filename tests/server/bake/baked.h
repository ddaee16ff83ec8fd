#pragma once
// Bakes of the arrows for a target, as its consumer loads them.

#include <string>

#include "server/bake/export.h"
#include "tests/server/bake/consumers.h"

namespace mirage {

struct Baked {
  BakeMaster master;
  BakeExport files;
  consumer::Pictures pictures;  ///< a .boimp: "word 0" and "word 1" of whole frames
};
/// Bakes and loads; a failure ends the test.
Baked baked_arrows(const std::string& target, BakeLayout layout, int grid, int tile);

struct Boimp {
  std::string settings;
  std::vector<std::string> names;  ///< of the archive's entries
  consumer::Pictures words;
};
/// Reads a .boimp by what its loader does.
Boimp read_boimp(const std::vector<std::uint8_t>& bytes);

}  // namespace mirage
