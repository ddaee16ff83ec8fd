#pragma once
// Plan and tables of the report's part about the first seconds.

#include <string>
#include <vector>

#include "client/report/latency_run.h"
#include "client/report/plot.h"
#include "client/report/table.h"

namespace mirage {

struct FirstPlan {
  std::vector<std::string> scenes, methods;
  std::vector<NetModel> links;
  std::size_t pictured_link = 1;  ///< link whose pictures of Mirage are shown
  double pictured_from_s = 0.3;
  int pictures = 12;
  int width = 0, height = 0;
  double fps = 0, seconds = 4;
  int compare_every = 0;  ///< frames from one comparison to the next
};
FirstPlan first_plan(bool quick);

/// Times count from the start of the connection. NaN: the run has no such value.
struct FirstFigures {
  double picture_ms = 0;    ///< time of the first frame with a tile, a mesh or a video frame
  double flip = 0;          ///< FLIP of the first compared frame from then on
  double second_after = 0;  ///< mean FLIP of the frames compared in the second from then on
};
FirstFigures first_figures(const LatencyRun& run);

/// Returns a row for each run.
Table first_table(const std::vector<LatencyRun>& runs);
/// Returns a row for each compared frame.
Table first_frames(const std::vector<LatencyRun>& runs);
/// Returns plots of FLIP over time: a panel for each scene and link, a line for each method.
std::vector<Panel> first_panels(const std::vector<LatencyRun>& runs);

}  // namespace mirage
