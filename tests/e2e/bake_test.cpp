// Bakes of the shipped program: files, errors, shards, and what happens when it is interrupted.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/support/colored_box.h"
#include "tests/support/process.h"
#include "tests/support/small_disk.h"

namespace mirage::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::vector<std::string> kSmall = {"--grid", "4", "--size", "128"};

Finished bake(const std::string& scene, const std::string& out,
              const std::vector<std::string>& more = {}) {
  std::vector<std::string> command = {binary("mirage-bake"), scene, "--out", out};
  command.insert(command.end(), kSmall.begin(), kSmall.end());
  command.insert(command.end(), more.begin(), more.end());
  return run(command, 300);
}

/// Returns the bytes of all files that do not begin with a dot, by name.
std::map<std::string, std::string> files_of(const std::string& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).string();
    if (entry.is_regular_file() && name[0] != '.') out[name] = read_file(entry.path().string());
  }
  return out;
}

json json_of(const std::string& path) { return json::parse(read_file(path)); }

TEST(Bake, WritesPicturesAndTheirError) {
  const std::string out = scratch_folder();
  const Finished done =
      run({binary("mirage-bake"), "builtin:knot", "--out", out, "--grid", "8", "--size", "1024"});
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const json object = json_of(out + "/torus_knot.json");
  EXPECT_EQ(object["grid"], 8);
  EXPECT_EQ(object["tile_px"], 128);
  for (const json& file : object["files"]) {
    EXPECT_EQ(fs::file_size(out + "/" + file["name"].get<std::string>()), file["bytes"]) << file;
  }
  std::map<std::string, double> db;
  for (const json& row : object["error"]) db[row["method"]] = row["psnr_db"];
  // Two cores, llvmpipe: 21.6, 22.7 and 33.2 dB.
  EXPECT_GT(db["nearest"], 19);
  EXPECT_GT(db["blend"], db["nearest"]);
  EXPECT_GT(db["depth"], db["blend"] + 6);
  EXPECT_EQ(json_of(out + "/index.json")["missing"].size(), 0u);
}

TEST(Bake, ChoosesFramesAndTexelsForAnError) {
  const std::string out = scratch_folder();
  const Finished done =
      run({binary("mirage-bake"), "builtin:knot", "--out", out, "--error", "26"}, 300);
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const json object = json_of(out + "/torus_knot.json");
  EXPECT_LE(object["size_px"], 1024) << "more than needed";
  for (const json& row : object["error"]) {
    if (row["method"] != "depth") continue;
    EXPECT_GT(row["psnr_db"], 25) << "of directions held out";
  }
}

TEST(Bake, ShardsMakeTheBytesOfOneRun) {
  const std::string one = scratch_folder(), four = scratch_folder();
  const std::vector<std::string> objects = {"--object", "*lamp*", "--object",  "*mug",
                                            "--object", "book*",  "--measure", "quick"};
  ASSERT_EQ(bake("builtin:clutter", one, objects).exit_code, 0);
  for (const char* shard : {"3/4", "1/4", "4/4", "2/4"}) {
    std::vector<std::string> more = objects;
    more.insert(more.end(), {"--shard", shard});
    const Finished done = bake("builtin:clutter", four, more);
    ASSERT_EQ(done.exit_code, 0) << done.output;
  }
  const auto due = files_of(one), made = files_of(four);
  EXPECT_GT(due.size(), 30u);
  ASSERT_EQ(made.size(), due.size());
  for (const auto& [name, bytes] : due) EXPECT_TRUE(made.at(name) == bytes) << name;
}

TEST(Bake, GoesOnAfterItWasKilled) {
  const std::string whole = scratch_folder(), broken = scratch_folder();
  const std::vector<std::string> objects = {"--object", "*book*", "--object", "*lamp*"};
  ASSERT_EQ(bake("builtin:clutter", whole, objects).exit_code, 0);
  const auto due = files_of(whole);
  std::vector<std::string> command = {binary("mirage-bake"), "builtin:clutter", "--out", broken};
  command.insert(command.end(), kSmall.begin(), kSmall.end());
  command.insert(command.end(), objects.begin(), objects.end());
  for (int round = 0; round < 4; ++round) {
    const pid_t child = fork();
    if (child == 0) {
      std::vector<char*> words;
      for (std::string& word : command) words.push_back(word.data());
      words.push_back(nullptr);
      if (!std::freopen("/dev/null", "w", stderr)) _exit(1);
      execv(words[0], words.data());
      _exit(1);
    }
    const std::size_t before = files_of(broken).size();
    soon([&] { return files_of(broken).size() >= before + 2; }, 60);
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    for (const auto& [name, bytes] : files_of(broken)) {
      if (name == "index.json") continue;
      ASSERT_TRUE(due.at(name) == bytes) << name << " is not whole";
    }
  }
  // The system ends it in the middle of a file that is larger than 4 KiB.
  std::string line = "ulimit -f 8; exec";
  for (const std::string& word : command) line += " '" + word + "'";
  fs::remove(broken + "/floor_lamp.color.png");
  EXPECT_EQ(run({"/bin/sh", "-c", line}).exit_code, 128 + SIGXFSZ);
  for (const auto& [name, bytes] : files_of(broken)) {
    if (name == "index.json") continue;
    ASSERT_TRUE(due.at(name) == bytes) << name << " is not whole";
  }
  EXPECT_TRUE(fs::exists(broken + "/.bake")) << "with what the killed run had begun";
  // A file that is cut, or lost, is made again.
  const Finished resumed = bake("builtin:clutter", broken, objects);
  ASSERT_EQ(resumed.exit_code, 0) << resumed.output;
  EXPECT_NE(resumed.output.find("is there already"), std::string::npos) << resumed.output;
  fs::resize_file(broken + "/floor_lamp.color.png", 100);
  fs::remove(broken + "/book.normal.png");
  ASSERT_EQ(bake("builtin:clutter", broken, objects).exit_code, 0);
  EXPECT_TRUE(files_of(broken) == due);
  EXPECT_FALSE(fs::exists(broken + "/.bake")) << "what only a run needs";
}

TEST(Bake, KeepsRunsApart) {
  const std::string out = scratch_folder();
  ASSERT_EQ(bake("builtin:knot", out).exit_code, 0);
  const Finished other = bake("builtin:knot", out, {"--samples", "1"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.output.find("holds another bake"), std::string::npos) << other.output;
  EXPECT_EQ(bake("builtin:knot", out, {"--samples", "1", "--replace"}).exit_code, 0);
  fs::create_directory(out + "/.bake");
  const int lock = open((out + "/.bake/lock").c_str(), O_RDWR | O_CREAT, 0644);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);
  const Finished second = bake("builtin:knot", out, {"--samples", "1"});
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_NE(second.output.find("another run writes"), std::string::npos) << second.output;
  close(lock);
}

TEST(Bake, AFullDiskIsSaid) {
  const std::string folder = scratch_folder() + "/disk";
  const SmallDisk disk(folder);
  if (!disk.mounted()) GTEST_SKIP() << "only root may mount a disk";
  const Finished done = run({binary("mirage-bake"), "builtin:knot", "--out", folder});
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_NE(done.output.find("error io: cannot write"), std::string::npos) << done.output;
  for (const auto& [name, bytes] : files_of(folder)) {
    EXPECT_FALSE(name.ends_with(".json")) << name << " names files that are not there";
  }
}

TEST(Bake, SaysWhatIsWrong) {
  const std::string out = scratch_folder();
  const std::pair<std::vector<std::string>, const char*> wrong[] = {
      {{"--grid", "0"}, "--grid 0 is outside"},
      {{"--grid", "1"}, "--grid 1 is outside"},
      {{"--grid", "1000"}, "--grid 1000 is outside"},
      {{"--size", "7"}, "leaves frames of"},
      {{"--target", "nobody"}, "no target is called"},
      {{"--object", "nothing"}, "no object is called"},
      {{"--error", "nan"}, "--error is outside"},
      {{"--shard", "5/4"}, "is no shard"},
      {{"--maps", "color,smell"}, "no map is called"},
      {{"--layout", "cube"}, "no layout is called"},
      {{"--target", "unity-imp", "--grid", "13"}, "odd grid"},
      {{"--target", "three", "--layout", "octahedral"}, "has no layout"}};
  for (const auto& [options, text] : wrong) {
    std::vector<std::string> command = {binary("mirage-bake"), "builtin:knot", "--out", out};
    command.insert(command.end(), options.begin(), options.end());
    const Finished done = run(command);
    EXPECT_EQ(done.exit_code, 2) << text;
    EXPECT_NE(done.output.find(text), std::string::npos) << done.output;
    EXPECT_EQ(done.output.find("error usage: "), 0u) << done.output;
  }
  EXPECT_TRUE(files_of(out).empty());
  EXPECT_EQ(bake("no-such-file.glb", out).exit_code, 3);
}

/// Returns the height above the centre, in radii, that a picture of normals has at a texel.
double height_at(const std::string& png, int x, int y) {
  const auto in = OIIO::ImageInput::open(png);
  if (!in || in->spec().nchannels != 4) return -9;
  const int width = in->spec().width;
  std::vector<float> texels(in->spec().image_pixels() * 4);
  if (!in->read_image(0, 0, 0, 4, OIIO::TypeDesc::FLOAT, texels.data())) return -9;
  return 2 * texels[4 * (std::size_t(y) * width + x) + 3] - 1;
}

TEST(Bake, WhatStandsBehindGlassKeepsItsPlace) {
  Builder b = box_builder(kRed);
  b.doc["materials"].push_back(
      {{"pbrMetallicRoughness", {{"baseColorFactor", {0, 1, 0, 0.3}}}}, {"alphaMode", "BLEND"}});
  b.doc["meshes"].push_back(b.doc["meshes"][0]);
  b.doc["meshes"][1]["primitives"][0]["material"] = 1;
  b.doc["nodes"] = {{{"mesh", 0}, {"scale", {0.5, 0.5, 0.5}}}, {{"mesh", 1}}};
  b.doc["scenes"] = {{{"nodes", {0, 1}}}};
  const std::string scene = scratch_folder() + "/vitrine.glb", out = scratch_folder();
  std::ofstream(scene, std::ios::binary) << file_of(b);
  const Finished done =
      run({binary("mirage-bake"), scene, "--out", out, "--whole", "--grid", "3", "--size", "192",
           "--layout", "hemi", "--maps", "color,normal", "--measure", "none"});
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const json object = json_of(out + "/vitrine.json");
  const double radius = object["radius"];
  // The frame in the middle looks down on a box of .5 within one of 1.
  const std::string normals = out + "/vitrine.normal.png";
  EXPECT_NEAR(height_at(normals, 96, 96), 0.5 / radius, 0.01) << "the box";
  EXPECT_NEAR(height_at(normals, 96 + int(0.75 / radius * 32), 96), 1 / radius, 0.01) << "glass";
}

TEST(Bake, NamesFromFilesStayInTheFolder) {
  Builder b = box_builder(kRed);
  b.doc["meshes"][0]["name"] = "../../out of here/\"'; rm -rf *\n";
  const std::string scene = scratch_folder() + "/a.glb", out = scratch_folder() + "/in/out";
  std::ofstream(scene, std::ios::binary) << file_of(b);
  for (const char* target : {"generic", "godot4", "unreal", "unity-imp", "boimp", "three"}) {
    const std::string folder = out + target;
    const Finished done = run(
        {binary("mirage-bake"), scene, "--out", folder, "--target", target, "--measure", "none"});
    EXPECT_EQ(done.exit_code, 0) << target << ": " << done.output;
    EXPECT_GT(files_of(folder).size(), 2u);
  }
  for (const auto& [name, bytes] : files_of(fs::path(out).parent_path().string())) {
    EXPECT_EQ(name.find_first_of(" \"';*\n"), std::string::npos) << name;
    EXPECT_EQ(name.find(".."), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace mirage::test
