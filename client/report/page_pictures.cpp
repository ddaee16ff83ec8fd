// The pictures of the report's page: drawn over true with a slider, and a map of FLIP.

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "client/report/page.h"
#include "modules/image_library.h"
#include "protocol/quality/flip.h"

namespace mirage {
namespace {

Result<std::string> data_uri(int width, int height, const std::vector<std::uint8_t>& rgba) {
  const Result<const ImageLibrary*> library = image_library();
  if (!library) return library.error();
  std::vector<std::uint8_t> rgb;
  rgb.reserve(rgba.size() / 4 * 3);
  for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
    rgb.insert(rgb.end(), &rgba[i], &rgba[i] + 3);
  }
  const Result<std::vector<std::uint8_t>> file =
      (*library)->encode("x.jpg", {width, height, 3, rgb.data()}, "jpeg:93");
  if (!file) return make_error(ErrorId::kIo, "cannot encode a picture: " + file.error().text);
  return "data:image/jpeg;base64," + base64(*file);
}

/// FLIP of each pixel as RGBA8; grey where it cannot be told.
std::vector<std::uint8_t> heat_map_of(const Picture& p) {
  const auto w = static_cast<std::uint32_t>(p.width), h = static_cast<std::uint32_t>(p.height);
  const std::optional<FlipMap> map = flip_map({w, h, p.truth.data()}, {w, h, p.drawn.data()});
  return map ? heat_map(*map) : std::vector<std::uint8_t>(p.drawn.size(), 128);
}

}  // namespace

std::string base64(const std::vector<std::uint8_t>& bytes) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < n ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= n ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

Result<void> Page::pictures(const std::string& caption, const Picture& picture) {
  const Result<std::string> drawn = data_uri(picture.width, picture.height, picture.drawn);
  if (!drawn) return drawn.error();
  const Result<std::string> truth = data_uri(picture.width, picture.height, picture.truth);
  if (!truth) return truth.error();
  const Result<std::string> heat = data_uri(picture.width, picture.height, heat_map_of(picture));
  if (!heat) return heat.error();
  const std::string name = escape_html(caption);
  current().body += fmt::format(
      "<figure><div class=\"look\"><div class=\"pair\">"
      "<img loading=\"lazy\" width=\"{5}\" height=\"{6}\" alt=\"{0}: full render\" src=\"{2}\">"
      "<img loading=\"lazy\" width=\"{5}\" height=\"{6}\" class=\"drawn\" alt=\"{0}: as drawn\" "
      "src=\"{1}\">"
      "<span class=\"tag left\">drawn</span><span class=\"tag right\">full render</span>"
      "<input type=\"range\" min=\"0\" max=\"100\" value=\"50\" aria-label=\"border between the "
      "drawn and the true picture\"><span class=\"focus\"></span></div>"
      "<div class=\"heat\"><img loading=\"lazy\" width=\"{5}\" height=\"{6}\" alt=\"{0}: FLIP of "
      "each pixel\" src=\"{3}\">"
      "<div class=\"scale\"></div><div class=\"ends\"><span>FLIP 0</span><span>{4:g} and "
      "more</span></div></div></div><figcaption>{0} Drag in the left picture: drawn | full "
      "render.</figcaption></figure>\n",
      name, *drawn, *truth, *heat, kMostFlip, picture.width, picture.height);
  return {};
}

Result<void> Page::strip(const std::string& caption,
                         const std::vector<std::pair<std::string, Picture>>& pictures) {
  std::string columns;
  for (const auto& [label, picture] : pictures) {
    const Result<std::string> drawn = data_uri(picture.width, picture.height, picture.drawn);
    if (!drawn) return drawn.error();
    const Result<std::string> truth = data_uri(picture.width, picture.height, picture.truth);
    if (!truth) return truth.error();
    const std::string name = escape_html(label);
    columns += fmt::format(
        "<div>{0}<img alt=\"{0}, as drawn\" src=\"{1}\"><img alt=\"{0}, full render\" "
        "src=\"{2}\"></div>",
        name, *drawn, *truth);
  }
  current().body += "<figure><div class=\"strip\">" + columns + "</div><figcaption>" +
                    escape_html(caption) + "</figcaption></figure>\n";
  return {};
}

}  // namespace mirage
