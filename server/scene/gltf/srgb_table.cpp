#include "server/scene/gltf/srgb_table.h"

#include <cmath>

namespace mirage::gltf {
namespace {

float light_of(float code) {
  return code <= 0.04045f ? code / 12.92f : std::pow((code + 0.055f) / 1.055f, 2.4f);
}

float code_of(float light) {
  return light <= 0.0031308f ? light * 12.92f : 1.055f * std::pow(light, 1 / 2.4f) - 0.055f;
}

using FromByte = std::array<float, 256>;
using ToByte = std::vector<std::uint8_t>;

FromByte make_from_byte(bool srgb) {
  FromByte table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const float code = static_cast<float>(i) / 255.0f;
    table[i] = srgb ? light_of(code) : code;
  }
  return table;
}

ToByte make_to_byte(bool srgb) {
  ToByte table(kLightSteps);
  for (std::size_t i = 0; i < kLightSteps; ++i) {
    const float value = static_cast<float>(i) / (kLightSteps - 1);
    table[i] = static_cast<std::uint8_t>((srgb ? code_of(value) : value) * 255.0f + 0.5f);
  }
  return table;
}

}  // namespace

const FromByte& from_byte(bool srgb) {
  static const FromByte kLight = make_from_byte(true);
  static const FromByte kPlain = make_from_byte(false);
  return srgb ? kLight : kPlain;
}

const ToByte& to_byte(bool srgb) {
  static const ToByte kCode = make_to_byte(true);
  static const ToByte kPlain = make_to_byte(false);
  return srgb ? kCode : kPlain;
}

}  // namespace mirage::gltf
