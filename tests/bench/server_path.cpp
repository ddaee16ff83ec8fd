#include "tests/bench/server_path.h"

#include <pthread.h>
#include <spdlog/fmt/fmt.h>
#include <time.h>

#include <thread>

#include "client/load/load_clients.h"
#include "protocol/wire/message.h"
#include "server/net/endpoint.h"
#include "server/net/endpoint_options.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/page_packer.h"
#include "server/session/session.h"
#include "server/stage/encode_stage.h"
#include "server/stage/render_options.h"
#include "server/tile/stage_queues.h"
#include "server/tile/tile_encode.h"
#include "server/tile/tile_form.h"
#include "tests/bench/drawn_tiles.h"
#include "tests/bench/stages.h"

namespace mirage::bench {
namespace {

constexpr std::size_t kStoreBytes = 32u << 20;  // soon full, as on a server that has run for long

double clock_s(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double thread_s(std::thread& thread) {
  clockid_t clock = 0;
  pthread_getcpuclockid(thread.native_handle(), &clock);
  return clock_s(clock);
}

/// The shipped server with one encoder and with drawn tiles in place of the render stage.
class ReplayingServer {
 public:
  ReplayingServer(std::shared_ptr<const PreparedScene> scene, std::vector<RenderedTile> drawn)
      : by_object_(scene->object_count()), hub_(scene, session_options(), queues_) {
    for (RenderedTile& tile : drawn) {
      const std::uint32_t object = tile.job.key.object;
      by_object_[object].tiles.push_back(std::move(tile));
    }
    encode_.start(std::move(scene), 1);
  }
  ~ReplayingServer() {
    endpoint_.stop();
    queues_.completions.close();
    queues_.tiles.close();
    if (loop_.joinable()) loop_.join();
    if (replay_.joinable()) replay_.join();
    queues_.close_drawn();
    encode_.join();
  }

  Result<void> start() {
    EndpointOptions options;
    options.address = *parse_listen("127.0.0.1:0");
    options.drain_s = 0;
    if (Result<void> listening = endpoint_.listen(options); !listening) return listening;
    replay_ = std::thread([this] { replay(); });
    loop_ = std::thread([this] { (void)endpoint_.run({}); });
    return {};
  }
  std::string url() const { return fmt::format("ws://127.0.0.1:{}", endpoint_.port()); }
  /// CPU time so far of the thread that stands in for the render stage, and of the network loop, s.
  double replay_s() { return thread_s(replay_); }
  double loop_s() { return thread_s(loop_); }

 private:
  struct Drawn {
    std::vector<RenderedTile> tiles;
    std::size_t next = 0;
  };
  static SessionOptions session_options() {
    SessionOptions options;
    options.view = options.reference = options.geometry = false;
    return options;
  }

  void replay() {
    for (;;) {
      PagePacker packer(RenderOptions{}.page_edge);
      TileQueue::Room room;
      room.fits = [&](std::uint32_t edge) { return packer.add(edge); };
      std::optional<TileQueue::Work> work = queues_.tiles.take(room, true);
      if (!work) return;
      for (const TileJob& job : std::get<std::vector<TileJob>>(*work)) {
        Drawn& drawn = by_object_[job.key.object];
        RenderedTile tile = drawn.tiles[drawn.next++ % drawn.tiles.size()];
        tile.job.id = job.id;  // the key stays that of the pixels, by which they are measured
        queues_.rendered.push(std::move(tile));
      }
    }
  }

  SteadyClock clock_;
  StageQueues queues_{clock_, kStoreBytes, {}};
  std::vector<Drawn> by_object_;
  SessionHub hub_;
  Endpoint endpoint_{hub_, queues_};
  EncodeStage encode_{queues_, [this] { endpoint_.wake(); }};
  std::thread replay_, loop_;
};

/// A client that asks for tiles of the drawn kinds from directions that no two asks share.
class Asker final : private LoadSink {
 public:
  static Result<std::unique_ptr<Asker>> create(const std::string& url, const PreparedScene& scene,
                                               const std::vector<RenderedTile>& drawn) {
    Result<ServerUrl> parsed = parse_url(url);
    if (!parsed) return parsed.error();
    std::unique_ptr<Asker> out(new Asker);
    for (const RenderedTile& tile : drawn) out->keys_.push_back(tile.job.key);
    for (const TileKey& key : out->keys_) {
      std::uint32_t instance = 0;
      while (scene.instance(instance).object != key.object) ++instance;
      out->instances_.push_back(instance);
    }
    Result<std::unique_ptr<LoadClients>> link = LoadClients::create(*parsed, 1, *out);
    if (!link) return link.error();
    out->link_ = link.take();
    out->link_->connect(0);
    return out;
  }

  /// Asks for `count` tiles and waits for them. Errors: the connection ends, or an ask is refused.
  Result<void> ask(std::size_t count) {
    constexpr std::size_t kWindow = 128;
    const std::size_t until = tiles_ + count;
    while (tiles_ < until) {
      while (open_ && asked_ < until && asked_ < tiles_ + kWindow) ask_one();
      link_->service(100'000);
      if (trouble_) return *trouble_;
    }
    return {};
  }
  std::uint64_t bytes() const { return link_->bytes(); }

 private:
  Asker() = default;
  void on_open(std::uint32_t) override {
    wire::HelloT hello;
    hello.version_min = hello.version_max = limits::kProtocolVersion;
    hello.codecs = every_codec();
    link_->send(0, encode_message(std::move(hello)));
    open_ = true;
  }
  Result<void> on_message(std::uint32_t, const std::uint8_t* bytes, std::size_t size) override {
    Result<Message> message = decode_message(bytes, size);
    if (!message) return message.error();
    if (message->body.AsTileReply()) ++tiles_;
    if (message->body.AsRefused()) trouble_ = make_error(ErrorId::kBusy, "an ask was refused");
    return {};
  }
  void on_down(std::uint32_t, const std::string&, const std::string& text) override {
    trouble_ = make_error(ErrorId::kNetworkClosed, text);
  }
  void ask_one() {
    const std::size_t at = asked_ % keys_.size();
    const TileKey& key = keys_[at];
    const auto serial = static_cast<std::uint32_t>(++asked_);
    wire::RequestBatchT batch;
    batch.credit_bytes = std::uint64_t{1} << 40;
    batch.asks.emplace_back(serial, instances_[at], key.object, 1.0f, 0u, key.distance.index,
                            static_cast<std::uint16_t>(serial), static_cast<std::uint16_t>(at),
                            std::uint8_t{16}, key.distance.level, key.size_class, key.channels,
                            key.phase);
    link_->send(0, encode_message(std::move(batch)));
  }

  std::unique_ptr<LoadClients> link_;
  std::vector<TileKey> keys_;
  std::vector<std::uint32_t> instances_;  // of the keys' objects
  bool open_ = false;
  std::size_t asked_ = 0, tiles_ = 0;
  std::optional<Error> trouble_;
};

/// CPU time of a tile, us.
struct Costs {
  double all = 0, queue = 0, loop = 0, cut = 0, code = 0;
  double spread_pct = 0;
  double bytes = 0;  ///< of a tile on the wire
};

/// Times the pure functions of encoding over all tiles.
void time_encoding(const PreparedScene& scene, const std::vector<RenderedTile>& drawn, int rounds,
                   Costs& costs) {
  std::vector<double> cut, code;
  for (int round = 0; round < rounds; ++round) {
    std::vector<Tile> tiles;
    tiles.reserve(drawn.size());
    const auto count = static_cast<double>(drawn.size());
    cut.push_back(seconds(Time::kCpu,
                          [&] {
                            for (const RenderedTile& tile : drawn) {
                              tiles.push_back(
                                  cut_and_measure(tile, *scene.description(tile.job.key.object)));
                            }
                          }) /
                  count);
    code.push_back(seconds(Time::kCpu,
                           [&] {
                             for (const Tile& tile : tiles) make_form(tile, {}, TileCodec::kZstd);
                           }) /
                   count);
  }
  costs.cut = 1e6 * middle(cut).median;
  costs.code = 1e6 * middle(code).median;
}

Result<Costs> measure(const std::shared_ptr<const PreparedScene>& scene,
                      const std::vector<RenderedTile>& drawn, const Conditions& conditions) {
  const int rounds = conditions.quick ? 5 : 15;
  const std::size_t tiles = conditions.quick ? 512 : 2048;
  Costs costs;
  ReplayingServer server(scene, drawn);
  if (Result<void> started = server.start(); !started) return started.error();
  Result<std::unique_ptr<Asker>> asker = Asker::create(server.url(), *scene, drawn);
  if (!asker) return asker.error();
  if (Result<void> asked = (*asker)->ask(tiles); !asked) return asked.error();
  const auto count = static_cast<double>(tiles);
  std::vector<double> all, queue, loop;
  const std::uint64_t bytes = (*asker)->bytes();
  for (int round = 0; round < rounds; ++round) {
    const auto others_s = [] {
      return clock_s(CLOCK_PROCESS_CPUTIME_ID) - clock_s(CLOCK_THREAD_CPUTIME_ID);
    };
    const double all_s = others_s(), queue_s = server.replay_s(), loop_s = server.loop_s();
    if (Result<void> asked = (*asker)->ask(tiles); !asked) return asked.error();
    all.push_back(1e6 * (others_s() - all_s) / count);
    queue.push_back(1e6 * (server.replay_s() - queue_s) / count);
    loop.push_back(1e6 * (server.loop_s() - loop_s) / count);
  }
  costs.bytes = static_cast<double>((*asker)->bytes() - bytes) / (rounds * count);
  costs.all = middle(all).median;
  costs.spread_pct = middle(all).spread_pct;
  costs.queue = middle(queue).median;
  costs.loop = middle(loop).median;
  time_encoding(*scene, drawn, rounds, costs);
  return costs;
}

}  // namespace

Result<std::vector<Row>> server_path(const Conditions& conditions) {
  struct Kind {
    const char* name;
    std::uint8_t channels;
    std::uint32_t edge;
    double goal_us;  ///< 0: none
  };
  constexpr Kind kKinds[] = {{"lit", kLitTile, 32, 0},
                             {"lit", kLitTile, 64, 0},
                             {"lit", kLitTile, 128, 250},
                             {"relit", kRelitTile, 128, 0},
                             {"layered", kLayeredTile, 128, 0}};
  constexpr std::size_t kDrawn = 64;
  Result<std::shared_ptr<const PreparedScene>> scene = load_scene("builtin:forest?trees=60");
  if (!scene) return scene.error();
  std::vector<Row> rows;
  for (const Kind& kind : kKinds) {
    const Result<std::vector<RenderedTile>> drawn =
        draw_tiles(*scene, kDrawn, kind.edge, kind.channels);
    if (!drawn) return drawn.error();
    const Result<Costs> costs = measure(*scene, *drawn, conditions);
    if (!costs) return costs.error();
    const double per_core = 1e6 / costs->all;
    Row row;
    row.what = fmt::format("server without drawing, a {} tile of {} texels", kind.name, kind.edge);
    row.ours = fmt::format("{:.0f} CPU us", costs->all);
    row.beside = fmt::format("{:.0f} tiles/s a core", per_core);
    row.ratio = costs->all / (kind.goal_us > 0 ? kind.goal_us : 1000);
    if (kind.goal_us > 0) {
      row.goal = fmt::format("<= {:.0f} us", kind.goal_us);
      row.met = costs->all <= kind.goal_us;
    }
    row.spread_pct = costs->spread_pct;
    row.note = fmt::format(
        "{:.0f} bytes; CPU us: cut and measure {:.0f}, code {:.0f}, network loop {:.1f}, queue "
        "{:.1f}",
        costs->bytes, costs->cut, costs->code, costs->loop, costs->queue);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace mirage::bench
