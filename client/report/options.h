#pragma once
#include <set>
#include <string>
#include <vector>

namespace mirage {

enum class ReportPart {
  kReal,
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
  std::string url;         ///< empty: the report starts servers
  std::string model;       ///< the user's model, for fidelity
  std::string models_dir;  ///< folder for the part "models"
  std::string out_dir = "out/report";
  double frame_ms = 0;  ///< budget of a frame, for weather; 0: none
  bool quick = false;
  std::string device = "auto";
  std::string command_line;  ///< command to repeat the run by hand
};

/// Reads the command line. Returns an exit code if the program should end at once, otherwise -1.
int parse_options(int argc, char** argv, ReportOptions& options);

}  // namespace mirage
