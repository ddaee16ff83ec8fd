// The module libmirage_images.so: the image library on OpenImageIO. No exception leaves it.

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cstring>
#include <mutex>
#include <utility>

#include "modules/image_library.h"

namespace mirage {
namespace {

Error failed(std::string why) { return make_error(ErrorId::kIo, std::move(why)); }

/// Runs `work`, which returns a Result, and turns an exception into an error.
template <typename Work>
auto guarded(const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::exception& exception) {
    return failed(exception.what());
  }
}

/// OpenImageIO 2.4.7 reads colour profiles and other metadata into memory that its threads share
/// (its issue 3756): of two files opened at once, one server in twenty crashed. Pixels are read
/// without this lock.
std::mutex& opening() {
  static std::mutex mutex;
  return mutex;
}

class OiioReader final : public ImageReader {
 public:
  OiioReader() = default;
  explicit OiioReader(std::span<const std::uint8_t> bytes)
      : memory_(bytes.data(), bytes.size()), proxy_(&memory_) {}
  ~OiioReader() override {
    if (!input_) return;
    (void)input_->geterror();  // OpenImageIO prints a message that nobody has fetched
    input_->close();
  }

  Result<void> open(const std::string& name) {
    OIIO::ImageSpec config;
    if (proxy_) {
      config["oiio:UnassociatedAlpha"] = 1;
      config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, static_cast<const void*>(&proxy_));
    }
    {
      const std::lock_guard<std::mutex> alone(opening());
      input_ = OIIO::ImageInput::open(name, proxy_ ? &config : nullptr, proxy_);
    }
    if (!input_) return failed(OIIO::geterror());
    const OIIO::ImageSpec& spec = input_->spec();
    x_ = spec.x;
    y_ = spec.y;
    shape_ = {spec.width,     spec.height,     spec.depth,
              spec.nchannels, spec.tile_width, spec.tile_height};
    return {};
  }

  const ImageShape& shape() const override { return shape_; }
  Result<void> read_rows(int begin, int end, int channels, std::uint8_t* out) override {
    return read(begin, end, channels, OIIO::TypeDesc::UINT8, out);
  }
  Result<void> read_rows(int begin, int end, int channels, float* out) override {
    return read(begin, end, channels, OIIO::TypeDesc::FLOAT, out);
  }

 private:
  Result<void> read(int begin, int end, int channels, OIIO::TypeDesc type, void* out) {
    return guarded([&]() -> Result<void> {
      const int first = y_ + begin, last = y_ + end;
      const OIIO::ImageSpec& spec = input_->spec();
      if (shape_.tile_width > 0) {
        const bool read = input_->read_tiles(0, 0, x_, x_ + shape_.width, first, last, 0, 1, 0,
                                             channels, type, out);
        return read ? Result<void>{} : failed(input_->geterror());
      }
      // OpenImageIO converts in a buffer of 16 MB, even for two pixels. Pixels that need no
      // conversion go straight to `out`.
      const bool as_is =
          channels == spec.nchannels && spec.format == type && spec.channelformats.empty();
      const bool read = input_->read_scanlines(0, 0, first, last, 0, 0, channels,
                                               as_is ? OIIO::TypeDesc::UNKNOWN : type, out);
      if (!read) return failed(input_->geterror());
      return {};
    });
  }

  OIIO::Filesystem::IOMemReader memory_{nullptr, 0};
  OIIO::Filesystem::IOProxy* proxy_ = nullptr;  // null: the image is in a file
  std::unique_ptr<OIIO::ImageInput> input_;
  int x_ = 0, y_ = 0;  // first pixel of the file's data window
  ImageShape shape_;
};

ImageLibrary::Opened opened(std::unique_ptr<OiioReader> reader, const std::string& name) {
  return guarded([&]() -> ImageLibrary::Opened {
    if (const Result<void> open = reader->open(name); !open) return open.error();
    return std::unique_ptr<ImageReader>(std::move(reader));
  });
}

constexpr const char* kPngLevel = "png:";

/// Writes to `proxy`, or to the file `name` if it is null.
Result<void> write(const std::string& name, OIIO::Filesystem::IOProxy* proxy, OIIO::ImageSpec spec,
                   const std::string& compression, const void* pixels) {
  return guarded([&]() -> Result<void> {
    const auto output = OIIO::ImageOutput::create(name, proxy);
    if (!output) return failed(OIIO::geterror());
    if (compression.rfind(kPngLevel, 0) == 0) {
      spec.attribute("png:compressionLevel", compression[std::strlen(kPngLevel)] - '0');
    } else if (!compression.empty()) {
      spec.attribute("Compression", compression);
    }
    spec["oiio:UnassociatedAlpha"] = 1;  // otherwise colours are divided by the fourth channel
    if (output->open(name, spec) && output->write_image(spec.format, pixels) && output->close()) {
      return {};
    }
    return failed(output->geterror());
  });
}

using Bytes = std::vector<std::uint8_t>;

class OiioLibrary final : public ImageLibrary {
 public:
  OiioLibrary() {
    // The file name decides the format. A failing file is not handed to the readers of others.
    OIIO::attribute("try_all_readers", 0);
  }
  Opened open_bytes(std::span<const std::uint8_t> bytes, const std::string& name) const override {
    return opened(std::make_unique<OiioReader>(bytes), name);
  }
  Opened open_file(const std::string& path) const override {
    return opened(std::make_unique<OiioReader>(), path);
  }
  Result<void> write_file(const std::string& path,
                          const ImagePixels<std::uint8_t>& image) const override {
    return write(path, nullptr, {image.width, image.height, image.channels, OIIO::TypeDesc::UINT8},
                 {}, image.data);
  }
  Result<void> write_file(const std::string& path, const ImagePixels<float>& image) const override {
    return write(path, nullptr, {image.width, image.height, image.channels, OIIO::TypeDesc::FLOAT},
                 {}, image.data);
  }
  Result<Bytes> encode(const std::string& name, const ImagePixels<std::uint8_t>& image,
                       const std::string& compression) const override {
    return encoded(name, image, OIIO::TypeDesc::UINT8, compression);
  }
  Result<Bytes> encode(const std::string& name, const ImagePixels<std::uint16_t>& image,
                       const std::string& compression) const override {
    return encoded(name, image, OIIO::TypeDesc::UINT16, compression);
  }
  Result<Bytes> encode(const std::string& name, const ImagePixels<float>& image,
                       const std::string& compression) const override {
    return encoded(name, image, OIIO::TypeDesc::FLOAT, compression);
  }

 private:
  template <typename T>
  static Result<Bytes> encoded(const std::string& name, const ImagePixels<T>& image,
                               OIIO::TypeDesc type, const std::string& compression) {
    OIIO::ImageSpec spec(image.width, image.height, image.channels, type);
    Bytes bytes;
    OIIO::Filesystem::IOVecOutput proxy(bytes);
    const Result<void> written = write(name, &proxy, std::move(spec), compression, image.data);
    if (!written) return written.error();
    return bytes;
  }
};

}  // namespace
}  // namespace mirage

extern "C" __attribute__((visibility("default"))) const mirage::ImageLibrary*
mirage_image_library_2() {
  static const mirage::OiioLibrary library;
  return &library;
}
