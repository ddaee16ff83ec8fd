// mirage-freeze: a folder that needs no server, what ends a run in the middle, and damaged folders.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/support/http_get.h"
#include "tests/support/process.h"

namespace mirage::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScene = "builtin:knot";
// Few eyes and small pictures: what is tested does not depend on their number.
const std::vector<std::string> kFew = {"--eyes", "6", "--size", "320x180"};

std::vector<std::string> command(const std::string& out,
                                 const std::vector<std::string>& more = {}) {
  std::vector<std::string> line = {binary("mirage-freeze"), kScene, "--out", out};
  line.insert(line.end(), kFew.begin(), kFew.end());
  line.insert(line.end(), more.begin(), more.end());
  return line;
}
Finished freeze(const std::string& out, const std::vector<std::string>& more = {}) {
  return run(command(out, more), 300);
}

/// Starts a freeze. Returns its process.
int start_freeze(const std::string& out, const std::vector<std::string>& more = {}) {
  const std::vector<std::string> line = command(out, more);
  const int pid = fork();
  if (pid != 0) return pid;
  std::vector<char*> argv;
  for (const std::string& word : line) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  _exit(127);
}

nlohmann::json index_of(const std::string& folder) {
  return nlohmann::json::parse(read_file(folder + "/frozen.json"));
}

/// Returns the files of a folder by name, without those of a run under way.
std::map<std::string, std::string> files_of(const std::string& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).string();
    if (entry.is_regular_file() && name.rfind(".freeze", 0) != 0) {
      out[name] = read_file(entry.path().string());
    }
  }
  return out;
}

/// Returns the names that differ between two folders.
std::vector<std::string> differing(const std::string& a, const std::string& b) {
  const auto one = files_of(a), other = files_of(b);
  std::vector<std::string> out;
  for (const auto& [name, bytes] : one) {
    const auto at = other.find(name);
    if (at == other.end() || at->second != bytes) out.push_back(name);
  }
  for (const auto& [name, bytes] : other) {
    if (one.count(name) == 0) out.push_back(name);
  }
  return out;
}

/// Returns the first file of a kind ("tile", "mesh").
std::string one_file(const std::string& folder, const std::string& kind) {
  for (const auto& [name, bytes] : files_of(folder)) {
    if (name.rfind("v1/" + kind + "/", 0) == 0) return name;
  }
  return "";
}

/// Looks at a folder with the viewer, from a still eye.
Finished view(const std::string& folder, const std::string& stats) {
  return run({binary("mirage-view"), folder, "--offscreen", "320x180", "--virtual-time", "--frames",
              "20", "--path", "builtin:still", "--stats", stats},
             120);
}

class Freeze : public ::testing::Test {
 protected:
  /// One whole folder for all tests that only read it.
  static const std::string& whole() {
    static const std::string folder = [] {
      const std::string out = scratch_folder() + "/knot";
      const Finished done = freeze(out);
      EXPECT_EQ(done.exit_code, 0) << done.output;
      return out;
    }();
    return folder;
  }
  /// Returns a copy of it, to damage.
  static std::string copy() {
    const std::string out = scratch_folder() + "/copy";
    fs::copy(whole(), out, fs::copy_options::recursive);
    return out;
  }
};

TEST_F(Freeze, TheFolderTellsItsFilesAndItsError) {
  const nlohmann::json index = index_of(whole());
  EXPECT_EQ(index["scene"], kScene);
  EXPECT_LE(index["error"]["worst_px"].get<double>(), index["error"]["asked_px"].get<double>());
  EXPECT_EQ(index["error"]["views_with_holes"], 0);
  EXPECT_LT(index["bytes"].get<double>(), 20e6);
  for (const auto& file : index["files"]) {
    const std::string name = file["name"];
    EXPECT_EQ(read_file(whole() + "/" + name).size(), file["bytes"].get<std::size_t>()) << name;
  }
  EXPECT_FALSE(fs::exists(whole() + "/.freeze")) << "what only a run needs";
}

TEST_F(Freeze, ATileHasTheBytesOfTheServersAddress) {
  const Server server(kScene);
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string name = one_file(whole(), "tile");
  ASSERT_NE(name, "");
  const Answer answer = get(server, "/" + name);
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, read_file(whole() + "/" + name));
}

TEST_F(Freeze, AViewerDrawsTheFolderWithoutAServer) {
  const std::string stats = scratch_folder() + "/stats.json";
  const Finished done = view(whole(), stats);
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const nlohmann::json told = nlohmann::json::parse(read_file(stats));
  EXPECT_GT(told["meshes_drawn"].get<double>() + told["impostors_drawn"].get<double>(), 0);
  EXPECT_EQ(told["tiles"]["refused"], 0);
}

TEST_F(Freeze, WithoutGeometryNoMeshIsWritten) {
  const std::string out = scratch_folder() + "/pictures";
  const Finished done = freeze(out, {"--no-geometry", "--mb", "3"});
  ASSERT_EQ(done.exit_code, 0) << done.output;
  EXPECT_EQ(one_file(out, "mesh"), "");
  EXPECT_NE(one_file(out, "tile"), "");
  std::uintmax_t bytes = 0;
  for (const auto& [name, text] : files_of(out)) bytes += text.size();
  EXPECT_LE(bytes, 3'000'000u);
  const nlohmann::json index = index_of(out);
  EXPECT_GT(index["left_out"].size(), 0u) << "the budget is too large to show anything";
  for (const auto& name : index["left_out"]) {
    EXPECT_FALSE(fs::exists(out + "/" + name.get<std::string>())) << name;
  }
}

TEST_F(Freeze, ASecondRunMakesOnlyWhatIsMissingOrWrong) {
  const std::string folder = copy();
  const Finished again = freeze(folder);
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_NE(again.output.find("nothing to do"), std::string::npos) << again.output;
  const std::string lost = one_file(folder, "mesh"), cut = one_file(folder, "tile");
  fs::remove(folder + "/" + lost);
  fs::resize_file(folder + "/" + cut, 100);
  const Finished mended = freeze(folder);
  EXPECT_EQ(mended.exit_code, 0) << mended.output;
  EXPECT_EQ(differing(folder, whole()), std::vector<std::string>());
}

TEST_F(Freeze, ARunThatWasKilledGoesOn) {
  const std::string folder = scratch_folder() + "/killed";
  for (const int ms : {150, 300, 450, 600, 800}) {
    const int pid = start_freeze(folder);
    std::this_thread::sleep_for(std::chrono::milliseconds(ms));
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
    // Never an index of files that are not there.
    if (!fs::exists(folder + "/frozen.json")) continue;
    for (const auto& file : index_of(folder)["files"]) {
      const std::string name = file["name"];
      EXPECT_EQ(read_file(folder + "/" + name).size(), file["bytes"].get<std::size_t>()) << name;
    }
  }
  // The system ends it in the middle of a file that is larger than 4 KiB.
  std::string limited = "ulimit -f 8; exec";
  for (const std::string& word : command(folder)) limited += " '" + word + "'";
  EXPECT_EQ(run({"/bin/sh", "-c", limited}).exit_code, 128 + SIGXFSZ);
  const Finished done = freeze(folder);
  EXPECT_EQ(done.exit_code, 0) << done.output;
  EXPECT_EQ(differing(folder, whole()), std::vector<std::string>());
  EXPECT_FALSE(fs::exists(folder + "/.freeze")) << "what only a run needs";
}

TEST_F(Freeze, ShardsGiveTheBytesOfOneRun) {
  const std::string folder = scratch_folder() + "/shards";
  const Finished first = freeze(folder, {"--shard", "1/2"});
  EXPECT_EQ(first.exit_code, 0) << first.output;
  EXPECT_FALSE(fs::exists(folder + "/frozen.json")) << "half of it is missing";
  const Finished second = freeze(folder, {"--shard", "0/2"});
  EXPECT_EQ(second.exit_code, 0) << second.output;
  EXPECT_EQ(differing(folder, whole()), std::vector<std::string>());
}

TEST_F(Freeze, TwoRunsDoNotWriteIntoOneFolder) {
  const std::string folder = scratch_folder() + "/two";
  const int pid = start_freeze(folder);
  while (!fs::exists(folder + "/.freeze/settings")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const Finished other = freeze(folder);
  EXPECT_EQ(other.exit_code, 2) << other.output;
  EXPECT_NE(other.output.find("another run writes"), std::string::npos) << other.output;
  kill(pid, SIGKILL);
  waitpid(pid, nullptr, 0);
}

TEST_F(Freeze, AFolderOfOtherSettingsIsLeftAlone) {
  const std::string folder = copy();
  const Finished other = freeze(folder, {"--error", "2"});
  EXPECT_EQ(other.exit_code, 2) << other.output;
  EXPECT_EQ(differing(folder, whole()), std::vector<std::string>());
}

TEST_F(Freeze, AMissingOrCutFileIsNamedAndNeverDrawn) {
  const std::string folder = copy(), stats = scratch_folder() + "/stats.json";
  for (const auto& [name, bytes] : files_of(folder)) {
    if (name.rfind("v1/mesh/", 0) == 0) fs::resize_file(folder + "/" + name, bytes.size() - 1);
  }
  const Finished done = view(folder, stats);
  EXPECT_EQ(done.exit_code, 0) << done.output;
  EXPECT_NE(done.output.find("v1/mesh/"), std::string::npos) << done.output;
  EXPECT_NE(done.output.find("is missing or damaged"), std::string::npos) << done.output;
  const nlohmann::json told = nlohmann::json::parse(read_file(stats));
  EXPECT_EQ(told["meshes_drawn"], 0.0);
  EXPECT_GT(told["impostors_drawn"].get<double>(), 0);
}

TEST_F(Freeze, ADamagedOpeningIsAnError) {
  const std::string folder = copy(), stats = scratch_folder() + "/stats.json";
  std::string frozen = read_file(folder + "/frozen.bin");
  for (const std::size_t at : {std::size_t{3}, std::size_t{12}, frozen.size() / 2}) {
    std::string wrong = frozen;
    wrong[at] = static_cast<char>(wrong[at] ^ 1);
    std::ofstream(folder + "/frozen.bin", std::ios::binary) << wrong;
    const Finished done = view(folder, stats);
    EXPECT_EQ(done.exit_code, 5) << done.output;
    EXPECT_NE(done.output.find("frozen.bin"), std::string::npos) << done.output;
  }
  fs::resize_file(folder + "/frozen.bin", 10);
  EXPECT_EQ(view(folder, stats).exit_code, 5);
}

// A limit on the size of files stands for a full disk: a write fails in the middle of a file.
TEST_F(Freeze, AWriteThatFailsIsAnErrorAndLeavesNoIndex) {
  const std::string folder = scratch_folder() + "/full";
  std::string line = "trap '' XFSZ; ulimit -f 40; exec";
  for (const std::string& word : command(folder)) line += " '" + word + "'";
  const Finished full = run({"/bin/bash", "-c", line}, 120);
  EXPECT_EQ(full.exit_code, 1) << full.output;
  EXPECT_NE(full.output.find("error io: cannot write"), std::string::npos) << full.output;
  EXPECT_FALSE(fs::exists(folder + "/frozen.json"));
  EXPECT_FALSE(fs::exists(folder + "/frozen.bin"));
  const Finished done = freeze(folder);
  EXPECT_EQ(done.exit_code, 0) << done.output;
  EXPECT_EQ(differing(folder, whole()), std::vector<std::string>());
}

TEST_F(Freeze, AFolderThatCannotBeMadeIsAnError) {
  const std::string parent = scratch_folder();
  std::ofstream(parent + "/file") << "x";
  const Finished done = freeze(parent + "/file/below");
  EXPECT_EQ(done.exit_code, 1) << done.output;
  EXPECT_NE(done.output.find("error io"), std::string::npos) << done.output;
}

TEST_F(Freeze, OptionsThatMakeNoSenseAreErrors) {
  const std::string out = scratch_folder() + "/none";
  const std::vector<std::vector<std::string>> wrong = {{"--mb", "nan"},
                                                       {"--mb", "-1"},
                                                       {"--mb", "0"},
                                                       {"--mb", "1e30"},
                                                       {"--mb", "0.2"},
                                                       {"--error", "0"},
                                                       {"--error", "inf"},
                                                       {"--box", "1,2,3"},
                                                       {"--box", "1,0,0,0,0,0"},
                                                       {"--box", "nan,0,0,1,1,1"},
                                                       {"--box", "0,0,0,1e300,1,1"},
                                                       {"--shard", "3/2"},
                                                       {"--shard", "-1/2"},
                                                       {"--size", "0x0"},
                                                       {"--size", "big"},
                                                       {"--fov", "nan"},
                                                       {"--codec", "gif"},
                                                       {"--eyes", "100000"}};
  for (const std::vector<std::string>& more : wrong) {
    std::vector<std::string> line = {binary("mirage-freeze"), kScene, "--out", out};
    if (more.front() == "--mb" && more.back() == "0.2") line = command(out);
    line.insert(line.end(), more.begin(), more.end());
    const Finished done = run(line, 120);
    EXPECT_EQ(done.exit_code, 2) << more.front() << " " << more.back() << ": " << done.output;
    EXPECT_FALSE(fs::exists(out + "/frozen.json"));
  }
  const Finished missing = run({binary("mirage-freeze"), "no-such.glb", "--out", out}, 60);
  EXPECT_EQ(missing.exit_code, 3) << missing.output;
}

TEST_F(Freeze, ADryRunWritesNothing) {
  const std::string out = scratch_folder() + "/dry";
  const Finished done = freeze(out, {"--dry-run"});
  EXPECT_EQ(done.exit_code, 0) << done.output;
  EXPECT_NE(done.output.find(" MB"), std::string::npos) << done.output;
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace mirage::test
