#pragma once
// Light script: lighting over time: fixed, a sweeping sun, a toggled lamp, or from a file.

#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/model/scene_types.h"

namespace mirage {

class LightScript {
 public:
  /// Creates a script from `spec`: builtin:fixed|sun-sweep|lamp-toggle, or a file of lines `t_ms ar
  /// ag ab sr sg sb dx dy dz` (ambient, sun colour, direction the light travels). Errors: kUsage,
  /// kIo.
  static Result<LightScript> create(const std::string& spec);

  /// Returns the lighting at a time; nullopt: the scene's own, unchanged.
  std::optional<Lighting> at(double seconds, const Lighting& scene) const;
  /// True if the lighting is always the scene's own.
  bool fixed() const { return kind_ == Kind::kFixed; }

 private:
  enum class Kind { kFixed, kSunSweep, kLampToggle, kFile };
  struct Key {
    double seconds;
    Lighting lighting;
  };
  Kind kind_ = Kind::kFixed;
  std::vector<Key> keys_;
};

}  // namespace mirage
