#pragma once
// Walks by several ways to bring a scene to the client, and the table of what they cost in bytes.

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "client/link/net_model.h"
#include "client/report/table.h"

namespace mirage {

/// A way to bring a scene to the client.
struct Delivery {
  std::string name, method;
  double mesh_radii, frame_ms;
};

struct BytesPlan {
  std::vector<std::string> scenes;
  std::vector<Delivery> deliveries;
  std::vector<int> walks_s;  ///< rising; each the beginning of the next
  int width, height;
  double fps;
  NetModel net;
};
BytesPlan bytes_plan(bool quick);
/// Of a walk that long, the seconds whose pictures are compared.
std::vector<int> compared_seconds(int walk_s);

/// A walk of a scene by one way. Not a number: not measured.
struct BytesRun {
  std::string scene, delivery;
  int walk_s = 0;
  double mb = 0;  ///< down, 10^6 bytes
  double flip_mean = NAN, flip_after_5s = NAN;
  double first_picture_ms = NAN;
  double client_ms_p50 = NAN, client_ms_p95 = NAN;  ///< by the device model
};

/// Mirage beside what takes fewer bytes of all geometry and tiles only.
struct BytesBeside {
  const BytesRun *mirage, *better;  ///< nullptr: neither shows as good a picture
};
/// Of each run that is neither, in their order.
std::vector<BytesBeside> bytes_beside(const std::vector<BytesRun>& runs);

Table bytes_table(const std::vector<BytesRun>& runs);
/// A sentence for each comparison.
std::vector<std::string> bytes_words(const std::vector<BytesRun>& runs);

}  // namespace mirage
