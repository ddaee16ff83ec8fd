#pragma once
#include <set>
#include <string>
#include <vector>

namespace mirage {

enum class ReportPart {
  kWorkPrecision,
  kFidelity,
  kLatency,
  kFirst,
  kBytes,
  kWeather,
  kCalibrate,
  kExtreme,
  kNeeds,
  kModels
};

struct ReportOptions {
  std::set<ReportPart> parts;
  std::string what;        ///< as typed: "all", "latency", …
  std::string scene;       ///< empty: the report's own scenes
  std::string url;         ///< empty: servers of its own
  std::string model;       ///< of the user's, for fidelity
  std::string models_dir;  ///< for models
  std::string out_dir = "out/report";
  double frame_ms = 0;  ///< budget of a frame, for weather; 0: none
  bool quick = false;
  std::string device = "auto";
  std::string command_line;  ///< to be repeated by hand
};

/// Reads the command line; returns an exit code when the program is to end at once, else -1.
int parse_options(int argc, char** argv, ReportOptions& options);

}  // namespace mirage
