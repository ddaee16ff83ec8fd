// Downloads of the shipped server: bakes and frozen folders that the page asks for.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/support/http_get.h"
#include "tests/support/process.h"

namespace mirage::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kBake = "/v1/download?kind=bake&grid=4&size=256";
constexpr double kLongest = 200;  // s

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Asks until the answer is another than "not yet".
Answer fetched(const Server& server, const std::string& path, const std::string& headers = "") {
  for (const double end = now_s() + kLongest; now_s() < end;) {
    Answer answer = get(server, path, headers);
    if (answer.status != 202) return answer;
    EXPECT_TRUE(json::accept(answer.body)) << answer.body;
    EXPECT_NE(answer.head.find("Retry-After: 1"), std::string::npos) << answer.head;
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
  }
  return {};
}

/// Unpacks an archive with a program that is not ours. Returns the folder.
std::string unpacked(const std::string& zip) {
  const std::string folder = scratch_folder();
  std::ofstream(folder + "/a.zip", std::ios::binary) << zip;
  const Finished done =
      run({"/usr/bin/python3", "-m", "zipfile", "-e", folder + "/a.zip", folder + "/in"});
  EXPECT_EQ(done.exit_code, 0) << done.output;
  return folder + "/in";
}

/// Returns the processes of a program that a server has started.
std::vector<int> children(const Server& server, const std::string& program) {
  std::vector<int> out;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string status = read_file(entry.path().string() + "/status");
    const std::string parent = "PPid:\t" + std::to_string(server.pid()) + "\n";
    const std::string name = "Name:\t" + program.substr(0, 15) + "\n";
    if (status.find(parent) != std::string::npos && status.find(name) != std::string::npos) {
      out.push_back(std::stoi(entry.path().filename().string()));
    }
  }
  return out;
}

template <class Condition>
bool soon(const Condition& condition, double seconds) {
  for (const double end = now_s() + seconds; now_s() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return condition();
}

TEST(Download, ABakeIsThatOfTheProgram) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  EXPECT_EQ(get(server, "/v1/downloads").body, "{\"bake\":true,\"folder\":true}\n");
  const Answer answer = fetched(server, kBake + "&object=0");
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_NE(answer.head.find("application/zip"), std::string::npos) << answer.head;
  EXPECT_NE(answer.head.find("filename=\"knot-0-generic.zip\""), std::string::npos) << answer.head;
  const std::string got = unpacked(answer.body), due = scratch_folder();
  const Finished baked = run({binary("mirage-bake"), "builtin:knot", "--out", due, "--grid", "4",
                              "--size", "256", "--object", "0"});
  ASSERT_EQ(baked.exit_code, 0) << baked.output;
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(due)) {
    if (!entry.is_regular_file()) continue;
    const std::string name = fs::relative(entry.path(), due).string();
    EXPECT_TRUE(read_file(got + "/" + name) == read_file(entry.path().string())) << name;
    ++files;
  }
  EXPECT_GT(files, 3u);
  // It is there at once for the next who asks.
  EXPECT_EQ(get(server, kBake + "&object=0").body, answer.body);
}

TEST(Download, AFolderNeedsNoServer) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  const Answer answer =
      fetched(server, "/v1/download?kind=folder&mb=3&eye=0,1,5&look=0,0,0&reach=0");
  ASSERT_EQ(answer.status, 200) << answer.body;
  const std::string folder = unpacked(answer.body), stats = scratch_folder() + "/stats.json";
  EXPECT_LE(answer.body.size(), 3'200'000u);
  const Finished seen =
      run({binary("mirage-view"), folder, "--offscreen", "320x180", "--virtual-time", "--frames",
           "20", "--path", "builtin:still", "--stats", stats});
  ASSERT_EQ(seen.exit_code, 0) << seen.output;
  // The page begins where the visitor was.
  const std::string index = read_file(folder + "/index.html");
  if (!index.empty()) {
    EXPECT_NE(index.find("mirage-folder"), std::string::npos);
  }
  const json home = json::parse(read_file(stats))["home"]["eye"];
  EXPECT_EQ(home, json({0, 1, 5})) << home;
}

TEST(Download, WhatNobodyAsksForAnyLongerEnds) {
  const Server server("builtin:forest?trees=40");
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string slow = "/v1/download?kind=folder&mb=50";
  ASSERT_EQ(get(server, slow).status, 202);
  ASSERT_TRUE(soon([&] { return !children(server, "mirage-freeze").empty(); }, 20));
  // Others wait in line, and equal ones share a place in it.
  const json second = json::parse(get(server, kBake).body);
  EXPECT_EQ(second["state"], "waiting");
  EXPECT_EQ(second["ahead"], 1);
  EXPECT_EQ(json::parse(get(server, kBake).body)["ahead"], 1);
  int full = 0;
  for (int grid = 5; grid < 20; ++grid) {
    const Answer more = get(server, "/v1/download?kind=bake&grid=" + std::to_string(grid));
    full += more.status == 503 ? 1 : 0;
  }
  EXPECT_GT(full, 5) << "strangers can make it do as much as they like";
  EXPECT_TRUE(soon([&] { return children(server, "mirage-freeze").empty(); }, 40));
}

TEST(Download, SaysWhyThereIsNone) {
  {
    const Server closed("builtin:knot", {"--no-downloads"});
    ASSERT_TRUE(closed.ready()) << closed.log();
    EXPECT_EQ(get(closed, "/v1/downloads").body, "{\"bake\":false,\"folder\":false}\n");
    const Answer refused = get(closed, kBake);
    EXPECT_EQ(refused.status, 403);
    EXPECT_NE(refused.body.find("--downloads"), std::string::npos) << refused.body;
  }
  {
    const Server far("builtin:knot", {"--listen", "0.0.0.0:0"});
    ASSERT_TRUE(far.ready()) << far.log();
    EXPECT_EQ(get(far, kBake).status, 403) << "strangers get it only if they are to";
  }
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  EXPECT_EQ(get(server, "/v1/download?kind=bake&grid=0").status, 400);
  EXPECT_EQ(get(server, "/v1/download").status, 400);
  const Answer unknown = fetched(server, "/v1/download?kind=bake&target=quake");
  EXPECT_EQ(unknown.status, 400);
  EXPECT_NE(unknown.body.find("quake"), std::string::npos) << unknown.body;
  const Answer none = fetched(server, "/v1/download?kind=bake&object=77");
  EXPECT_EQ(none.status, 400) << none.body;
  RawPeer peer(server.port());
  peer.say("POST " + kBake +
           " HTTP/1.1\r\nHost: x\r\nContent-Length: 0\r\nConnection: close\r\n\r\n");
  EXPECT_EQ(read_answer(peer).status, 405);
}

TEST(Download, ATokenIsNeededWhereOneIsNeeded) {
  const std::string file = scratch_folder() + "/tokens";
  std::ofstream(file) << "a-token-of-32-characters-length-xx\n";
  // Options in the environment are this server's, not those of the programs that it runs.
  const Server server("builtin:knot", {}, {"MIRAGE_TOKEN_FILE=" + file});
  ASSERT_TRUE(server.ready()) << server.log();
  EXPECT_EQ(get(server, kBake).status, 401);
  const std::string header = "Authorization: Bearer a-token-of-32-characters-length-xx\r\n";
  EXPECT_EQ(fetched(server, kBake, header).status, 200);
  EXPECT_EQ(
      fetched(server, "/v1/download?kind=folder&mb=3&eye=0,1,5&look=0,0,0&reach=0", header).status,
      200);
}

}  // namespace
}  // namespace mirage::test
