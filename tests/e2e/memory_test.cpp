// Memory stays within its budgets: graphics memory of tiles and of geometry, and the viewer's
// resident memory in a scene far larger than what it shows.
#include <gtest/gtest.h>

#include <map>

#include "tests/support/metrics.h"
#include "tests/support/viewed.h"

namespace mirage::test {
namespace {

Viewed walk(const std::string& scene, int frames, const std::string& more) {
  const Server server(scene);
  EXPECT_TRUE(server.ready()) << server.log();
  return view(server,
              "--offscreen 640x360 --path builtin:walk --fps 5 "
              "--net rtt=50,rate=50,server-ms=1,seed=1 --frames " +
                  std::to_string(frames) + " " + more);
}

// There is more to show than either budget holds.
TEST(Memory, GraphicsMemoryStaysWithinItsBudgets) {
  const Viewed walked = walk("builtin:field?instances=10000", 30,
                             "--atlas-mb 9 --mesh-mb 1 --tau 0.25 --mesh-radii 0 --relight always");
  ASSERT_TRUE(walked.stats.is_object());
  const nlohmann::json& memory = walked.stats["memory"];
  EXPECT_LE(memory["atlas"], memory["atlas_budget"]);
  EXPECT_LE(memory["geometry"], memory["geometry_budget"]);
  const std::size_t most = memory["atlas_budget"].get<std::size_t>() +
                           memory["geometry_budget"].get<std::size_t>() +
                           memory["shadows"].get<std::size_t>() +
                           memory["view"].get<std::size_t>() + memory["target"].get<std::size_t>();
  EXPECT_LE(memory["view"], 640 * 360 * 15) << "colours; a vertex and six indices a cell";
  EXPECT_LE(walked.stats["gpu_bytes_max"], most);
  EXPECT_GT(walked.stats["uploads"]["bytes"], memory["atlas_budget"]) << "too little to ask for";
  EXPECT_GT(memory["geometry"], 0);
}

// The server's graphics memory: what does not fit is refused, at start or when it is asked for.
TEST(Memory, TheServersGraphicsMemoryStaysWithinItsBudget) {
  const Server none("builtin:knot", {"--gpu-mb", "1"});
  EXPECT_FALSE(none.ready());
  EXPECT_NE(none.log().find("error graphics-gl: "), std::string::npos) << none.log();
  const Server server("builtin:knot", {"--gpu-mb", "32", "--metrics"});
  ASSERT_TRUE(server.ready()) << server.log();
  const auto look = [](const Server& at, const char* samples) {
    return run({binary("mirage-view"), at.url(), "--offscreen", "640x360", "--path",
                "builtin:orbit", "--frames", "9", "--virtual-time", "--net", "rtt=20,server-ms=1",
                "--method", "quad", "--reference", "8", "--reference-samples", samples});
  };
  // Full renders take 14 MB, however many samples they have.
  for (const char* samples : {"2", "4"}) {
    const Finished seen = look(server, samples);
    EXPECT_EQ(seen.exit_code, 0) << seen.output;
  }
  std::map<std::string, double> m = metrics(server);
  EXPECT_LE(m["gpu_most_bytes"], 32 << 20);
  EXPECT_GT(m["gpu_most_bytes"], m["gpu_scene_bytes"] + m["gpu_target_bytes"]);
  EXPECT_GT(m["tiles_rendered_total"], 0);
  const Server tight("builtin:knot", {"--gpu-mb", "16"});
  ASSERT_TRUE(tight.ready()) << tight.log();
  const Finished refused = look(tight, "2");
  EXPECT_NE(refused.exit_code, 0) << refused.output;
  EXPECT_NE(refused.output.find("the frame is too large"), std::string::npos) << refused.output;
}

// It takes 143 MB on a software renderer, whose own code is a third of that and which holds all
// graphics memory. A tenth of a scene's instances would not fit into the rest.
TEST(Memory, AMillionInstancesTakeTheViewerAQuarterOfAGigabyteAtMost) {
  const Viewed walked = walk("builtin:field?instances=1000000", 10, {});
  EXPECT_LE(walked.run.peak_mb, 256);
}

}  // namespace
}  // namespace mirage::test
