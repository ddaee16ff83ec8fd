// mirage-report as a person runs it, on the smallest scene: files, columns, page, exit codes.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/support/process.h"

namespace mirage::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::vector<std::vector<std::string>> csv(const std::string& path) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(read_file(path));
  std::string line;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    std::string cell;
    while (std::getline(cells, cell, ',')) rows.back().push_back(cell);
  }
  return rows;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++n;
  return n;
}

void expect_self_contained(const std::string& html) {
  for (const char* outside : {"src=\"http", "href=\"http", "src='http", "href='http", "url(http",
                              "<link", "<script src", "@import", "src=\"file", "<iframe"}) {
    EXPECT_EQ(count(html, outside), 0u) << outside;
  }
  EXPECT_EQ(count(html, "<svg"), count(html, "</svg>"));
  EXPECT_EQ(count(html, "</html>"), 1u);
}

bool gnuplot() { return std::system("command -v gnuplot > /dev/null 2>&1") == 0; }

TEST(Report, WorkPrecisionHasAllMethodsFiguresAndPlots) {
  const std::string out = scratch_folder();
  const Finished report = run({binary("mirage-report"), "work-precision", "--quick", "--scene",
                               "builtin:knot", "--out", out},
                              300);
  ASSERT_EQ(report.exit_code, 0) << report.output;
  EXPECT_NE(report.output.find("work-precision 26 of 26"), std::string::npos) << report.output;
  const auto rows = csv(out + "/work_precision.csv");
  ASSERT_EQ(rows.size(), 27u);
  EXPECT_EQ(rows[0], (std::vector<std::string>{"scene",
                                               "method",
                                               "tau_px",
                                               "client_ms",
                                               "server_ms_per_tile",
                                               "bytes_per_s",
                                               "request_to_display_ms",
                                               "e1_px_p99",
                                               "e1_px_max",
                                               "flip_mean",
                                               "psnr_db",
                                               "ssim",
                                               "iou",
                                               "flicker",
                                               "pareto",
                                               "commit",
                                               "renderer",
                                               "revision",
                                               "budget_ms",
                                               "client_ms_p95",
                                               "scale",
                                               "samples"}));
  std::set<std::string> methods, budgets, samples;
  int on_front = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    methods.insert(rows[i][1]);
    EXPECT_GT(std::atof(rows[i][3].c_str()), 0) << "client_ms of row " << i;
    EXPECT_GT(std::atof(rows[i][5].c_str()), 0) << "bytes_per_s of row " << i;
    EXPECT_GT(std::atof(rows[i][9].c_str()), 0) << "flip_mean of row " << i;
    EXPECT_LT(std::atof(rows[i][9].c_str()), 0.3) << "flip_mean of row " << i;
    // The renderer's name has commas of its own.
    const std::vector<std::string> end(rows[i].end() - 5, rows[i].end());
    EXPECT_EQ(end[0].size(), 16u) << "revision";
    if (rows[i][1] == "auto") budgets.insert(end[1]);
    EXPECT_GT(std::atof(end[2].c_str()), 0) << "client_ms_p95 of row " << i;
    if (rows[i][1] == "quad") samples.insert(end[4]);
    on_front += rows[i][14] == "1";
  }
  EXPECT_EQ(methods, (std::set<std::string>{"fixed8", "quad", "cuboid", "hull", "warp", "depth",
                                            "auto", "mesh"}));
  EXPECT_EQ(budgets, (std::set<std::string>{"0", "8", "16", "33"}));
  EXPECT_EQ(samples, (std::set<std::string>{"1", "4"}));
  EXPECT_GE(on_front, 1);
  EXPECT_LT(on_front, 26);
  const std::string html = read_file(out + "/index.html");
  expect_self_contained(html);
  EXPECT_EQ(count(html, "src=\"data:image/jpeg;base64,"), 9u * 3);
  EXPECT_EQ(count(html, "<svg"), gnuplot() ? 4u : 0u);
  EXPECT_EQ(count(html, "By client ms"), 1u);
  EXPECT_EQ(count(html, "By the device model"), 1u);
  EXPECT_EQ(count(html, "By bytes"), 1u);
  EXPECT_EQ(html.find("gnuplot is not installed") != std::string::npos, !gnuplot());
}

TEST(Report, WeatherIsATableOfLinksScenesAndPaths) {
  const std::string out = scratch_folder();
  const Finished report = run({binary("mirage-report"), "weather", "--quick", "--scene",
                               "builtin:clutter?objects=60", "--out", out},
                              300);
  ASSERT_EQ(report.exit_code, 0) << report.output;
  EXPECT_NE(report.output.find("weather 2 of 2"), std::string::npos) << report.output;
  EXPECT_NE(report.output.find("thin-room, seed 1: FLIP 0."), std::string::npos) << report.output;
  const auto rows = csv(out + "/weather.csv");
  ASSERT_EQ(rows.size(), 3u);
  const auto value = [&](std::size_t row, const std::string& column) {
    const auto at = std::find(rows[0].begin(), rows[0].end(), column) - rows[0].begin();
    return std::atof(rows[row].at(static_cast<std::size_t>(at)).c_str());
  };
  EXPECT_EQ(rows[1][0], "thin-room");
  EXPECT_EQ(rows[2][0], "teleport-room");
  for (const std::size_t row : {1u, 2u}) {
    EXPECT_GT(value(row, "flip_mean"), 0);
    EXPECT_LT(value(row, "flip_mean"), 0.3);
    EXPECT_GE(value(row, "flip_worst"), value(row, "flip_mean"));
    EXPECT_GT(value(row, "mb"), 0);
    EXPECT_GT(value(row, "no_image_fraction"), 0) << "what a new view shows has no image at first";
    EXPECT_EQ(value(row, "bound_violations"), 0);
  }
  EXPECT_GT(value(1, "link_used"), 2 * value(2, "link_used")) << "of 2 and of 50 Mbit/s";
  const std::string html = read_file(out + "/index.html");
  expect_self_contained(html);
  EXPECT_EQ(count(html, "<svg"), gnuplot() ? 1u : 0u);
  EXPECT_NE(html.find("<td>median</td>"), std::string::npos);
}

TEST(Report, WeatherWithinABudgetStandsBesideNone) {
  const std::string out = scratch_folder();
  const Finished report = run({binary("mirage-report"), "weather", "--quick", "--frame-ms", "8",
                               "--scene", "builtin:clutter?objects=60", "--out", out},
                              300);
  ASSERT_EQ(report.exit_code, 0) << report.output;
  const auto rows = csv(out + "/weather.csv");
  ASSERT_EQ(rows.size(), 5u) << "two weathers, each without and within";
  for (const std::size_t row : {1u, 3u}) {
    const std::vector<std::string>&none = rows[row], &within = rows[row + 1];
    EXPECT_EQ(none[none.size() - 2], "0");
    EXPECT_EQ(within[within.size() - 2], "8");
    EXPECT_LT(std::atof(within.back().c_str()), std::atof(none.back().c_str())) << "client ms";
  }
  const std::string html = read_file(out + "/index.html");
  EXPECT_NE(html.find("FLIP, within"), std::string::npos);
}

TEST(Report, BytesOfAWalkAreThoseOfFourDeliveries) {
  const std::string out = scratch_folder();
  const Finished report = run({binary("mirage-report"), "bytes", "--quick", "--scene",
                               "builtin:clutter?objects=60", "--out", out},
                              300);
  ASSERT_EQ(report.exit_code, 0) << report.output;
  const auto rows = csv(out + "/bytes.csv");
  ASSERT_EQ(rows.size(), 9u) << "four of 5 s, four of 10 s";
  const auto value = [&](std::size_t row, const std::string& column) {
    const auto at = std::find(rows[0].begin(), rows[0].end(), column) - rows[0].begin();
    return std::atof(rows[row].at(static_cast<std::size_t>(at)).c_str());
  };
  for (std::size_t row = 1; row < 5; ++row) {
    EXPECT_GT(value(row, "mb_down"), 0);
    EXPECT_GE(value(row + 4, "mb_down"), value(row, "mb_down")) << "the same walk, further on";
    EXPECT_GT(value(row, "flip_mean"), 0);
    EXPECT_LT(value(row, "flip_mean"), 0.3);
    EXPECT_EQ(value(row, "flip_after_5s"), value(row + 4, "flip_after_5s"));
    EXPECT_GE(value(row, "first_picture_ms"), 300) << "two trips to connect, one to ask";
  }
  EXPECT_GT(value(4, "mb_down"), value(3, "mb_down")) << "tiles only, all geometry";
  expect_self_contained(read_file(out + "/index.html"));
}

TEST(Report, FirstSecondsBeginWithNothingForEveryone) {
  const std::string out = scratch_folder();
  const Finished report = run({binary("mirage-report"), "first", "--quick", "--scene",
                               "builtin:clutter?objects=60", "--out", out},
                              300);
  ASSERT_EQ(report.exit_code, 0) << report.output;
  const auto rows = csv(out + "/first_seconds.csv");
  ASSERT_FALSE(rows.empty());
  EXPECT_EQ(rows[0], (std::vector<std::string>{"scene", "path", "rtt_ms", "rate_mbps", "method",
                                               "first_picture_ms", "first_picture_flip",
                                               "second_after_flip"}));
  const bool video =
      read_file(out + "/index.html").find("built without libavcodec") == std::string::npos;
  ASSERT_EQ(rows.size(), video ? 10u : 7u);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double trips = std::atof(rows[i][5].c_str()) / std::atof(rows[i][2].c_str());
    EXPECT_GE(trips, 3) << "two to connect, one to ask: " << rows[i][4];
    EXPECT_GT(std::atof(rows[i][6].c_str()), 0) << rows[i][4];
  }
  std::set<std::string> blank;  // FLIP of the first frame
  for (const auto& row : csv(out + "/first_seconds_frames.csv")) {
    if (row[5] == "0") blank.insert(row[6]);
  }
  EXPECT_EQ(blank.size(), 1u) << "before anything has come all show the same";
  const std::string html = read_file(out + "/index.html");
  expect_self_contained(html);
  EXPECT_EQ(count(html, "src=\"data:image/jpeg;base64,"), 2u * 12);
  EXPECT_EQ(count(html, "<svg"), gnuplot() ? 1u : 0u);
}

TEST(Report, RealHasARowForEachBudgetByTheClock) {
  const std::string out = scratch_folder();
  const Finished report = run({binary("mirage-report"), "real", "--quick", "--scene",
                               "builtin:clutter?objects=60", "--out", out},
                              300);
  ASSERT_EQ(report.exit_code, 0) << report.output;
  EXPECT_NE(report.output.find("real 2 of 2"), std::string::npos) << report.output;
  const auto rows = csv(out + "/real.csv"), stages = csv(out + "/real_stages.csv");
  const json whole = json::parse(read_file(out + "/real.json")), found = whole["rows"];
  EXPECT_GT(whole["machine"]["cores"], 0);
  ASSERT_EQ(rows.size(), 3u);
  ASSERT_EQ(found.size(), 2u);
  const auto value = [&](std::size_t row, const std::string& column) {
    const auto at = std::find(rows[0].begin(), rows[0].end(), column) - rows[0].begin();
    return std::atof(rows[row].at(static_cast<std::size_t>(at)).c_str());
  };
  for (const std::size_t row : {1u, 2u}) {
    const json& drawn = found[row - 1]["real_time"]["drawn"];
    EXPECT_EQ(value(row, "budget_ms"), row == 1 ? 16 : 50);
    EXPECT_EQ(found[row - 1]["commands"].size(), 2u) << "server and viewer, by hand";
    EXPECT_EQ(value(row, "frames"), drawn["frames"]);
    EXPECT_GT(value(row, "frame_ms_p50"), 0);
    EXPECT_GE(value(row, "frame_ms_p95"), value(row, "frame_ms_p50"));
    EXPECT_GE(value(row, "frame_ms_max"), value(row, "settled_ms_max"));
    EXPECT_GT(value(row, "settled_ms_p50"), 0) << "the walk goes on beyond the fifth second";
    EXPECT_GT(value(row, "scale_mean"), 0);
    double caused = 0;
    for (const auto& stage : stages) {
      if (stage[1] == rows[row][1]) caused += std::atof(stage.back().c_str());
    }
    EXPECT_EQ(value(row, "late"), caused) << "each late frame has one cause";
    const json trace = json::parse(
        read_file(out + "/real/builtin_clutter_objects_60_" + rows[row][1] + "ms.trace.json"));
    EXPECT_EQ(value(row, "frames"), trace["frames"].size());
  }
  const std::string html = read_file(out + "/index.html");
  expect_self_contained(html);
  EXPECT_EQ(count(html, "<svg"), gnuplot() ? 3u : 0u);
  EXPECT_NE(html.find("smallest budget that 95 of 100 frames keep"), std::string::npos);
  EXPECT_NE(html.find("--frame-ms 50 --path builtin:walk --seconds 6"), std::string::npos)
      << "the command of a row";
}

TEST(Report, WeatherOnASceneOfNoWeatherIsAnOmission) {
  const std::string out = scratch_folder();
  const Finished report =
      run({binary("mirage-report"), "weather", "--quick", "--scene", "builtin:knot", "--out", out});
  EXPECT_EQ(report.exit_code, 0) << report.output;
  EXPECT_EQ(csv(out + "/weather.csv").size(), 1u);
  EXPECT_NE(read_file(out + "/index.html").find("no weather of the table is on this scene"),
            std::string::npos);
}

TEST(Report, FidelityIsWhatTheProtocolGives) {
  const std::string out = scratch_folder();
  const Finished report =
      run({binary("mirage-report"), "fidelity", "--quick", "--scene", "builtin:knot", "--out", out},
          300);
  ASSERT_EQ(report.exit_code, 0) << report.output;
  const json rows = json::parse(read_file(out + "/fidelity.json"))["rows"];
  ASSERT_GE(rows.size(), 8u);
  for (const json& row : rows) {
    const double psnr = row["psnr_db"];
    // Limits that also hold for the renderer's own tiles (tests/gl/fidelity_test.cpp).
    const double degrees = row["offset_deg"].is_null() ? 90 : row["offset_deg"].get<double>();
    if (degrees == 0 && row["method"] == "quad") {
      EXPECT_GT(psnr, 44) << row;
    }
    if (degrees == 5 && row["method"] == "depth") {
      EXPECT_GT(psnr, 32) << row;
    }
    if (degrees == 10 && row["method"] == "quad") {
      EXPECT_LT(psnr, 25) << row;
    }
    EXPECT_GT(row["texture_bytes"], 10'000) << row;
    for (const char* key : {"model", "light", "distance_r", "ssim", "iou"}) {
      EXPECT_TRUE(row.contains(key)) << key;
    }
  }
  expect_self_contained(read_file(out + "/index.html"));
}

// Runs the report beside programs that say what the test wants.
class Outside : public testing::Test {
 protected:
  void SetUp() override {
    fs::copy(binary("mirage-report"), folder + "/mirage-report");
    fs::create_directory(out);
  }
  void program(const std::string& name, const std::string& script) {
    std::ofstream(folder + "/" + name) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(folder + "/" + name, fs::perms::owner_all);
  }
  Finished report(const std::string& what) {
    return run({folder + "/mirage-report", what, "--quick", "--scene", "some.glb", "--out", out});
  }
  const std::string folder = scratch_folder(), out = folder + "/out";
};

TEST_F(Outside, ExtremeCasesThatHoldGiveZeroAndOthersSix) {
  program("mirage-extreme",
          "[ \"$3\" = --quick ] || exit 9\n"
          "echo '{\"rows\":[{\"id\":\"G1\",\"case\":\"empty mesh\",\"must_hold\":\"alpha 0\","
          "\"measured\":\"0\",\"limit\":\"0\",\"pass\":true}]}' > \"$2\"");
  const Finished good = report("extreme");
  EXPECT_EQ(good.exit_code, 0) << good.output;
  const json rows = json::parse(read_file(out + "/extreme.json"))["rows"];
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0]["must_hold"], "alpha 0");
  EXPECT_NE(read_file(out + "/index.html").find("<b>1 of 1</b><span>cases hold</span>"),
            std::string::npos);

  program("mirage-extreme",
          "echo '{\"rows\":[{\"id\":\"G1\",\"case\":\"<q>\",\"must_hold\":\"alpha 0\","
          "\"measured\":3.5,\"limit\":\"0\",\"pass\":false}]}' > \"$2\"; exit 6");
  const Finished bad = report("extreme");
  EXPECT_EQ(bad.exit_code, 6) << bad.output;
  const std::string html = read_file(out + "/index.html");  // written nevertheless
  EXPECT_NE(html.find("extreme case G1 does not hold"), std::string::npos);
  EXPECT_EQ(count(html, "<q>"), 0u);
}

TEST(Report, ExtremeCasesWriteWhatItReads) {
  const std::string file = scratch_folder() + "/extreme.json";
  const Finished cases =
      run({binary("mirage-extreme"), "--json", file, "--quick", "--jobs", "2", "--only", "G3,R8"});
  ASSERT_EQ(cases.exit_code, 0) << cases.output;
  const json rows = json::parse(read_file(file))["rows"];
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["id"], "G3");
  for (const char* key : {"case", "must_hold", "measured", "limit", "pass"}) {
    EXPECT_TRUE(rows[0].contains(key)) << key;
  }
}

// The program is also copied to machines without the sources.
TEST(Report, ExtremeCasesSayWhichFileIsMissing) {
  const Finished cases = run({binary("mirage-extreme"), "--quick", "--jobs", "2", "--data",
                              scratch_folder() + "/nowhere", "--only", "R1,R2,R3,R7,R8"});
  EXPECT_EQ(cases.exit_code, 6) << cases.output;
  EXPECT_EQ(count(cases.output, "is missing; --data names"), 5u) << cases.output;
  EXPECT_EQ(cases.output.find("crashed"), std::string::npos) << cases.output;
}

TEST_F(Outside, WhatIsLeftOutMustNotChangeAPixel) {
  const std::string row =
      "{\"scene\":\"some.glb\",\"object\":0,\"rule\":1,\"left_out\":\"sort\","
      "\"differing_components\":DIFFERING,\"saved\":\"1.2x\"}";
  const auto say = [&](const std::string& differing) {
    std::string text = row;
    text.replace(text.find("DIFFERING"), 9, differing);
    program("mirage-server", "echo '{\"rows\":[" + text + "],\"total\":{\"saved\":1.2}}'");
  };
  say("0");
  EXPECT_EQ(report("needs").exit_code, 0);
  EXPECT_EQ(json::parse(read_file(out + "/needs.json"))["rows"][0]["left_out"], "sort");
  say("4");
  EXPECT_EQ(report("needs").exit_code, 6);
}

TEST_F(Outside, WhatIsNotThereOrFailsIsAnOmission) {
  const Finished none = report("extreme");
  EXPECT_EQ(none.exit_code, 0) << none.output;
  EXPECT_NE(read_file(out + "/index.html").find("there is no mirage-extreme"), std::string::npos);
  EXPECT_TRUE(json::parse(read_file(out + "/extreme.json"))["rows"].empty());
  program("mirage-server", "echo 'error scene-missing: no such file' >&2; exit 3");
  EXPECT_EQ(report("needs").exit_code, 0);
  EXPECT_NE(read_file(out + "/index.html").find("scene-missing: no such file"), std::string::npos);
}

TEST(Report, FailsWithTheExitCodeOfTheReason) {
  const std::string out = scratch_folder();
  const auto code = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), binary("mirage-report"));
    arguments.insert(arguments.end(), {"--out", out});
    return run(arguments).exit_code;
  };
  EXPECT_EQ(code({"everything"}), 2);
  EXPECT_EQ(code({"latency", "--frame-ms", "50"}), 2);
  EXPECT_EQ(code({"fidelity", "--scene", "builtin:knot", "--url", "ws://127.0.0.1:1"}), 2);
  EXPECT_EQ(code({"work-precision", "--quick", "--scene", "no_such_file.glb"}), 3);
  EXPECT_EQ(code({"real", "--quick", "--scene", "no_such_file.glb"}), 3);
  EXPECT_EQ(code({"real", "--quick", "--url", "ws://127.0.0.1:1"}), 5);
  EXPECT_EQ(code({"fidelity", "--url", "ws://127.0.0.1:1"}), 5);
}

}  // namespace
}  // namespace mirage::test
