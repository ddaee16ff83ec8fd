// The module libmirage_ktx2.so: decodes Basis Universal with the transcoder of the npm package
// three, whose WebAssembly wasm2c has turned into C. That code reads and writes only the memory of
// its instance, and each call has an instance of its own: a hostile file reaches nothing else, and
// no file finds what another one left. No exception leaves the module.

#include <exception>
#include <string>

#include "modules/embind_host.h"
#include "modules/ktx2_header.h"
#include "modules/ktx2_library.h"

namespace mirage {
namespace {

constexpr std::uint32_t kRgba32 = 13;      // cTFRGBA32 of the transcoder
constexpr std::uint32_t kNoChannel = ~0u;  // -1: the transcoder takes its own choice
constexpr std::uint32_t kLayer = 0, kFace = 0;

Error unreadable(std::string why) { return make_error(ErrorId::kSceneFormat, std::move(why)); }

/// State of an instance that is ready to decode. Its start takes longer than most pictures.
const EmbindImage& ready() {
  static const EmbindImage image = [] {
    EmbindHost host;
    host.call("initializeBasis");
    return host.image();
  }();
  return image;
}

/// Decodes a level of a file whose header was judged. Throws as the host does.
Result<Ktx2Pixels> transcode(EmbindHost& host, std::span<const std::uint8_t> bytes,
                             const Ktx2Header& header, std::uint32_t level) {
  const std::uint32_t file = host.call("KTX2File", host.values().add(JsSource{bytes}));
  if (!host.call("KTX2File.isValid", file) ||
      host.call("KTX2File.getWidth", file) != header.width ||
      host.call("KTX2File.getHeight", file) != header.height ||
      host.call("KTX2File.getLevels", file) != header.levels) {
    return unreadable("a KTX2 file that the Basis Universal transcoder refuses");
  }
  if (!host.call("KTX2File.startTranscoding", file)) {
    return unreadable("a KTX2 file whose Basis Universal tables are damaged");
  }
  const std::uint32_t width = header.width_of(level), height = header.height_of(level);
  Ktx2Pixels pixels{width, height, std::vector<std::uint8_t>(std::size_t{4} * width * height)};
  const std::uint32_t target = host.values().add(JsTarget{pixels.rgba});
  const std::uint32_t get_alpha_of_opaque_formats = 0;
  if (!host.call("KTX2File.transcodeImage", file, target, level, kLayer, kFace, kRgba32,
                 get_alpha_of_opaque_formats, kNoChannel, kNoChannel)) {
    return unreadable("a KTX2 file whose mip level " + std::to_string(level) + " is damaged");
  }
  return pixels;
}

Result<Ktx2Pixels> transcode(std::span<const std::uint8_t> bytes, const Ktx2Header& header,
                             std::uint32_t level) {
  EmbindHost host(ready());
  try {
    return transcode(host, bytes, header, level);
  } catch (const WasmTrap& trap) {
    if (host.reached_limit()) return unreadable("a KTX2 file that takes more than 1 GiB to decode");
    return unreadable(std::string("a KTX2 file that the Basis Universal transcoder fails on: ") +
                      trap.reason);
  }
}

/// Judges the header before the transcoder sees the file. Throws std::bad_alloc.
Result<Ktx2Pixels> judge_and_transcode(std::span<const std::uint8_t> bytes, std::uint32_t level) {
  const Result<Ktx2Header> header = read_ktx2_header(bytes);
  if (!header) return header.error();
  if (level >= header->levels) {
    return unreadable("a KTX2 file without a mip level " + std::to_string(level));
  }
  if (std::uint64_t{header->width_of(level)} * header->height_of(level) > kMaxKtx2Pixels) {
    return unreadable("a KTX2 file with more than " + std::to_string(kMaxKtx2Pixels) +
                      " pixels in its mip level " + std::to_string(level));
  }
  try {
    return transcode(bytes, *header, level);
  } catch (const WasmTrap& trap) {
    const std::string reason = trap.reason;
    return make_error(ErrorId::kInternal,
                      "the Basis Universal transcoder does not start: " + reason);
  }
}

class TranscoderLibrary final : public Ktx2Library {
 public:
  Result<Ktx2Pixels> decode(std::span<const std::uint8_t> bytes,
                            std::uint32_t level) const override {
    try {
      return judge_and_transcode(bytes, level);
    } catch (const std::exception&) {
      // Only memory runs out here. The text is short enough to need none.
      return make_error(ErrorId::kResources, "no memory");
    }
  }
};

}  // namespace
}  // namespace mirage

extern "C" __attribute__((visibility("default"))) const mirage::Ktx2Library*
mirage_ktx2_library_1() {
  static const mirage::TranscoderLibrary library;
  return &library;
}
