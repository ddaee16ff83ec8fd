#include "client/load/load_run.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <fstream>

#include "client/native/no_answer.h"
#include "client/scene/scene_view.h"
#include "protocol/base/limits.h"
#include "protocol/wire/tile_address.h"

namespace mirage {
namespace {

// Credit that never holds back a tile.
constexpr std::uint64_t kCreditBytes = std::uint64_t{1} << 40;
constexpr std::size_t kWarmWindow = 64;
constexpr std::int64_t kAnswerPatienceUs = 5'000'000;
constexpr std::int64_t kClosePatienceUs = 2'000'000;
constexpr std::int64_t kProgressUs = 1'000'000;
constexpr std::int64_t kLongestWaitUs = 100'000;
constexpr std::int64_t kRetryCheckUs = 5'000;

std::int64_t us(double seconds) { return static_cast<std::int64_t>(seconds * 1e6); }

}  // namespace

Result<LoadResults> LoadRun::run() {
  clients_.resize(options_.clients);
  Result<std::unique_ptr<LoadClients>> link =
      LoadClients::create(options_.url, options_.clients, *this);
  if (!link) return link.error();
  link_ = link.take();
  if (Result<void> met = meet_server(); !met) return met.error();
  if (Result<void> planned = make_plan(); !planned) return planned.error();
  if (options_.warm || options_.warm_shard) {
    if (Result<void> warm = warm_up(); !warm) return warm.error();
  }
  if (options_.warm_shard) {
    results_.warmed = warm_answered_;
    results_.connected_at_end = described_;
    link_->close_all(kClosePatienceUs);
    return std::move(results_);
  }
  connect_others();
  const std::optional<wire::StatsT> before = server_stats();
  ask_at_intended_times();
  wait_for_answers();
  results_.connected_at_end = described_;
  const std::optional<wire::StatsT> after = before ? server_stats() : std::nullopt;
  if (after) {
    results_.server = ServerDelta{
        after->tiles_rendered - before->tiles_rendered, after->tiles_merged - before->tiles_merged,
        after->store_hits - before->store_hits, after->tiles_cancelled - before->tiles_cancelled,
        after->tiles_late - before->tiles_late};
  }
  link_->close_all(kClosePatienceUs);
  verifier_.finish();
  results_.verified = verifier_.verified();
  results_.verify_failures += verifier_.failures();
  if (results_.first_failure.empty()) results_.first_failure = verifier_.first_failure();
  return std::move(results_);
}

Result<void> LoadRun::meet_server() {
  link_->connect(kScout);
  const Client& scout = clients_[kScout];
  const auto over = [&] { return scout.stage == Stage::kDescribed || scout.stage == Stage::kDown; };
  std::uint32_t pages = 0;
  do {  // a large scene takes time: the wait restarts with every page
    pages = scout.pages;
    serve_until(over, clock_.now_us() + us(options_.connect_timeout_s));
  } while (!over() && scout.pages > pages);
  if (scout.stage == Stage::kDescribed) return {};
  if (scout.stage == Stage::kDown) return why_down();
  if (scout.stage == Stage::kAway) return no_answer(options_.url, options_.url_text, "");
  return make_error(ErrorId::kNetworkTimeout, "the server did not describe its scene");
}

Error LoadRun::why_down() const {
  for (const ErrorId id :
       {ErrorId::kAuth, ErrorId::kBusy, ErrorId::kWireVersion, ErrorId::kWireMalformed,
        ErrorId::kWireLimit, ErrorId::kWireValue, ErrorId::kWireState}) {
    if (down_id_ != error_name(id)) continue;
    return make_error(id, down_text_, id == ErrorId::kAuth ? "--token-file FILE" : "");
  }
  if (down_id_ == error_name(ErrorId::kNetworkConnect)) {
    return no_answer(options_.url, options_.url_text, down_text_);
  }
  return make_error(ErrorId::kNetworkClosed, down_text_);
}

Result<void> LoadRun::make_plan() {
  Result<CameraPath> path =
      CameraPath::create(options_.path, scene_.home, scene_.bounds_center, scene_.bounds_radius);
  if (!path) return path.error();
  PlanOptions plan;
  plan.clients = options_.clients;
  plan.duration_s = options_.duration_s;
  plan.rate_hz = options_.rate_hz;
  plan.spread_s = options_.spread_s;
  plan.fps = options_.fps;
  plan.camera.fov_y = glm::radians(options_.fov_degrees);
  plan.camera.width = options_.width;
  plan.camera.height = options_.height;
  plan.tau_px = options_.tau_px;
  plan.seed = options_.seed;
  Result<RequestPlan> made = make_request_plan(scene_, *path, plan);
  if (!made) return made.error();
  plan_ = made.take();
  asks_.assign(plan_.asks.size(), AskState::kPlanned);
  results_.latency_ms.reserve(plan_.asks.size());
  results_.send_lag_ms.reserve(plan_.asks.size());
  results_.clients = options_.clients;
  results_.duration_s = options_.duration_s;
  results_.distinct_asks = plan_.needs.size();
  if (!options_.urls_file.empty()) {
    if (Result<void> written = write_urls(); !written) return written;
  }
  spdlog::info("{}: {} requests planned, {} of them distinct", scene_.name, plan_.asks.size(),
               plan_.needs.size());
  return {};
}

Result<void> LoadRun::write_urls() const {
  std::ofstream file(options_.urls_file);
  for (const TileNeed& need : plan_.needs) {
    TileAddress address;
    address.instance = scene_.instances[need.instance].id;
    address.cell = need.cell;
    address.distance = need.distance;
    address.size_class = need.size_class;
    address.channels = kLitTile;
    address.phase = phase_of(need);
    file << fmt::format("/v1/tile/{:016x}/{}\n", scene_.revision, address.text());
  }
  file.close();
  if (file) return {};
  return make_error(ErrorId::kIo, "cannot write '" + options_.urls_file + "'");
}

Result<void> LoadRun::warm_up() {
  phase_ = "warming";
  const Shard shard = options_.warm_shard.value_or(Shard{});
  std::vector<TileNeed> needs;
  for (std::size_t i = shard.index; i < plan_.needs.size(); i += shard.count) {
    needs.push_back(plan_.needs[i]);
  }
  std::int64_t deadline = clock_.now_us() + us(options_.connect_timeout_s);
  while (warm_answered_ < needs.size()) {
    if (clients_[kScout].stage == Stage::kDown) return why_down();
    if (clock_.now_us() > deadline) {
      return make_error(ErrorId::kNetworkTimeout, "the server stopped answering while warming up");
    }
    while (warm_sent_ < needs.size() && warm_sent_ < warm_answered_ + kWarmWindow) {
      const std::size_t id = plan_.asks.size() + 1 + warm_sent_;
      link_->send(kScout, ask_message(static_cast<std::uint32_t>(id), needs[warm_sent_]));
      ++warm_sent_;
    }
    const std::size_t answered_before = warm_answered_;
    serve(kLongestWaitUs);
    if (warm_answered_ > answered_before) {
      deadline = clock_.now_us() + us(options_.connect_timeout_s);
    }
  }
  return {};
}

void LoadRun::connect_others() {
  phase_ = "connecting";
  const std::int64_t began = clock_.now_us();
  std::uint32_t next = kScout + 1;
  std::uint32_t settled = 0;
  std::int64_t deadline = began + us(options_.connect_timeout_s);
  while (described_ + down_ < options_.clients) {
    const std::int64_t now = clock_.now_us();
    const double due = static_cast<double>(now - began) * 1e-6 * options_.connects_per_s;
    while (next < options_.clients && next <= due + 1) link_->connect(next++);
    if (described_ + down_ > settled || next < options_.clients) {
      settled = described_ + down_;
      deadline = now + us(options_.connect_timeout_s);
    }
    if (now > deadline) break;
    serve(next < options_.clients ? us(1 / options_.connects_per_s) : kLongestWaitUs);
  }
  for (const Client& c : clients_) {
    const bool late = c.stage == Stage::kAway || c.stage == Stage::kGreeting;
    if (late) ++results_.errors["network-timeout"];
  }
}

void LoadRun::ask_at_intended_times() {
  phase_ = "asking";
  results_.connected = described_;
  const std::uint64_t bytes_before = link_->bytes();
  start_us_ = last_tile_us_ = clock_.now_us();
  const std::int64_t end = start_us_ + us(options_.duration_s);
  std::size_t& next = next_ask_;
  for (std::int64_t now = start_us_; now < end && described_ + reconnects_.away() > 0;
       now = clock_.now_us()) {
    while (next < plan_.asks.size() && start_us_ + plan_.asks[next].intended_us <= now) {
      ask(next++, now);
    }
    const std::int64_t due =
        next < plan_.asks.size() ? std::min(end, start_us_ + plan_.asks[next].intended_us) : end;
    serve(std::min(due - clock_.now_us(), kLongestWaitUs));
  }
  // These are due in the last instant, or will never be sent because no client is left.
  while (next < plan_.asks.size()) ask(next++, clock_.now_us());
  results_.bytes = bytes_before;  // wait_for_answers() takes the difference
}

void LoadRun::wait_for_answers() {
  phase_ = "waiting";
  serve_until([this] { return waiting_ == 0; }, clock_.now_us() + kAnswerPatienceUs);
  count_unanswered();
  const double asking_s = options_.duration_s;
  const double answering_s = static_cast<double>(last_tile_us_ - start_us_) * 1e-6;
  results_.elapsed_s = std::max(asking_s, answering_s);
  results_.bytes = link_->bytes() - results_.bytes;
}

void LoadRun::count_unanswered() {
  for (AskState& state : asks_) {
    if (state != AskState::kWaiting) continue;
    ++results_.errors["no-answer"];
    state = AskState::kGivenUp;
  }
}

std::optional<wire::StatsT> LoadRun::server_stats() {
  const auto up = std::find_if(clients_.begin(), clients_.end(),
                               [](const Client& c) { return c.stage == Stage::kDescribed; });
  if (up == clients_.end()) return std::nullopt;
  stats_.reset();
  link_->send(static_cast<std::uint32_t>(up - clients_.begin()),
              encode_message(wire::StatsRequestT{}));
  serve_until([&] { return stats_ || up->stage == Stage::kDown; },
              clock_.now_us() + kAnswerPatienceUs);
  return stats_;
}

void LoadRun::ask(std::size_t index, std::int64_t now_us) {
  const PlannedAsk& planned = plan_.asks[index];
  Client& c = clients_[planned.client];
  if (c.stage != Stage::kDescribed && !options_.reconnect) {
    asks_[index] = AskState::kDone;
    ++results_.errors["not-sent"];
    return;
  }
  const auto id = static_cast<std::uint32_t>(index + 1);
  if (c.stage == Stage::kDescribed) {  // otherwise it asks once it is back
    link_->send(planned.client, ask_message(id, plan_.needs[planned.need]));
  }
  const std::int64_t lag_us = now_us - start_us_ - planned.intended_us;
  results_.send_lag_ms.push_back(static_cast<float>(std::max<std::int64_t>(lag_us, 0)) * 1e-3f);
  asks_[index] = AskState::kWaiting;
  ++c.waiting;
  ++waiting_;
  ++results_.asked;
}

Phase LoadRun::phase_of(const TileNeed& need) const {
  const std::uint32_t object = scene_.instances[need.instance].object;
  return nearest_phase(0, scene_.objects[object].motion.clip_s, 0);
}

Bytes LoadRun::ask_message(std::uint32_t request_id, const TileNeed& need) const {
  wire::RequestBatchT batch;
  batch.credit_bytes = kCreditBytes;
  const InstanceView& view = scene_.instances[need.instance];
  batch.asks.emplace_back(request_id, view.id, scene_.object_id(need.instance),
                          static_cast<float>(need.error_px), 0u, need.distance.index, need.cell.x,
                          need.cell.y, need.cell.level, need.distance.level, need.size_class,
                          kLitTile, phase_of(need));
  return encode_message(std::move(batch));
}

template <typename Done>
bool LoadRun::serve_until(Done done, std::int64_t deadline_us) {
  while (!done()) {
    const std::int64_t left = deadline_us - clock_.now_us();
    if (left <= 0) return false;
    serve(std::min(left, kLongestWaitUs));
  }
  return true;
}

void LoadRun::try_again() {
  for (const std::uint32_t client : reconnects_.take_due(clock_.now_us())) {
    clients_[client].pages = 0;
    link_->connect(client);
  }
}

void LoadRun::ask_again(std::uint32_t client) {
  for (std::size_t i = 0; i < next_ask_; ++i) {
    if (asks_[i] != AskState::kWaiting || plan_.asks[i].client != client) continue;
    const TileNeed& need = plan_.needs[plan_.asks[i].need];
    link_->send(client, ask_message(static_cast<std::uint32_t>(i + 1), need));
  }
}

void LoadRun::serve(std::int64_t wait_us) {
  link_->service(reconnects_.away() > 0 ? std::min(wait_us, kRetryCheckUs) : wait_us);
  try_again();
  const std::int64_t now = clock_.now_us();
  if (now - progress_us_ >= kProgressUs) show_progress(now);
}

void LoadRun::show_progress(std::int64_t now_us) {
  const double seconds = static_cast<double>(now_us - progress_us_) * 1e-6;
  const std::uint64_t bytes = link_->bytes();
  spdlog::info(
      "{}: {} of {} clients, {:.0f} tiles/s, {:.1f} MB/s, {} waiting", phase_, described_,
      options_.clients, static_cast<double>(tiles_seen_ - progress_tiles_) / seconds,
      static_cast<double>(bytes - progress_bytes_) * 1e-6 / seconds,
      phase_ == std::string_view("warming") ? plan_.needs.size() - warm_answered_ : waiting_);
  progress_us_ = now_us;
  progress_tiles_ = tiles_seen_;
  progress_bytes_ = bytes;
}

}  // namespace mirage
