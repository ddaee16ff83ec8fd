#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "protocol/base/shard.h"
#include "protocol/model/view_place.h"

namespace mirage {

/// Box in which eyes stand, m.
struct EyeBox {
  glm::dvec3 low{0}, high{0};
  bool holds(const glm::dvec3& eye) const {
    return glm::all(glm::lessThanEqual(low, eye)) && glm::all(glm::lessThanEqual(eye, high));
  }
};

struct FreezeOptions {
  std::string scene;
  std::string out;
  double mb = 20;                 ///< most MB (10^6 bytes) of the folder
  double error_px = 1;            ///< error that each view may show
  std::optional<ViewPlace> home;  ///< nullopt: the scene's own home view
  std::optional<EyeBox> box;      ///< none: eyes stand around the scene
  int eyes = 16;  ///< of a turn around the scene; along the box's longest side: a third
  std::uint32_t width = 1280, height = 720;
  double fov_degrees = 60;
  bool geometry = true;
  std::string codec = "webp";
  std::string device = "auto";
  std::string environment, look;  ///< of the server; empty: its own choice
  Shard shard;
  bool dry_run = false;

  /// Returns all that the files depend on, as a text.
  std::string settings() const;
};

/// Fills the options. Returns an exit code if the program must end, else -1.
int parse_options(int argc, char** argv, FreezeOptions& out);

}  // namespace mirage
