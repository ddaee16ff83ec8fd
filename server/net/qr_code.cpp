#include "server/net/qr_code.h"

#ifdef MIRAGE_QRENCODE
#include <qrencode.h>

#include <memory>
#endif

namespace mirage {

#ifdef MIRAGE_QRENCODE
namespace {

constexpr int kBorder = 2;  // modules; the standard's four would make it a third larger
// A character's upper and lower half, each light or dark.
constexpr const char* kHalves[2][2] = {{"█", "▀"}, {"▄", " "}};

}  // namespace

std::string qr_code(const std::string& text) {
  const std::unique_ptr<QRcode, void (*)(QRcode*)> code(
      QRcode_encodeString8bit(text.c_str(), 0, QR_ECLEVEL_L), QRcode_free);
  if (!code) return {};
  const int edge = code->width;
  const auto dark = [&](int x, int y) {
    const bool inside = x >= 0 && y >= 0 && x < edge && y < edge;
    return inside && (code->data[y * edge + x] & 1) != 0;
  };
  std::string out;
  for (int y = -kBorder; y < edge + kBorder; y += 2) {
    for (int x = -kBorder; x < edge + kBorder; ++x) out += kHalves[dark(x, y)][dark(x, y + 1)];
    out += '\n';
  }
  return out;
}
#else
std::string qr_code(const std::string&) { return {}; }
#endif

}  // namespace mirage
