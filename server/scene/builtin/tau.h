#pragma once
// A full turn in radians, as the builders of shapes count angles.

namespace mirage::builtin {
inline constexpr float kTau = 6.28318530718f;
}  // namespace mirage::builtin
