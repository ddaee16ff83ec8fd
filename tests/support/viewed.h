#pragma once
// Viewed: runs mirage-view without a window on virtual time, and reads its statistics.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/process.h"

namespace mirage::test {

struct Viewed {
  Finished run;
  std::string text;      ///< the statistics, byte for byte
  nlohmann::json stats;  ///< discarded if there are none
};

/// Runs the viewer. `options` are separated by blanks. Statistics go to s.json in `folder`.
inline Viewed view(const Server& server, const std::string& options,
                   const std::string& folder = scratch_folder()) {
  std::vector<std::string> command = {binary("mirage-view"), server.url(), "--virtual-time",
                                      "--stats", folder + "/s.json"};
  std::istringstream words(options);
  for (std::string word; words >> word;) command.push_back(word);
  Viewed out{run(command, 600), {}, {}};
  EXPECT_EQ(out.run.exit_code, 0) << options << ": " << out.run.output;
  out.text = read_file(folder + "/s.json");
  out.stats = nlohmann::json::parse(out.text, nullptr, false);
  return out;
}

}  // namespace mirage::test
