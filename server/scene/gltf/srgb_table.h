#pragma once
// Conversion between sRGB codes and light (IEC 61966-2-1) by table, for whole images.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace mirage::gltf {

/// Number of steps from 0 to 1; the darkest 1/255 of sRGB is 20 of them.
inline constexpr std::size_t kLightSteps = 65536;

/// Returns the value 0..1 of each byte: the light of an sRGB code, or the plain fraction.
const std::array<float, 256>& from_byte(bool srgb);
/// Returns the byte of each of kLightSteps steps from 0 to 1.
const std::vector<std::uint8_t>& to_byte(bool srgb);

/// Returns the byte of a value, clamped to 0..1.
inline std::uint8_t byte_of(float value, const std::vector<std::uint8_t>& table) {
  const float step = value * static_cast<float>(kLightSteps - 1) + 0.5f;
  if (!(step > 0)) return table.front();
  return step >= static_cast<float>(kLightSteps) ? table.back()
                                                 : table[static_cast<std::size_t>(step)];
}

}  // namespace mirage::gltf
