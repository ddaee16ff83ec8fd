// Options of programs from a configuration file and from the environment.

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "protocol/base/cli.h"
#include "tests/support/process.h"

namespace mirage::test {
namespace {

const std::vector<std::string> kPrograms = {
    "mirage-server", "mirage-view",    "mirage-freeze", "mirage-bake",  "mirage-load",
    "mirage-report", "mirage-extreme", "mirage-sheet",  "mirage-token", "mirage-bench"};

std::string config(const std::string& text) {
  static int number = 0;
  const std::string path = scratch_folder() + "/config" + std::to_string(++number) + ".toml";
  std::ofstream(path) << text;
  return path;
}

/// Runs the server with this configuration and environment; it lists devices and ends.
Finished list_devices(const std::string& config_file, const std::string& variable = "X=y") {
  std::vector<std::string> command = {"/usr/bin/env", variable, binary("mirage-server"),
                                      "--list-devices"};
  if (!config_file.empty()) command.insert(command.end(), {"--config", config_file});
  return run(command);
}

void expect_usage_error(const Finished& done, const std::string& named) {
  EXPECT_EQ(done.exit_code, 2) << done.output;
  EXPECT_NE(done.output.find("error usage:"), std::string::npos) << done.output;
  EXPECT_NE(done.output.find(named), std::string::npos) << done.output;
}

// A misspelt token file must not open a server to everybody.
TEST(Options, UnknownKeysOfAConfigFileAreErrors) {
  const std::string file = config("cache-mb = 64\ntoken_file = \"/etc/mirage/token\"\n");
  const Finished done = list_devices(file);
  expect_usage_error(done, "token_file");
  EXPECT_NE(done.output.find("did you mean token-file?"), std::string::npos) << done.output;
  expect_usage_error(list_devices(config("[server]\ncache-mb = 64\n")), "section [server]");
}

TEST(Options, WhatIsNoTomlIsAnError) {
  expect_usage_error(list_devices(config("these are words\n")), "these are words");
  expect_usage_error(list_devices(config("[cache-mb\n")), "cache-mb");
  expect_usage_error(list_devices(config("cache-mb = lots\n")), "cache-mb");
  expect_usage_error(list_devices(config("\x01\x02\xff\xfe")), "config");
  expect_usage_error(list_devices("/nonexistent.toml"), "/nonexistent.toml");
}

TEST(Options, AGoodConfigFileIsTaken) {
  const Finished done = list_devices(config("# a comment\n\ncache-mb = 64\nmetrics = true\n"));
  EXPECT_EQ(done.exit_code, 0) << done.output;
}

TEST(Options, AConfigurationCanBeCheckedWithoutServing) {
  const std::string tokens = scratch_folder() + "/tokens";
  const auto check = [&](const std::string& text) {
    std::ofstream(tokens) << text;
    return run({binary("mirage-server"), "builtin:knot", "--check-config", "--token-file", tokens},
               5);
  };
  const Finished good = check("a-secret-of-many-bytes name=anna\n");
  EXPECT_EQ(good.exit_code, 0) << good.output;
  EXPECT_NE(good.output.find("the configuration is good"), std::string::npos);
  EXPECT_EQ(good.output.find("can be guessed"), std::string::npos) << good.output;
  EXPECT_NE(check("secret name=anna\n")
                .output.find("the token of 'anna' has 6 characters: fewer than 16 can be guessed"),
            std::string::npos);
  const std::string scene = scratch_folder() + "/scene.gltf";
  std::ofstream(scene) << "{\"asset\": {\"version\": \"2.0\"},\n \"nodes\": [,]}\n";
  const Finished broken = run({binary("mirage-server"), scene, "--check-config"}, 5);
  EXPECT_EQ(broken.exit_code, 3) << broken.output;
  EXPECT_NE(broken.output.find("JSON syntax error in line 2, column 12"), std::string::npos)
      << broken.output;
  expect_usage_error(check("secret nam=anna\n"), "line 1");
  expect_usage_error(check(""), "no token");
}

TEST(Options, UnknownVariablesAreErrors) {
  const Finished done = list_devices("", "MIRAGE_TOKEN_FLE=/etc/mirage/token");
  expect_usage_error(done, "MIRAGE_TOKEN_FLE");
  EXPECT_NE(done.output.find("did you mean MIRAGE_TOKEN_FILE?"), std::string::npos) << done.output;
  EXPECT_EQ(list_devices("", "MIRAGE_CACHE_MB=64").exit_code, 0);
  EXPECT_EQ(list_devices("", "MIRAGE_FRAME_MS=50").exit_code, 0) << "another program's";
  for (const char* of_the_demo :
       {"MIRAGE_DEMO_BIN=x", "MIRAGE_DEMO_FRAMES=10", "MIRAGE_DEMO_OUT=x"}) {
    EXPECT_EQ(list_devices("", of_the_demo).exit_code, 0) << of_the_demo;
  }
  expect_usage_error(list_devices("", "MIRAGE_CACHE_MB=lots"), "cache-mb");
}

TEST(Options, TheListOfAllProgramsOptionsIsCurrent) {
  std::set<std::string> found;
  const std::regex name("\\| `(?:-[a-z],)?--([a-z-]+)");
  for (const std::string& program : kPrograms) {
    const std::string page = run({binary(program), "--help-markdown"}).output;
    for (std::sregex_iterator at(page.begin(), page.end(), name), end; at != end; ++at) {
      const std::string option = (*at)[1];
      const bool common = option == "version" || option == "config" || option.rfind("help", 0) == 0;
      if (!common) found.insert(environment_name(option));
    }
  }
  const std::set<std::string> hidden = {"MIRAGE_CHILD", "MIRAGE_FOLDER"};  // of mirage-extreme
  found.insert(hidden.begin(), hidden.end());
  std::set<std::string> listed;
  for (const std::string& option : options_of_all_programs()) {
    listed.insert(environment_name(option));
  }
  EXPECT_EQ(listed, found);
}

// People read --help from the top: the options used first come first, in groups, on lines that fit
// a terminal.
TEST(Options, HelpIsInGroupsOnLinesThatFit) {
  for (const std::string& program : kPrograms) {
    const Finished done = run({binary(program), "--help"});
    EXPECT_EQ(done.exit_code, 0) << program;
    EXPECT_NE(done.output.find("\nAll programs:\n"), std::string::npos) << program;
    EXPECT_EQ(done.output.find("Env:"), std::string::npos) << program;
    std::istringstream lines(done.output);
    std::string before;
    int options_in_group = 0, most = 0;
    for (std::string line; std::getline(lines, line); before = line) {
      const bool heading = !line.empty() && line.front() != ' ' && line.back() == ':';
      if (heading) options_in_group = 0;
      if (line.rfind("  -", 0) == 0) most = std::max(most, ++options_in_group);
      std::size_t columns = 0;  // of UTF-8, where later bytes of a letter begin with 10
      for (const char c : line) columns += (static_cast<unsigned char>(c) & 0xc0) != 0x80;
      EXPECT_LE(columns, 100u) << program << ": " << line;
    }
    EXPECT_LE(most, 14) << program << ": a group that is too long to be read";
  }
}

TEST(Options, EveryErrorHasACauseAndACure) {
  const std::string text = run({binary("mirage-server"), "--help-errors"}).output;
  const std::string codes = run({binary("mirage-server"), "--help-exit-codes"}).output;
#define MIRAGE_X(e, id, exit, close, cause, cure)                                 \
  EXPECT_NE(text.find("### " id "\n**Cause.** " cause), std::string::npos) << id; \
  EXPECT_NE(text.find(cure), std::string::npos) << id;                            \
  EXPECT_GT(std::string(cause).size() + std::string(cure).size(), 40u) << id;     \
  EXPECT_NE(codes.find("[" id "](../guide/troubleshooting.md#" id ")"), std::string::npos) << id;
  MIRAGE_ERRORS(MIRAGE_X)
#undef MIRAGE_X
}

}  // namespace
}  // namespace mirage::test
