#pragma once
// Image library: reads and writes image files with OpenImageIO, which the module
// libmirage_images.so holds. A program that opens no image never loads it.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

struct ImageShape {
  int width = 0, height = 0, depth = 1, channels = 0;
  int tile_width = 0, tile_height = 0;  ///< 0: the file holds rows, not tiles
};

/// Pixels to be written as they are, row by row from the top, channels interleaved. T:
/// std::uint8_t, std::uint16_t or float.
template <typename T>
struct ImagePixels {
  int width = 0, height = 0, channels = 0;
  const T* data = nullptr;
};

/// An opened image. One thread at a time.
class ImageReader {
 public:
  virtual ~ImageReader() = default;
  virtual const ImageShape& shape() const = 0;
  /// Reads the first `channels` channels of the rows from `begin` to before `end`, counted from
  /// the top. If the file holds tiles, `begin` is the first row of a tile. Error kIo: OpenImageIO's
  /// reason.
  virtual Result<void> read_rows(int begin, int end, int channels, std::uint8_t* out) = 0;
  virtual Result<void> read_rows(int begin, int end, int channels, float* out) = 0;
};

/// All its functions may be called from any thread. The ending of `name` or `path` tells the
/// format; no other is tried. Errors kIo: OpenImageIO's reason.
class ImageLibrary {
 public:
  using Opened = Result<std::unique_ptr<ImageReader>>;
  /// Opens an image in memory. The bytes outlive the reader. Alpha stays unassociated.
  virtual Opened open_bytes(std::span<const std::uint8_t> bytes, const std::string& name) const = 0;
  virtual Opened open_file(const std::string& path) const = 0;
  virtual Result<void> write_file(const std::string& path,
                                  const ImagePixels<std::uint8_t>& image) const = 0;
  virtual Result<void> write_file(const std::string& path,
                                  const ImagePixels<float>& image) const = 0;
  /// Returns the bytes of a file. `compression` as OpenImageIO names it, such as "jpeg:93", or
  /// "png:1" to "png:9", from fast to small.
  virtual Result<std::vector<std::uint8_t>> encode(const std::string& name,
                                                   const ImagePixels<std::uint8_t>& image,
                                                   const std::string& compression) const = 0;
  virtual Result<std::vector<std::uint8_t>> encode(const std::string& name,
                                                   const ImagePixels<std::uint16_t>& image,
                                                   const std::string& compression) const = 0;
  virtual Result<std::vector<std::uint8_t>> encode(const std::string& name,
                                                   const ImagePixels<float>& image,
                                                   const std::string& compression) const = 0;

 protected:
  ~ImageLibrary() = default;
};

/// Name and type of the module's only function. Its number grows with each change of the classes
/// above, so that a module of another build is refused.
inline constexpr const char* kImageLibraryEntry = "mirage_image_library_2";
using ImageLibraryEntry = const ImageLibrary* (*)();

/// Returns the library; the first call loads it. Error kModule. Any thread.
Result<const ImageLibrary*> image_library();

}  // namespace mirage
