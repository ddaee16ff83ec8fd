// The reference lists every figure that programs write, and nothing else.

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "tests/support/process.h"
#include "tests/support/viewed.h"

namespace mirage::test {
namespace {

using Names = std::set<std::string>;

/// The figures of a page of the reference.
Names listed(const std::string& page) {
  Names out;
  const std::regex row("\\| `([^`]+)` \\|");
  for (std::sregex_iterator at(page.begin(), page.end(), row), end; at != end; ++at) {
    out.insert((*at)[1]);
  }
  return out;
}

/// The names of all values, with dots for nesting. The parts of `open` have keys that depend on
/// the run; they stand as the name given there.
Names written(const nlohmann::json& json, const std::map<std::string, std::string>& open,
              const std::string& before = "") {
  Names out;
  for (const auto& [key, value] : json.items()) {
    const auto generic = open.find(before);
    const std::string name = before + (generic == open.end() ? key : generic->second);
    if (value.is_object()) {
      out.merge(written(value, open, name + "."));
    } else {
      out.insert(name);
    }
  }
  return out;
}

Names missing(const Names& from, const Names& in) {
  Names out;
  std::set_difference(from.begin(), from.end(), in.begin(), in.end(),
                      std::inserter(out, out.end()));
  return out;
}

TEST(Reference, ListsTheStatisticsOfTheViewer) {
  const Server server("builtin:knot", {"--codec", "webp"});
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string folder = scratch_folder(), file = folder + "/stats.json";
  const Finished done = run({binary("mirage-view"),
                             server.url(),
                             "--offscreen",
                             "160x90",
                             "--frames",
                             "20",
                             "--path",
                             "builtin:orbit",
                             "--light",
                             "builtin:sun-sweep",
                             "--virtual-time",
                             "--net",
                             "rtt=20,rate=20,server-ms=5,seed=1",
                             "--device-model",
                             "software",
                             "--frame-ms",
                             "50",
                             "--codec",
                             "webp",
                             "--reference",
                             "1",
                             "--stats",
                             file});
  ASSERT_EQ(done.exit_code, 0) << done.output;
  Names found = written(nlohmann::json::parse(read_file(file)), {{"codecs.", "NAME"}});
  found.merge(written(nlohmann::json::parse(read_file(folder + "/stats.real_time.json")), {}));
  const Names page = listed(run({binary("mirage-view"), "--help-statistics"}).output);
  EXPECT_EQ(missing(found, page), Names{}) << "written and not explained";
  // Real time measures how far prices were off; on virtual time they are the device model's.
  EXPECT_EQ(missing(page, found), (Names{"price_error.p50", "price_error.p90"}))
      << "explained and not written";
}

TEST(Reference, ListsTheStatisticsOfTheLoadClient) {
  const Server server("builtin:knot", {"--metrics"});
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string file = scratch_folder() + "/load.json";
  const Finished done = run({binary("mirage-load"), server.url(), "--clients", "2", "--duration",
                             "1", "--rate", "2", "--path", "builtin:orbit", "--json", file});
  ASSERT_EQ(done.exit_code, 0) << done.output;
  nlohmann::json json = nlohmann::json::parse(read_file(file));
  json["errors"]["busy"] = 1;  // none of it in a run that goes well
  const Names found = written(json, {{"errors.", "ID"}});
  const Names page = listed(run({binary("mirage-load"), "--help-statistics"}).output);
  EXPECT_EQ(found, page);
}

}  // namespace
}  // namespace mirage::test
