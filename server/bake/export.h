#pragma once
// Exports a bake: turns the neutral form into the files that one consumer reads.
// Input: a capture rolled as the target needs it. Output: pictures, texts and binary files in
// memory. Thread: any. Nothing is written to disk here.

#include <cstdint>
#include <string>
#include <vector>

#include "server/bake/master.h"
#include "server/bake/target.h"

namespace mirage {

/// A picture, row by row from the top, channels interleaved. Values 0 to 1; a writer multiplies
/// them by 255 or 65535 and rounds. If `srgb`, red, green and blue already follow the sRGB curve.
struct BakeImage {
  std::string file;  ///< may have one folder in front: "oak/result_albedo.png"
  std::string map;
  int width = 0, height = 0, channels = 0;
  bool srgb = false;
  std::vector<float> texels;
};

struct BakeText {
  std::string file, text;
};

struct BakeBinary {
  std::string file;
  std::vector<std::uint8_t> bytes;
};

/// A file's contents, as a reader has to know them; for the bake's JSON.
struct BakeMapFacts {
  std::string map{}, file{};
  std::string color_space{};            ///< "srgb" or "linear"
  bool premultiplied = false;           ///< colours carry the coverage as a factor
  std::vector<std::string> channels{};  ///< a formula each, such as "n.x * .5 + .5"
  std::string depth{};  ///< how to get s, the height above the centre plane; may be empty
  std::vector<float> background{};  ///< where neither object nor filling is, per channel
  int filled = 0;                   ///< texels around the object that repeat its nearest texel
};

struct ExportChoice {
  std::string object{};             ///< any name; files get file_name_of() of it
  std::vector<std::string> maps{};  ///< color, normal, depth, orm; empty: all that the target reads
  bool linear = false;              ///< colours stay linear, for formats that hold floats
};

struct BakeExport {
  std::vector<BakeImage> images;
  std::vector<BakeText> texts;
  std::vector<BakeBinary> binaries;
  std::vector<BakeMapFacts> maps;
};

/// Returns a name of at most 64 letters, digits, - and _, for files and for quoting in any
/// language. An empty name becomes "object".
std::string file_name_of(const std::string& object);

/// Errors kUsage: the target does not read such a bake (check_target) or has no such map; the
/// capture is rolled differently. kModule, kIo: a picture inside a .boimp could not be made.
Result<BakeExport> export_bake(const BakeMaster& master, const TargetFacts& target,
                               const ExportChoice& choice);

}  // namespace mirage
