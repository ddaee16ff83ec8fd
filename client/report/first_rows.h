#pragma once
// What the part about the first seconds runs, and its tables.

#include <string>
#include <vector>

#include "client/report/latency_run.h"
#include "client/report/plot.h"
#include "client/report/table.h"

namespace mirage {

struct FirstPlan {
  std::vector<std::string> scenes, methods;
  std::vector<NetModel> links;
  std::size_t pictured_link = 1;  ///< of which Mirage's pictures are shown
  double pictured_from_s = 0.3;
  int pictures = 12;
  int width = 0, height = 0;
  double fps = 0, seconds = 4;
  int compare_every = 0;  ///< frames
};
FirstPlan first_plan(bool quick);

/// Times count from the beginning of the connection. Not a number: there is none within the run.
struct FirstFigures {
  double picture_ms = 0;    ///< of the first frame with a tile, a mesh or a video frame
  double flip = 0;          ///< of the first compared frame from then on
  double second_after = 0;  ///< mean FLIP of the compared frames of the second from then on
};
FirstFigures first_figures(const LatencyRun& run);

/// A row for each run.
Table first_table(const std::vector<LatencyRun>& runs);
/// A row for each compared frame.
Table first_frames(const std::vector<LatencyRun>& runs);
/// FLIP over time, a panel for each scene and link, a line for each method.
std::vector<Panel> first_panels(const std::vector<LatencyRun>& runs);

}  // namespace mirage
