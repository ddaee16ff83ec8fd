#pragma once

#include <cstddef>
#include <string>

namespace mirage {

struct RenderOptions {
  std::string device = "auto";
  int page_edge = 512;        ///< texels; larger pages suit a GPU
  int supersample = 2;        ///< per axis
  std::size_t ring = 2;       ///< pages in flight between drawing and read-back
  std::size_t gpu_mb = 4096;  ///< limit of graphics memory for the scene, targets and the ring, MiB
  double stand_in_ms = 0;     ///< if set, nothing is drawn, and each tile sleeps this long
  bool shadows = false;       ///< sun shadows in reference frames and shadow tiles
};

}  // namespace mirage
