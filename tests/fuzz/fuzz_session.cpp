// A server's sessions, message after message. Clients come, ask, cancel, change the light and go,
// in any order; stages answer late, in another order or not at all.
#include <algorithm>
#include <memory>
#include <vector>

#include "fuzz_targets.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/message.h"
#include "protocol/wire/tile_address.h"
#include "server/prepare/prepared_scene.h"
#include "server/session/hub_state.h"
#include "server/session/session.h"
#include "server/source/tile_source.h"
#include "server/tile/stage_queues.h"

namespace mirage::fuzz {
namespace {

constexpr std::size_t kMostClients = 6;

/// A source without tiles. It makes the server look for tiles before rendering.
class Nothing final : public TileSource {
 public:
  Tier tier() const override { return Tier::kDirectory; }
  std::int64_t patience_us() const override { return 30'000; }
  std::optional<Bytes> fetch(const FormId&) override { return std::nullopt; }
  bool offer(const FormId&, const Bytes&) override { return true; }
};

/// Reads the input byte by byte, with zeros behind its end.
class Script {
 public:
  Script(const std::uint8_t* data, std::size_t size) : at_(data), end_(data + size) {}
  bool over() const { return at_ == end_; }
  std::uint8_t byte() { return over() ? std::uint8_t{0} : *at_++; }
  std::uint32_t word() {
    std::uint32_t out = 0;
    for (int i = 0; i < 4; ++i) out = out << 8 | byte();
    return out;
  }
  Bytes bytes(std::size_t most) {
    const std::size_t n = std::min(most, static_cast<std::size_t>(end_ - at_));
    Bytes out(at_, at_ + n);
    at_ += n;
    return out;
  }

 private:
  const std::uint8_t* at_;
  const std::uint8_t* const end_;
};

class Play {
 public:
  Play(const std::uint8_t* data, std::size_t size) : script_(data, size) {
    SessionOptions options;
    options.max_clients = 4;
    options.max_outbox_bytes = 4096;
    hub_ = std::make_unique<SessionHub>(scene(), options, queues_);
  }

  void run() {
    while (!script_.over()) {
      step();
      check();
    }
    end();
  }

 private:
  static std::shared_ptr<const PreparedScene> scene() {
    static const std::shared_ptr<const PreparedScene> one =
        *load_scene("builtin:knot?tubular=16&radial=8");
    return one;
  }

  void step() {
    switch (script_.byte() % 20) {
      case 0:
        if (clients_.size() < kMostClients) clients_.push_back(hub_->open());
        return;
      case 1:
        return close(client());
      case 2:
        return hello();
      case 3:
      case 4:
        return asks();
      case 5:
        return lighting();
      case 6:
        return receive(script_.bytes(script_.byte()));
      case 7:
        return reference();
      case 8:
        return view();
      case 9:
        return geometry();
      case 10:
      case 11:
        return render();
      case 12:
        return fetch();
      case 13:
        clock_.advance_to_us(clock_.now_us() +
                             std::int64_t{script_.byte()} * script_.byte() * 1000);
        return;
      case 14:
        return read(script_.byte());
      case 15:
        return overdue();
      case 16:
        return get();
      case 17:
        hub_->give_up_fetches();
        return hub_->refuse_late();
      case 18:
        return forms();
      default:
        if (script_.byte() == 0xff) hub_->drain();
    }
  }

  /// Returns one of the present clients; 0: there is none.
  SessionId client() { return clients_.empty() ? 0 : clients_[script_.byte() % clients_.size()]; }
  void close(SessionId id) {
    if (id == 0) return;
    hub_->close(id);
    if (hub_->asks_of(id) != 0) fail("an ask waits of a client that is gone");
    clients_.erase(std::find(clients_.begin(), clients_.end(), id));
  }
  void receive(const Bytes& message) { receive(client(), message); }
  void receive(SessionId id, const Bytes& message) {
    if (id != 0 && !hub_->receive(id, message.data(), message.size())) close(id);
  }

  void hello() {
    wire::HelloT m;
    m.version_min = m.version_max = limits::kProtocolVersion;
    const std::uint8_t codecs = script_.byte();
    for (const TileCodec codec : kTileCodecs) {
      const auto number = static_cast<std::uint8_t>(codec);
      if ((codecs >> number & 1) == 0) m.codecs.push_back(number);
    }
    receive(encode_message(std::move(m)));
  }

  wire::Ask ask() {
    const std::uint8_t what = script_.byte();
    const auto deadline = static_cast<std::uint32_t>(script_.byte() % 4 * 100);
    return {script_.byte() % 32u,
            what & 1 ? script_.word() : 0,
            what & 2 ? script_.word() : 0,
            static_cast<float>(script_.byte()),
            deadline,
            what & 4 ? static_cast<std::int32_t>(script_.word()) : 8,
            script_.byte(),
            0,
            what & 8 ? script_.byte() : std::uint8_t{9},
            2,
            what & 16 ? script_.byte() : std::uint8_t{2},
            what & 32 ? script_.byte() : std::uint8_t{kLitTile},
            static_cast<std::uint16_t>(what & 64 ? script_.byte() : 0)};
  }

  void asks() {
    wire::RequestBatchT m;
    m.codec = script_.byte() % 5;
    m.lighting_id = script_.byte() % 4;
    m.credit_bytes = std::uint64_t{script_.byte()} << (script_.byte() % 56);
    for (int n = script_.byte() % 8; n > 0; --n) m.asks.push_back(ask());
    for (int n = script_.byte() % 4; n > 0; --n) m.cancels.push_back(script_.byte() % 32u);
    receive(encode_message(std::move(m)));
  }

  void lighting() {
    wire::SetLightingT m;
    m.id = script_.byte() % 40u;
    Lighting light = scene()->scene.lighting;
    light.ambient.r = static_cast<float>(script_.byte()) / 16;
    if (script_.byte() % 8 == 0) light.ambient.g = -1;
    m.lighting = to_wire(light);
    receive(encode_message(std::move(m)));
  }

  Camera camera() {
    Camera out;
    out.pose.eye.x = script_.byte();
    out.width = 16 << (script_.byte() % 12);
    out.height = 16 << (script_.byte() % 4);
    return out;
  }

  void reference() {
    wire::ReferenceRequestT m;
    m.request_id = script_.byte();
    m.supersample = script_.byte() % 6;
    m.width = static_cast<std::uint16_t>(script_.word());
    m.height = static_cast<std::uint16_t>(script_.word());
    receive(encode_message(std::move(m)));
  }

  void view() {
    wire::ViewRequestT m = view_request(camera(), 0);
    m.request_id = script_.byte();
    m.lighting_id = script_.byte() % 4;
    m.home = script_.byte() % 2;
    receive(encode_message(std::move(m)));
  }

  void geometry() {
    wire::RequestBatchT m;
    for (int n = script_.byte() % 4; n > 0; --n) {
      m.mesh_asks.emplace_back(script_.byte(), script_.byte() % 3u, script_.byte() % 8);
      m.image_asks.emplace_back(script_.byte(), script_.byte() % 3u, script_.byte() % 8);
    }
    receive(encode_message(std::move(m)));
    wire::OpenRequestT open;
    for (int n = script_.byte() % 4; n > 0; --n) open.groups.push_back(script_.byte());
    receive(encode_message(std::move(open)));
    wire::GroundRequestT ground;
    ground.x = script_.byte() % 4;
    receive(encode_message(std::move(ground)));
  }

  void render() {
    const bool one = script_.byte() % 2 == 0;
    int left = one ? 1 : 16;
    auto work = queues_.tiles.take({[&](std::uint32_t) { return left-- > 0; }}, false);
    if (!work) return;
    if (const auto* view = std::get_if<ViewJob>(&*work)) {
      return hub_->complete(FinishedView{view->id, nullptr});
    }
    if (const auto* full = std::get_if<ReferenceJob>(&*work)) {
      return hub_->complete(FinishedReference{full->session, Bytes(script_.byte())});
    }
    for (TileJob& job : std::get<std::vector<TileJob>>(*work)) rendering_.push_back(std::move(job));
    if (script_.byte() % 4 != 0) finish_rendering();
  }

  void finish_rendering() {
    for (const TileJob& job : std::exchange(rendering_, {})) {
      if (script_.byte() % 8 == 1) {
        hub_->complete(TooLargeTile{job.id});
        continue;
      }
      auto tile = std::make_shared<StoredTile>();
      tile->reply.key_low = job.id.low;
      tile->reply.key_high = job.id.high;
      tile->reply.codec = static_cast<std::uint8_t>(TileCodec::kZstd);
      tile->planes.resize(script_.byte() * 8u);
      queues_.store.put(job.id, TileCodec::kZstd, tile);
      hub_->complete(FinishedTile{job.id, job.codec, tile, tile});
    }
  }

  void fetch() {
    const std::optional<FetchJob> job = queues_.fetches.try_pop();
    if (!job) return;
    if (script_.byte() % 3 == 0) hub_->complete(PendingFetch{job->id, job->codec});
    if (script_.byte() % 3 != 0) hub_->complete(FinishedFetch{job->id, job->codec, {}});
  }

  void forms() {
    while (const std::optional<EncodeJob> job = queues_.rendered.try_pop()) {
      const auto* form = std::get_if<FormJob>(&*job);
      if (form) hub_->complete(FinishedTile{form->id, form->codec, form->lossless});
    }
    while (const std::optional<ImageLevel> level = queues_.images.try_pop()) {
      hub_->complete(FinishedImage{*level, Bytes(script_.byte())});
    }
    while (const std::optional<GroundBlockId> block = queues_.grounds.try_pop()) {
      hub_->complete(FinishedGround{*block, {Bytes(script_.byte()), 20u * (script_.byte() % 2u)}});
    }
  }

  void read(int most) {
    const SessionId id = client();
    while (id != 0 && most-- > 0 && hub_->next_packet(id)) {
    }
    (void)hub_->take_writable();
  }

  void overdue() {
    for (const auto& [id, error] : hub_->overdue()) close(id);
  }

  void get() {
    TileAddress address;
    address.instance = script_.byte() % 3;
    address.cell = {9, script_.byte(), 0};
    address.distance = {2, 8};
    address.size_class = 2;
    address.channels = script_.byte() % 64;
    address.codec = kTileCodecs[script_.byte() % kTileCodecs.size()];
    gets_.push_back(hub_->get(address));
    if (script_.byte() % 4 == 0) hub_->cancel_get(gets_[script_.byte() % gets_.size()]);
    (void)hub_->take_got();
  }

  void check() {
    const std::size_t waiters = (kMostClients + 1) * limits::kMaxQueuedAsksPerClient;
    if (queues_.tiles.ranks() > waiters) fail("more waits than may");
    for (const SessionId id : clients_) {
      if (hub_->asks_of(id) > 2 * limits::kMaxQueuedAsksPerClient)
        fail("a client has too many asks");
    }
    const HubState state = hub_->state();
    // An outbox holds immediate replies, a refusal for each ask of a message, and one large item.
    if (state.largest_outbox_bytes > 3 * 4096 + 100'000) fail("an outbox holds too much");
    if (state.clients > 4) fail("more clients than may be");
  }

  /// All clients go, and everything under way ends: nothing may be left.
  void end() {
    while (!clients_.empty()) close(clients_.back());
    for (const std::uint32_t request : gets_) hub_->cancel_get(request);
    while (const std::optional<FetchJob> job = queues_.fetches.try_pop()) {
      hub_->complete(FinishedFetch{job->id, job->codec, {}});
    }
    while (auto work = queues_.tiles.take({[](std::uint32_t) { return true; }}, false)) {
      const auto* tiles = std::get_if<std::vector<TileJob>>(&*work);
      if (tiles) fail("a tile is rendered for nobody");
      if (const auto* view = std::get_if<ViewJob>(&*work)) {
        hub_->complete(FinishedView{view->id, nullptr});
      }
    }
    finish_rendering();
    forms();
    clock_.advance_to_us(clock_.now_us() + 100'000'000);
    hub_->give_up_fetches();
    if (queues_.tiles.length() != 0) fail("a tile waits that nobody wants");
    if (queues_.tiles.ranks() != 0) fail("an ask waits of a client that is gone");
    if (!hub_->drained()) fail("it is never drained");
  }

  Script script_;
  VirtualClock clock_;
  Nothing nothing_;
  StageQueues queues_{clock_, 1 << 16, {&nothing_}};
  std::unique_ptr<SessionHub> hub_;
  std::vector<SessionId> clients_;
  std::vector<std::uint32_t> gets_;
  std::vector<TileJob> rendering_;
};

}  // namespace

void run_session(const std::uint8_t* data, std::size_t size) { Play(data, size).run(); }

}  // namespace mirage::fuzz

#ifdef MIRAGE_FUZZ_ENTRY
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mirage::fuzz::run_session(data, size);
  return 0;
}
#endif
