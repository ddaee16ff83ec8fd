#pragma once
#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/base/shard.h"
#include "server/bake/lattice.h"
#include "server/bake/target.h"

namespace mirage {

enum class BakeFormat : std::uint8_t { kPng, kPng16, kExr };
/// How much of a bake's error is measured.
enum class MeasureChoice : std::uint8_t { kNone, kQuick, kFull };

struct BakeOptions {
  std::string scene, out;
  const TargetFacts* target = nullptr;
  BakeLayout layout = BakeLayout::kHemi;
  int grid = 0;                    ///< frames a side
  int size = 0;                    ///< texels a side of the whole picture
  int samples = 0;                 ///< of a texel each way; 0: 2, or 3 for what is alpha-tested
  std::optional<double> error_db;  ///< grid and size are chosen for this PSNR
  std::vector<std::string> objects;
  bool whole = false;
  std::vector<std::string> maps;
  BakeFormat format = BakeFormat::kPng;
  MeasureChoice measure = MeasureChoice::kQuick;
  Shard shard;  ///< of the objects
  bool dry_run = false, json = false, replace = false, strict = false;
  std::string device = "auto";
  std::string clip, variant;
  std::size_t threads = 0;  ///< 0: one per core
};

/// Reads the command line; returns an exit code when the program is to end at once, else -1.
int parse_options(int argc, char** argv, BakeOptions& options);

}  // namespace mirage
