#include "server/net/picture_http.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>

#include "protocol/base/limits.h"
#include "server/tile/picture_encode.h"

namespace mirage {
namespace {

constexpr std::uint32_t kWidth = 640, kHeight = 360;  // unless the request says otherwise
constexpr std::uint32_t kMostEdge = 4096;
constexpr double kFarthest = 1e9;                  // of an eye, m
constexpr double kRadians = 0.017453292519943295;  // of a degree
constexpr double kLeastFov = 1, kMostFov = 170;    // degrees

/// Reads numbers with `between` between them. False: there are others, or something else.
template <typename T, std::size_t N>
bool read_numbers(const std::string& text, char between, std::array<T, N>& out) {
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t i = 0; i < N; ++i) {
    if (i > 0) {
      if (at == end || *at != between) return false;
      ++at;
    }
    const auto [next, error] = std::from_chars(at, end, out[i]);
    if (error != std::errc()) return false;
    at = next;
  }
  return at == end;
}

bool read_point(const std::string& text, glm::dvec3& out) {
  std::array<double, 3> p{};
  if (!read_numbers(text, ',', p)) return false;
  out = {p[0], p[1], p[2]};
  return std::abs(out.x) <= kFarthest && std::abs(out.y) <= kFarthest &&
         std::abs(out.z) <= kFarthest;
}

/// A request as it is read, value by value.
struct Reading {
  PictureRequest picture;
  std::optional<glm::dvec3> eye, look;

  /// Reads one value. Returns what is wrong with it; empty: nothing.
  std::string take(const std::string& name, const std::string& value);
  /// Reads a value that says how the picture looks, not from where it is seen.
  std::string take_look(const std::string& name, const std::string& value);
  /// Checks the values together, in the same way.
  std::string finish();
};

std::string Reading::take(const std::string& name, const std::string& value) {
  if (name == "until" || name == "signature") return "";  // grant_of() has checked them
  if (name == "eye" || name == "look") {
    glm::dvec3 point(0);
    if (!read_point(value, point)) return name + " is not three numbers up to 1e9: X,Y,Z";
    (name == "eye" ? eye : look) = point;
    return "";
  }
  if (name == "size") {
    std::array<std::uint32_t, 2> size{};
    const bool read = read_numbers(value, 'x', size) && size[0] >= 1 && size[1] >= 1 &&
                      size[0] <= kMostEdge && size[1] <= kMostEdge;
    if (!read) return fmt::format("size is not WxH, each 1 to {}", kMostEdge);
    picture.camera.width = size[0];
    picture.camera.height = size[1];
    return "";
  }
  return take_look(name, value);
}

std::string Reading::take_look(const std::string& name, const std::string& value) {
  if (name == "format") {
    const auto format = picture_format(value);
    if (picture.format == PictureFormat::kImpostor) return "an impostor has no format: it is WebP";
    if (!format || *format == PictureFormat::kImpostor) return "format is not webp, png or jpeg";
    picture.format = *format;
    return "";
  }
  if (name == "samples") {
    std::array<std::uint32_t, 1> samples{};
    const bool read = read_numbers(value, ',', samples) && samples[0] >= 1 &&
                      samples[0] <= limits::kMaxReferenceSupersample;
    if (!read) return fmt::format("samples is not 1 to {}", limits::kMaxReferenceSupersample);
    picture.samples = samples[0];
    return "";
  }
  if (name == "fov") {
    std::array<double, 1> fov{};
    const bool read = read_numbers(value, ',', fov) && fov[0] >= kLeastFov && fov[0] <= kMostFov;
    if (!read) return fmt::format("fov is not {} to {} degrees", kLeastFov, kMostFov);
    picture.camera.fov_y = fov[0] * kRadians;
    return "";
  }
  if (name == "light") {
    std::array<double, 2> sun{};
    const bool read =
        read_numbers(value, ',', sun) && std::abs(sun[0]) <= 360 && std::abs(sun[1]) <= 90;
    if (!read) return "light is not AZIMUTH,ELEVATION in degrees, up to 360 and 90";
    picture.sun = SunPlace{sun[0], sun[1]};
    return "";
  }
  return "there is no '" + name.substr(0, 40) +
         "': a picture has eye, look, size, format, samples, light and fov";
}

std::string Reading::finish() {
  if (eye.has_value() != look.has_value()) return "eye and look come together";
  const Camera& camera = picture.camera;
  if (!limits::reference_within_limits(camera.width, camera.height, picture.samples)) {
    return "so many samples of so many pixels are too much: ask for a smaller size, or fewer "
           "samples";
  }
  if (!eye) return "";
  if (!(glm::length(*look - *eye) > 0)) return "look is where the eye is";
  picture.camera.pose = look_at(*eye, *look);
  picture.posed = true;
  return "";
}

std::string caching(const std::string& tag, bool open) {
  std::string out = fmt::format("ETag: {}\r\nCache-Control: {}, max-age=60\r\n", tag,
                                open ? "public" : "private");
  if (open) {
    out += "Access-Control-Allow-Origin: *\r\nCross-Origin-Resource-Policy: cross-origin\r\n";
  }
  return out;
}

}  // namespace

std::variant<PictureRequest, HttpAnswer> read_picture_request(const HttpRequest& request,
                                                              const Access& access,
                                                              std::int64_t now_s) {
  const Result<Grant> grant = grant_of(request, request.path, access, now_s);
  if (!grant) return refusal(401, grant.error().text, "WWW-Authenticate: Bearer\r\n");
  Reading reading;
  reading.picture.camera.fov_y = 60 * kRadians;
  reading.picture.camera.width = kWidth;
  reading.picture.camera.height = kHeight;
  if (request.path == kImpostorPath) reading.picture.format = PictureFormat::kImpostor;
  std::string wrong;
  for (const auto& [name, value] : query_values(request.query)) {
    if (wrong.empty()) wrong = reading.take(name, value);
  }
  if (wrong.empty()) wrong = reading.finish();
  if (!wrong.empty()) return refusal(400, wrong);
  return reading.picture;
}

// The hash is FNV-1a (G. Fowler, L. C. Noll, K.-P. Vo), which is the same on every machine.
std::string picture_tag(const PictureRequest& picture, std::uint64_t revision) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : picture.key()) {
    hash = (hash ^ static_cast<std::uint8_t>(c)) * 0x100000001b3;
  }
  return fmt::format("\"{:016x}-{:016x}\"", revision, hash);
}

HttpAnswer picture_answer(const GotPicture& got, PictureFormat format, const std::string& tag,
                          bool open) {
  switch (got.reason) {
    case wire::RefusalReason::None:
      break;
    case wire::RefusalReason::Busy:
      return busy();
    case wire::RefusalReason::NoReference:
      return refusal(403, "this server draws full renders for nobody (--no-reference)");
    default:
      return refusal(500, "this picture could not be made; the server's log says why");
  }
  return {200, media_type(format), caching(tag, open),
          std::string(got.file->begin(), got.file->end())};
}

HttpAnswer picture_unchanged(const std::string& tag, bool open) {
  return {304, "text/plain", caching(tag, open), ""};
}

}  // namespace mirage
