#include <turbojpeg.h>

#include <memory>

#include "protocol/color_codec.h"

namespace mirage {
namespace {

constexpr int kQuality = 85;

struct Close {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using Handle = std::unique_ptr<void, Close>;

}  // namespace

ColorBytes encode_jpeg_colors(const ColorBytes& colors, std::uint32_t w, std::uint32_t h) {
  static thread_local const Handle handle(tjInitCompress());
  const int width = static_cast<int>(w), height = static_cast<int>(h);
  ColorBytes out(tjBufSize(width, height, TJSAMP_444));
  unsigned char* to = out.data();
  unsigned long bytes = out.size();
  const int failed =
      tjCompress2(handle.get(), colors.data(), width, width * 4, height, TJPF_RGBX, &to, &bytes,
                  TJSAMP_444, kQuality, TJFLAG_NOREALLOC | TJFLAG_ACCURATEDCT);
  out.resize(failed ? 0 : bytes);
  return out;
}

Result<ColorBytes> decode_jpeg_colors(const std::uint8_t* bytes, std::size_t size, std::uint32_t w,
                                      std::uint32_t h) {
  static thread_local const Handle handle(tjInitDecompress());
  int width = 0, height = 0, subsampling = 0, space = 0;
  const int failed =
      tjDecompressHeader3(handle.get(), bytes, size, &width, &height, &subsampling, &space);
  if (failed || width != static_cast<int>(w) || height != static_cast<int>(h)) {
    return make_error(ErrorId::kCodec, "JPEG colours are not of the size of their tile");
  }
  ColorBytes out(std::size_t{w} * h * 4);
  // One hash of what is decoded must hold for all: the exact transform, and no progressive scans,
  // of which a few bytes can ask for many.
  if (tjDecompress2(handle.get(), bytes, size, out.data(), width, width * 4, height, TJPF_RGBX,
                    TJFLAG_ACCURATEDCT | TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS) != 0) {
    return make_error(ErrorId::kCodec, "JPEG colours are damaged");
  }
  return out;
}

}  // namespace mirage
