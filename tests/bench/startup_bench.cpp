// Start-up benchmarks: how long a server takes until it is ready, and what its first tile costs
// beside later ones.
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "client/native/native_link.h"
#include "protocol/base/limits.h"
#include "protocol/codec/codec_id.h"
#include "server/prepare/prepared_scene.h"
#include "tests/bench/bench.h"
#include "tests/support/large_scene.h"
#include "tests/support/process.h"

namespace mirage::bench {
namespace {

using SteadyTime = std::chrono::steady_clock;

double seconds_since(SteadyTime::time_point start) {
  return std::chrono::duration<double>(SteadyTime::now() - start).count();
}

// ---- the first tile -----------------------------------------------------------------------------

/// A client that asks for one tile at a time.
class OneTileClient {
 public:
  explicit OneTileClient(const std::string& url) : link_(*parse_url(url)) {}

  Result<void> greet() {
    if (!link_.wait_connected(10'000)) return no_answer();
    wire::HelloT hello;
    hello.version_min = hello.version_max = limits::kProtocolVersion;
    hello.codecs = {static_cast<std::uint8_t>(TileCodec::kZstd)};
    link_.send(encode_message(std::move(hello)));
    return wait_for(wire::Body::Welcome);
  }
  /// Returns the seconds from request to reply, for 128 texels of an object from a direction that
  /// no two calls share.
  Result<double> tile(std::uint32_t instance, std::uint32_t object, std::uint8_t channels) {
    const double turn = 2.399963 * ++request_;
    const ViewCell cell =
        *view_cell_from_direction({std::cos(turn), 0.3, std::sin(turn)}, limits::kMaxViewLevel);
    const DistanceBucket distance = *distance_bucket_from_radii(6, 3);
    std::uint8_t size = 0;
    while (tile_edge(size) < 128) ++size;
    wire::RequestBatchT batch;
    batch.credit_bytes = 1u << 30;
    batch.asks = {wire::Ask(request_, instance, object, 1.0f, 0, distance.index, cell.x, cell.y,
                            cell.level, distance.level, size, channels, 0)};
    const auto asked = SteadyTime::now();
    link_.send(encode_message(std::move(batch)));
    if (Result<void> came = wait_for(wire::Body::TileReply); !came) return came.error();
    return seconds_since(asked);
  }

 private:
  static Error no_answer() { return make_error(ErrorId::kNetworkTimeout, "no answer"); }
  Result<void> wait_for(wire::Body body) {
    for (int patience = 0; patience < 100 && link_.connected(); ++patience) {
      for (const Message& message : link_.receive()) {
        if (message.body.type == body) return {};
      }
      link_.wait_message(100);
    }
    return no_answer();
  }

  NativeLink link_;
  std::uint32_t request_ = 0;
};

Result<std::vector<Row>> first_tile(const Conditions& conditions) {
  constexpr const char* kScene = "builtin:forest?trees=60";
  constexpr double kGoal = 1.5;
  const auto scene = load_scene(kScene);
  if (!scene) return scene.error();
  // The object with the most triangles: a tree, with alpha tests.
  const std::vector<Instance>& instances = (*scene)->scene.instances;
  const auto triangles = [&](const Instance& i) { return (*scene)->objects[i.object].triangles; };
  const auto largest = std::max_element(
      instances.begin(), instances.end(),
      [&](const Instance& a, const Instance& b) { return triangles(a) < triangles(b); });
  const auto index = static_cast<std::uint32_t>(largest - instances.begin());
  std::vector<Row> rows;
  for (const std::uint8_t channels : {kLitTile, kRelitTile}) {
    std::vector<double> firsts, later, ratios;
    for (int round = 0; round < (conditions.quick ? 3 : 7); ++round) {
      const test::Server server(kScene);
      if (!server.ready()) return make_error(ErrorId::kInternal, "no server: " + server.log());
      OneTileClient client(server.url());
      if (Result<void> greeted = client.greet(); !greeted) return greeted.error();
      std::vector<double> ms;
      for (int i = 0; i < 16; ++i) {
        const Result<double> next = client.tile(index, largest->object, channels);
        if (!next) return next.error();
        ms.push_back(1e3 * *next);
      }
      firsts.push_back(ms[0]);
      later.push_back(middle({ms.begin() + 1, ms.end()}).median);
      ratios.push_back(firsts.back() / later.back());
    }
    const Middle ratio = middle(ratios);
    rows.push_back({fmt::format("first {} tile after ready, a tree at 128 texels",
                                channels == kLitTile ? "lit" : "relit"),
                    fmt::format("{:.1f} ms", middle(firsts).median),
                    fmt::format("the next ones: {:.1f} ms", middle(later).median), ratio.median,
                    "<= 1.5", ratio.median <= kGoal, ratio.spread_pct,
                    fmt::format("{} servers, request to reply", ratios.size())});
  }
  return rows;
}

// ---- loading ------------------------------------------------------------------------------------

/// Times from starting a server to its ready line.
struct StartUp {
  double seconds = 0;
  double cpu_s = 0;  ///< user and system, of all threads
};

// Returns the user and system time that a process has used so far, s.
double cpu_seconds_of(int pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string skipped;
  std::getline(file, skipped, ')');
  for (int i = 3; i < 14; ++i) file >> skipped;
  double user = 0, system = 0;
  file >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

Result<StartUp> start_up(const std::string& scene, const std::vector<std::string>& options) {
  const auto began = SteadyTime::now();
  const test::Server server(scene, options);
  const double seconds = seconds_since(began);
  if (!server.ready()) return make_error(ErrorId::kInternal, "no server: " + server.log());
  return StartUp{seconds, cpu_seconds_of(server.pid())};
}

struct LargeFile {
  const char* name;
  test::LargeScene shape;
  double goal_s;
};

Result<std::vector<Row>> load(const LargeFile& file, int rounds) {
  const std::string folder = test::scratch_folder(), path = folder + "/large.glb";
  const std::string cache = folder + "/cache";
  const Result<std::uint64_t> bytes = test::write_large_glb(path, file.shape);
  if (!bytes) return bytes.error();
  std::vector<StartUp> cold, cached;
  for (int round = 0; round < rounds; ++round) {
    const Result<StartUp> without = start_up(path, {});
    if (!without) return without.error();
    cold.push_back(*without);
    if (round == 0) {  // fills the cache
      if (Result<StartUp> filled = start_up(path, {"--cache-dir", cache}); !filled) {
        return filled.error();
      }
    }
    const Result<StartUp> with = start_up(path, {"--cache-dir", cache});
    if (!with) return with.error();
    cached.push_back(*with);
  }
  std::vector<Row> rows;
  for (const auto& [how, starts] :
       {std::pair{"no cache", cold}, std::pair{"from the cache", cached}}) {
    std::vector<double> seconds, cpu_s;
    for (const StartUp& start : starts) {
      seconds.push_back(start.seconds);
      cpu_s.push_back(start.cpu_s);
    }
    const Middle s = middle(seconds);
    Row row;
    row.what = fmt::format("start to ready, {}, {}", file.name, how);
    row.ours = fmt::format("{:.2f} s, {:.2f} CPU s", s.median, middle(cpu_s).median);
    row.beside = fmt::format("goal: {:g} s", file.goal_s);
    row.ratio = s.median / file.goal_s;
    row.goal = "<= 1";
    row.met = row.ratio <= 1;
    if (seconds.size() > 1) row.spread_pct = s.spread_pct;
    row.note = fmt::format("{:.1f} MB, {} meshes, {} images", 1e-6 * static_cast<double>(*bytes),
                           file.shape.meshes, file.shape.textures);
    rows.push_back(row);
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  return rows;
}

Result<std::vector<Row>> startup(const Conditions& conditions) {
  const LargeFile files[] = {
      {"600,000 triangles", {.triangles = 600'000, .meshes = 8}, 2},
      {"600,000 triangles in one mesh", {.triangles = 600'000, .meshes = 1}, 2},
      {"100 MB", {.triangles = 2'200'000, .meshes = 24, .textures = 18}, 6}};
  Result<std::vector<Row>> rows = first_tile(conditions);
  if (!rows) return rows;
  for (const LargeFile& file : files) {
    if (conditions.quick && &file != &files[0]) continue;  // the others take minutes with all cores
    const Result<std::vector<Row>> more = load(file, conditions.quick ? 1 : 5);
    if (!more) return more;
    rows->insert(rows->end(), more->begin(), more->end());
  }
  return rows;
}

}  // namespace

std::vector<Bench> startup_benches() {
  return {{"startup", "a server's start, and its first tile", startup}};
}

}  // namespace mirage::bench
