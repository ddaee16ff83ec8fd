#include "client/report/alpha_tested.h"

#include <cstring>
#include <nlohmann/json.hpp>

namespace mirage {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kHeader = 12, kChunkHeader = 8;
constexpr std::uint32_t kMagic = 0x46546c67, kJson = 0x4e4f534a;  // "glTF", "JSON"

std::uint32_t word(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, &bytes[at], 4);
  return value;
}

void put_word(std::vector<std::uint8_t>& bytes, std::uint32_t value) {
  const std::size_t at = bytes.size();
  bytes.resize(at + 4);
  std::memcpy(&bytes[at], &value, 4);
}

}  // namespace

Result<std::vector<std::uint8_t>> alpha_tested(const std::vector<std::uint8_t>& glb) {
  const Error bad = make_error(ErrorId::kSceneFormat, "not a GLB file");
  if (glb.size() < kHeader + kChunkHeader || word(glb, 0) != kMagic) return bad;
  const std::size_t length = word(glb, kHeader);
  if (word(glb, kHeader + 4) != kJson || length > glb.size() - kHeader - kChunkHeader) return bad;
  const auto first = glb.begin() + static_cast<std::ptrdiff_t>(kHeader + kChunkHeader);
  const auto last = first + static_cast<std::ptrdiff_t>(length);
  ordered_json scene = ordered_json::parse(first, last, nullptr, false);
  if (!scene.is_object()) return bad;
  if (const auto materials = scene.find("materials"); materials != scene.end()) {
    for (ordered_json& material : *materials) {
      if (!material.is_object() || material.value("alphaMode", "") != "BLEND") continue;
      material["alphaMode"] = "MASK";
      material["alphaCutoff"] = 0.5;
    }
  }
  std::string text = scene.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::vector<std::uint8_t> out;
  put_word(out, kMagic);
  put_word(out, word(glb, 4));
  put_word(out, static_cast<std::uint32_t>(glb.size() - length + text.size()));
  put_word(out, static_cast<std::uint32_t>(text.size()));
  put_word(out, kJson);
  out.insert(out.end(), text.begin(), text.end());
  out.insert(out.end(), last, glb.end());
  return out;
}

}  // namespace mirage
