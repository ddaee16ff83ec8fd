// Replies of a load run: how it handles what arrives. load_run.cpp has the phases.

#include <algorithm>

#include "client/load/load_run.h"
#include "client/scene/scene_view.h"
#include "protocol/base/limits.h"
#include "protocol/codec/codec_id.h"

namespace mirage {
namespace {

constexpr std::uint64_t kVerifyDraw = 3;  // stream of random numbers; the plan has 1, 2 and 4

const char* refusal_name(wire::RefusalReason reason) {
  switch (reason) {
    case wire::RefusalReason::Busy:
      return "refused-busy";
    case wire::RefusalReason::BadKey:
      return "refused-bad-key";
    case wire::RefusalReason::UnknownObject:
      return "refused-unknown-object";
    case wire::RefusalReason::NoGeometry:
      return "refused-no-geometry";
    case wire::RefusalReason::NoReference:
      return "refused-no-reference";
    case wire::RefusalReason::Late:
      return "refused-late";
    case wire::RefusalReason::TooLarge:
      return "refused-too-large";
    default:
      return "refused";
  }
}

}  // namespace

void LoadRun::on_open(std::uint32_t client) {
  clients_[client].stage = Stage::kGreeting;
  wire::HelloT hello;
  hello.version_min = hello.version_max = limits::kProtocolVersion;
  hello.token = options_.token;
  hello.name = "mirage-load";
  hello.codecs = every_codec();
  hello.clip = options_.url.choice.clip;
  hello.variant = options_.url.choice.variant;
  link_->send(client, encode_message(std::move(hello)));
}

Result<void> LoadRun::on_message(std::uint32_t client, const std::uint8_t* bytes,
                                 std::size_t size) {
  Result<MessageView> message = MessageView::create(bytes, size, scratch_);
  if (!message) return message.error();
  Client& c = clients_[client];
  const wire::Control& control = message->control();
  switch (message->type()) {
    case wire::Body::Welcome:
      return take_welcome(client, *control.body_as_Welcome());
    case wire::Body::LightProbePage:
    case wire::Body::ImagePage:
    case wire::Body::ObjectPage:
    case wire::Body::InstancePage:
      return take_page(c, client, *message);
    case wire::Body::TileReply:
      return take_tile(client, *message);
    case wire::Body::Refused:
      take_refusal(client, *control.body_as_Refused());
      return {};
    case wire::Body::Stats: {
      wire::StatsT stats;
      control.body_as_Stats()->UnPackTo(&stats);
      stats_ = stats;
      return {};
    }
    case wire::Body::Bye:
      return {};  // the close that follows counts
    default:
      return make_error(ErrorId::kWireState, "this message was not asked for");
  }
}

void LoadRun::on_down(std::uint32_t client, const std::string& id, const std::string& text) {
  Client& c = clients_[client];
  const bool was_up = c.stage == Stage::kDescribed;
  if (was_up) --described_;
  if (options_.reconnect && !options_.warm_shard && (was_up || results_.connected > 0)) {
    c.stage = Stage::kAway;
    reconnects_.lost(client, clock_.now_us());
    return;
  }
  c.stage = Stage::kDown;
  ++down_;
  waiting_ -= c.waiting;
  c.waiting = 0;
  down_id_ = id;
  down_text_ = text;
  ++results_.errors[id];
}

Result<void> LoadRun::take_welcome(std::uint32_t client, const wire::Welcome& welcome) {
  if (client == kScout && !scene_.described()) {
    const std::unique_ptr<wire::WelcomeT> unpacked(welcome.UnPack());
    if (Result<void> taken = scene_.accept(*unpacked); !taken) return taken;
    return {};
  }
  if (welcome.revision() != scene_.revision) {
    return make_error(ErrorId::kWireState, "the scene changed between two connections");
  }
  return {};
}

// The first client decodes the scene; for the others the same pages are only counted.
Result<void> LoadRun::take_page(Client& c, std::uint32_t client, const MessageView& message) {
  ++c.pages;
  if (client == kScout && !scene_.described()) {
    Result<void> taken;
    if (message.type() == wire::Body::LightProbePage) {
      const std::unique_ptr<wire::LightProbePageT> page(
          message.control().body_as_LightProbePage()->UnPack());
      const std::uint8_t* payload = message.payload();
      taken = scene_.accept(*page, Bytes(payload, payload + message.payload_bytes()));
    } else if (message.type() == wire::Body::ImagePage) {
      const std::unique_ptr<wire::ImagePageT> page(message.control().body_as_ImagePage()->UnPack());
      taken = scene_.accept(*page);
    } else if (message.type() == wire::Body::ObjectPage) {
      const std::unique_ptr<wire::ObjectPageT> page(
          message.control().body_as_ObjectPage()->UnPack());
      taken = scene_.accept(*page);
    } else {
      const std::unique_ptr<wire::InstancePageT> page(
          message.control().body_as_InstancePage()->UnPack());
      taken = scene_.accept(*page);
    }
    if (!taken) return taken;
    scene_pages_ = c.pages;
    if (scene_.described()) described(c, client);
  } else if (c.pages == scene_pages_) {
    described(c, client);
  }
  return {};
}

void LoadRun::described(Client& c, std::uint32_t client) {
  c.stage = Stage::kDescribed;
  ++described_;
  const std::optional<double> away_ms = reconnects_.back(client, clock_.now_us());
  if (!away_ms) return;
  results_.away_ms.push_back(static_cast<float>(*away_ms));
  ask_again(client);
}

const PlannedAsk* LoadRun::answered(std::uint32_t client, std::uint32_t request_id) {
  const std::size_t index = std::size_t{request_id} - 1;
  if (request_id == 0 || index >= plan_.asks.size()) return nullptr;
  if (asks_[index] != AskState::kWaiting || plan_.asks[index].client != client) return nullptr;
  asks_[index] = AskState::kDone;
  --clients_[client].waiting;
  --waiting_;
  return &plan_.asks[index];
}

Result<void> LoadRun::take_tile(std::uint32_t client, const MessageView& message) {
  const std::int64_t now = clock_.now_us();
  const wire::TileReply& reply = *message.control().body_as_TileReply();
  const std::uint32_t id = reply.request_id();
  ++tiles_seen_;
  const bool fits = same_content(reply);
  if (id > plan_.asks.size() && id <= plan_.asks.size() + warm_sent_) {
    ++warm_answered_;
    return {};
  }
  const PlannedAsk* ask = answered(client, id);
  if (!ask) {
    take_late_tile(client, id, now);
    return {};
  }
  ++results_.tiles;
  last_tile_us_ = now;
  const std::int64_t latency_us = now - start_us_ - ask->intended_us;
  results_.latency_ms.push_back(static_cast<float>(latency_us) * 1e-3f);
  results_.server_ms.push_back(static_cast<float>(reply.server_us()) * 1e-3f);
  const bool right_edge = reply.edge() == tile_edge(plan_.needs[ask->need].size_class);
  if (!fits || !right_edge) {
    ++results_.verify_failures;
    if (results_.first_failure.empty()) {
      results_.first_failure =
          fits ? "tile has another size than asked for" : "one key came with different contents";
    }
  }
  if (seeded_share(options_.seed, kVerifyDraw, id) < options_.verify_share) {
    VerifyTask task;
    reply.UnPackTo(&task.reply);
    task.planes.assign(message.payload(), message.payload() + message.payload_bytes());
    verifier_.submit(std::move(task));
  }
  return {};
}

void LoadRun::take_late_tile(std::uint32_t client, std::uint32_t request_id, std::int64_t now_us) {
  const std::size_t index = std::size_t{request_id} - 1;
  const bool planned = request_id != 0 && index < plan_.asks.size();
  if (!planned || asks_[index] != AskState::kGivenUp || plan_.asks[index].client != client) {
    ++results_.errors["unexpected-tile"];
    return;
  }
  asks_[index] = AskState::kDone;
  const std::int64_t latency_us = now_us - start_us_ - plan_.asks[index].intended_us;
  results_.late_ms.push_back(static_cast<float>(latency_us) * 1e-3f);
}

// Checks that equal key and codec mean equal content, for every tile and across all clients.
bool LoadRun::same_content(const wire::TileReply& reply) {
  const TileId key{reply.key_low() + reply.codec(), reply.key_high()};
  return contents_.try_emplace(key, reply.content_hash()).first->second == reply.content_hash();
}

void LoadRun::take_refusal(std::uint32_t client, const wire::Refused& refused) {
  const std::uint32_t id = refused.request_id();
  if (id > plan_.asks.size() && id <= plan_.asks.size() + warm_sent_) ++warm_answered_;
  answered(client, id);
  ++results_.errors[refusal_name(refused.reason())];
}

}  // namespace mirage
