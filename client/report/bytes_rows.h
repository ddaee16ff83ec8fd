#pragma once
// Walks by several deliveries of a scene, and the table of the bytes that each takes.

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "client/link/net_model.h"
#include "client/report/table.h"

namespace mirage {

/// A delivery: a way to bring a scene to the client.
struct Delivery {
  std::string name, method;
  double mesh_radii, frame_ms;
};

struct BytesPlan {
  std::vector<std::string> scenes;
  std::vector<Delivery> deliveries;
  /// lengths of the walks, rising; each walk begins with the shorter one
  std::vector<int> walks_s;
  int width, height;
  double fps;
  NetModel net;
};
BytesPlan bytes_plan(bool quick);
/// Returns the seconds of a walk of this length at which pictures are compared.
std::vector<int> compared_seconds(int walk_s);

/// One walk of a scene by one delivery. NaN: not measured.
struct BytesRun {
  std::string scene, delivery;
  int walk_s = 0;
  double mb = 0;  ///< received, 10^6 bytes
  double flip_mean = NAN, flip_after_5s = NAN;
  double first_picture_ms = NAN;
  double client_ms_p50 = NAN, client_ms_p95 = NAN;  ///< by the device model
};

/// A run of Mirage beside the cheaper of the two deliveries "all geometry" and "tiles only".
struct BytesBeside {
  /// `better` is nullptr if neither of the two shows as good a picture
  const BytesRun *mirage, *better;
};
/// Returns a comparison for each run of Mirage itself, in the order of the runs.
std::vector<BytesBeside> bytes_beside(const std::vector<BytesRun>& runs);

Table bytes_table(const std::vector<BytesRun>& runs);
/// Returns a sentence for each comparison.
std::vector<std::string> bytes_words(const std::vector<BytesRun>& runs);

}  // namespace mirage
