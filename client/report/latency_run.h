#pragma once
// Latency run: what one method showed of one path over one link.

#include <string>
#include <vector>

#include "client/link/net_model.h"
#include "client/report/page.h"

namespace mirage {

/// A link and a path under which all methods are run.
struct Condition {
  std::string path;  ///< empty: the scene's own (OpenScene::path), used by the plots
  NetModel net;
};

struct LatencySample {
  double seconds = 0, flip = 0, pose_to_display_ms = 0, hole_fraction = 0;
};

struct LatencyRun {
  std::string scene, method;
  Condition condition;
  bool own_path = true;
  std::vector<LatencySample> samples;
  double mbps = 0, first_image_ms = -1;
  std::vector<Picture> pictures;  ///< of RunSpec::pictured; none for video
};

}  // namespace mirage
