#include "client/link/modelled_link.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "protocol/impostor/view_tile.h"
#include "protocol/wire/view_codec.h"

namespace mirage {
namespace {

constexpr std::int64_t kUseUs = 500'000;
constexpr double kConnectingTrips = 2;
constexpr std::size_t kFrameOverhead = kWireHeaderBytes + 8;  // our header and WebSocket's
constexpr std::size_t kControlBytes = 144;                    // control part of a tile reply
// Order of replies that are ready at one time: first the welcome and tiles, then the description of
// the scene, then geometry and images by request id.
constexpr std::uint32_t kAtOnce = 0, kDescription = 1, kFirstBulk = 2;

std::size_t control_estimate(const Message& m) {
  flatbuffers::FlatBufferBuilder builder;
  builder.Finish(wire::CreateControl(builder, m.body.type, m.body.Pack(builder)));
  return builder.GetSize();
}

// Returns the id of the request that the message answers; 0: none.
std::uint32_t request_of(const Message& message) {
  const wire::BodyUnion& body = message.body;
  if (const wire::TileReplyT* tile = body.AsTileReply()) return tile->request_id;
  if (const wire::ViewReplyT* view = body.AsViewReply()) return view->request_id;
  if (const wire::MeshReplyT* mesh = body.AsMeshReply()) return mesh->request_id;
  if (const wire::ImageReplyT* image = body.AsImageReply()) return image->request_id;
  if (const wire::RefusedT* refused = body.AsRefused()) return refused->request_id;
  if (const wire::InstancePageT* page = body.AsInstancePage()) return page->request_id;
  return 0;
}

// True for a full render or its refusal: the model charges neither bytes nor time for them.
bool is_out_of_band(const Message& message) {
  const wire::RefusedT* refused = message.body.AsRefused();
  return message.body.type == wire::Body::ReferenceReply || (refused && refused->request_id == 0);
}

std::size_t bytes_of(const Message& m) {
  const std::size_t control =
      m.body.type == wire::Body::TileReply ? kControlBytes : control_estimate(m);
  return m.payload_bytes + control + kFrameOverhead;
}

}  // namespace

ModelledLink::ModelledLink(Link& inner, const Clock& clock, const NetModel& model, bool blocking,
                           std::function<bool()> wait)
    : inner_(inner),
      clock_(clock),
      model_(model),
      blocking_(blocking),
      wait_(std::move(wait)),
      delays_(model),
      greeted_(inner.generation()) {}

bool ModelledLink::connected() const {
  return inner_.connected() && inner_.generation() == reached_ && clock_.now_us() >= connected_us_;
}

void ModelledLink::note_connection(std::int64_t now_us) {
  if (inner_.generation() == reached_) return;
  reached_ = inner_.generation();
  // One trip for TCP, one for the upgrade to WebSocket.
  connected_us_ = now_us + std::llround(kConnectingTrips * 1000.0 * model_.rtt_ms);
}

void ModelledLink::send(Bytes message) {
  const std::int64_t now = clock_.now_us();
  note_sent(message, now);
  inner_.send(std::move(message));
}

void ModelledLink::note_sent(const Bytes& bytes, std::int64_t now) {
  Result<Message> message = decode_message(bytes.data(), bytes.size());
  if (!message) return;
  if (message->body.type == wire::Body::ReferenceRequest) {
    owed_reference_ = true;
    return;  // out of band: comparing costs neither time nor bytes
  }
  const std::size_t size = bytes.size() + 12;
  bytes_up_ += size;
  const std::int64_t start = std::max(now, uplink_free_us_) + delays_.transmission_us(size);
  uplink_free_us_ = start;
  const std::int64_t arrives = start + delays_.one_way_us();
  if (message->body.type == wire::Body::Hello) {
    owed_welcome_ = true;
    greeted_ = inner_.generation();
    // Replies that the former connection owed will not come any more.
    asks_.clear();
    assets_asked_us_.clear();
    owed_images_ = owed_objects_ = 0;
    opens_us_.clear();
    owed_reference_ = false;
    welcome_us_ = arrives;
    const wire::ViewRequestT* view = message->body.AsHello()->view.get();
    if (view) ask_view(*view, arrives);
  }
  if (const wire::ViewRequestT* view = message->body.AsViewRequest()) ask_view(*view, arrives);
  if (const wire::OpenRequestT* open = message->body.AsOpenRequest()) {
    opens_us_[open->request_id] = arrives;
  }
  const wire::RequestBatchT* batch = message->body.AsRequestBatch();
  if (!batch) return;
  for (const wire::Ask& ask : batch->asks) {
    Ask entry;
    entry.arrives_us = arrives;
    entry.error_px = ask.error_px();
    asks_[ask.request_id()] = std::move(entry);
  }
  for (const std::uint32_t id : batch->cancels) {
    const auto at = asks_.find(id);
    if (at != asks_.end()) at->second.cancelled_us = arrives;
  }
  // The server encodes them ahead or with a worker of their own, so they and tiles do not wait for
  // each other.
  const std::int64_t ready = arrives + std::llround(std::max(model_.server_ms, 0.0) * 1000.0);
  for (const wire::MeshAsk& ask : batch->mesh_asks) assets_asked_us_[ask.request_id()] = ready;
  for (const wire::ImageAsk& ask : batch->image_asks) assets_asked_us_[ask.request_id()] = ready;
}

void ModelledLink::ask_view(const wire::ViewRequestT& view, std::int64_t arrives_us) {
  Ask entry;
  entry.arrives_us = arrives_us;
  entry.error_px = std::numeric_limits<float>::infinity();  // ranks before every tile
  entry.view = true;
  entry.made_ahead = is_home_view(view);
  asks_[view.request_id] = std::move(entry);
}

bool ModelledLink::owed() const {
  if (owed_welcome_ || owed_images_ > 0 || owed_objects_ > 0 || owed_reference_) return true;
  if (!opens_us_.empty()) return true;
  if (!assets_asked_us_.empty()) return true;
  return std::any_of(asks_.begin(), asks_.end(),
                     [](const auto& entry) { return !entry.second.answered; });
}

void ModelledLink::collect_replies() {
  do {
    for (Message& message : inner_.receive()) take_reply(std::move(message));
  } while (blocking_ && owed() && inner_.connected() && inner_.generation() == greeted_ && wait_());
}

// Replaces the server's times by the model's, without changing the number of bytes. The real times
// vary, and so does what the server has cached for earlier clients.
void ModelledLink::tell_model_times(Message& message) const {
  wire::WelcomeT* welcome = message.body.AsWelcome();
  if (welcome && model_.server_ms >= 0) {
    welcome->tile_us = static_cast<std::uint32_t>(std::llround(1000 * model_.server_ms));
  }
  if (wire::ViewReplyT* view = message.body.AsViewReply()) {
    view->kept = false;
    view->server_us = 0;
  }
}

void ModelledLink::take_reply(Message message) {
  if (is_out_of_band(message)) {
    owed_reference_ = false;
    out_of_band_.push_back(std::move(message));
    return;
  }
  if (blocking_) tell_model_times(message);
  const std::size_t bytes = bytes_of(message);
  const std::int64_t sent_us = note_description(message);
  const std::uint32_t request = request_of(message);
  const bool welcome = message.body.type == wire::Body::Welcome;
  Item item{std::move(message), bytes, 0};
  item.left = item.bytes;
  const auto ask = asks_.find(request);
  if (request != 0 && ask != asks_.end()) {
    ask->second.answered = true;
    ask->second.reply = std::move(item);
    return;
  }
  const auto asked = assets_asked_us_.find(request);
  Ready ready;
  ready.bulk = asked != assets_asked_us_.end();
  ready.at_us = ready.bulk ? asked->second : std::max(sent_us, blocking_ ? 0 : clock_.now_us());
  ready.item = std::move(item);
  if (ready.bulk) assets_asked_us_.erase(asked);
  const std::uint32_t order = ready.bulk ? kFirstBulk + request : welcome ? kAtOnce : kDescription;
  ready_.emplace(std::make_pair(ready.at_us, order), std::move(ready));
}

std::int64_t ModelledLink::note_description(const Message& message) {
  if (const wire::WelcomeT* welcome = message.body.AsWelcome()) {
    owed_welcome_ = false;
    owed_images_ = welcome->images;
    owed_objects_ = welcome->objects;
    if (welcome->instances > 0) opens_us_[0] = 0;  // pages that come unasked
  } else if (const wire::ImagePageT* images = message.body.AsImagePage()) {
    owed_images_ -= std::min(owed_images_, images->images.size());
  } else if (const wire::ObjectPageT* page = message.body.AsObjectPage()) {
    owed_objects_ -= std::min(owed_objects_, page->objects.size());
  }
  const wire::InstancePageT* page = message.body.AsInstancePage();
  const auto open = page ? opens_us_.find(page->request_id) : opens_us_.end();
  if (open == opens_us_.end()) return welcome_us_;
  const std::int64_t sent_us = std::max(welcome_us_, open->second);
  if (page->last) opens_us_.erase(open);
  return sent_us;
}

void ModelledLink::run_server(std::int64_t now) {
  for (auto it = asks_.begin(); it != asks_.end();) {
    const Ask& ask = it->second;
    const bool gone = ask.cancelled_us <= std::max(ask.arrives_us, server_free_us_);
    const bool settled = ask.answered || !blocking_;  // in real time the server may have dropped it
    it = gone && settled && ask.cancelled_us <= now ? asks_.erase(it) : std::next(it);
  }
  for (;;) {
    // A free server takes the ask with the largest error among those that have arrived.
    std::int64_t earliest = INT64_MAX;
    for (const auto& [id, ask] : asks_) {
      if (ask.answered) earliest = std::min(earliest, ask.arrives_us);
    }
    if (earliest == INT64_MAX) return;
    const std::int64_t start = std::max(earliest, server_free_us_);
    if (start > now) return;
    auto best = asks_.end();
    for (auto it = asks_.begin(); it != asks_.end(); ++it) {
      if (!it->second.answered || it->second.arrives_us > start) continue;
      if (best == asks_.end() || it->second.error_px > best->second.error_px) best = it;
    }
    Ask ask = std::move(best->second);
    asks_.erase(best);
    if (ask.cancelled_us <= start) continue;
    double cost_ms = model_.server_ms;
    const wire::TileReplyT* tile = ask.reply.message.body.AsTileReply();
    if (cost_ms < 0) cost_ms = tile ? 0.001 * (tile->render_us + tile->encode_us) : 0.0;
    // A view costs its full time even if the server has it cached: otherwise earlier clients would
    // change the model's time.
    const bool view = ask.reply.message.body.AsViewReply();
    if (view) cost_ms = ask.made_ahead ? 0 : kViewTiles * std::max(cost_ms, 0.0);
    // Real time: the reply already includes the server's time.
    const std::int64_t cost = blocking_ ? std::llround(cost_ms * 1000.0) : 0;
    server_free_us_ = start + cost;
    working_.add(start, server_free_us_);
    // The client must read the model's time in the reply, too (tell_model_times()).
    if (blocking_ && tile) {
      wire::TileReplyT& told = *ask.reply.message.body.AsTileReply();
      told.server_us = static_cast<std::uint32_t>(server_free_us_ - ask.arrives_us);
      told.queue_us = static_cast<std::uint32_t>(start - ask.arrives_us);
      told.render_us = static_cast<std::uint32_t>(cost);
      told.encode_us = 0;
    }
    // A refused view costs no time either.
    ready_.emplace(std::make_pair(server_free_us_, kAtOnce),
                   Ready{server_free_us_, false, ask.view, std::move(ask.reply)});
  }
}

void ModelledLink::transmit(std::deque<Item>& lane, std::int64_t start) {
  Item& item = lane.front();
  const std::size_t n = std::min(item.left, limits::kChunkBytes);
  downlink_free_us_ = start + delays_.transmission_us(n);
  transmitting_.add(start, downlink_free_us_);
  item.left -= n;
  if (item.left > 0) return;
  bytes_down_ += item.bytes;
  // TCP delivers in order: a late message delays all that follow.
  last_arrival_us_ = std::max(last_arrival_us_, downlink_free_us_ + delays_.one_way_us());
  arrived_.emplace_back(last_arrival_us_, std::move(item.message));
  lane.pop_front();
}

void ModelledLink::run_downlink(std::int64_t now) {
  for (;;) {
    std::int64_t start = downlink_free_us_;
    if (tiles_lane_.empty() && bulk_lane_.empty()) {
      if (ready_.empty()) return;
      start = std::max(start, ready_.begin()->first.first);
    }
    if (start > now) return;
    while (!ready_.empty() && ready_.begin()->first.first <= start) {
      Ready& ready = ready_.begin()->second;
      std::deque<Item>& lane = ready.bulk ? bulk_lane_ : tiles_lane_;
      const bool ahead = ready.view && lane.size() > 1;
      lane.insert(ahead ? std::next(lane.begin()) : lane.end(), std::move(ready.item));
      ready_.erase(ready_.begin());
    }
    // Tiles and bulk share the link by bytes, as on the server.
    const bool both = !tiles_lane_.empty() && !bulk_lane_.empty();
    if (!both) tile_lead_bytes_ = 0;
    const bool tile = both ? tile_lead_bytes_ <= 0 : bulk_lane_.empty();
    std::deque<Item>& lane = tile ? tiles_lane_ : bulk_lane_;
    const auto n = static_cast<std::int64_t>(std::min(lane.front().left, limits::kChunkBytes));
    tile_lead_bytes_ += tile ? n : -n;
    transmit(lane, start);
  }
}

LinkUse ModelledLink::use() {
  const std::int64_t now = clock_.now_us();
  const auto trips = static_cast<std::int64_t>(std::llround(2000.0 * model_.rtt_ms));
  const std::int64_t since = std::max(now - std::max(kUseUs, trips), welcome_us_);
  return {transmitting_.share(since, now), working_.share(since, now)};
}

std::vector<Message> ModelledLink::receive() {
  const std::int64_t now = clock_.now_us();
  note_connection(now);
  collect_replies();
  run_server(now);
  run_downlink(now);
  std::vector<Message> out = std::exchange(out_of_band_, {});
  while (!arrived_.empty() && arrived_.front().first <= now) {
    out.push_back(std::move(arrived_.front().second));
    out.back().waited_us = now - arrived_.front().first;
    arrived_.pop_front();
  }
  return out;
}

}  // namespace mirage
