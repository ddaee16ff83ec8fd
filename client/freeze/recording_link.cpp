#include "client/freeze/recording_link.h"

#include <algorithm>
#include <utility>

#include "client/folder/frozen_file.h"

namespace mirage {

RecordingLink::RecordingLink(Link& inner, Record record, Keep keep)
    : inner_(inner), record_(record), keep_(std::move(keep)) {}

void RecordingLink::send(Bytes message) {
  const Result<Message> said = decode_message(message.data(), message.size());
  if (const wire::RequestBatchT* batch = said.ok() ? said->body.AsRequestBatch() : nullptr) {
    const TileCodec codec =
        batch->codec == 255 ? welcome_codec_ : static_cast<TileCodec>(batch->codec);
    for (const wire::Ask& ask : batch->asks) asked_[ask.request_id()] = {ask, codec};
  }
  inner_.send(std::move(message));
}

std::vector<Message> RecordingLink::receive() {
  std::vector<Message> out = inner_.receive();
  for (Message& message : out) note(message);
  return out;
}

void RecordingLink::note(Message& message) {
  wire::BodyUnion& body = message.body;
  switch (body.type) {
    case wire::Body::Welcome:
      revision_ = body.AsWelcome()->revision;
      welcome_codec_ = static_cast<TileCodec>(body.AsWelcome()->codec);
      part_.opening.push_back(encode_body(body, message.payload));
      if (record_ != Record::kAll) body.AsWelcome()->geometry = false;
      return;
    case wire::Body::LightProbePage:
    case wire::Body::ImagePage:
      part_.opening.push_back(encode_body(body, message.payload));
      return;
    case wire::Body::ObjectPage:
      part_.opening.push_back(encode_body(body, message.payload));
      for (const auto& object : body.AsObjectPage()->objects) {
        if (record_ == Record::kWholeTiles) object->cut = false;
      }
      return;
    case wire::Body::InstancePage:
      (body.AsInstancePage()->request_id == 0 ? part_.opening : part_.pages)
          .push_back(encode_body(body, message.payload));
      return;
    case wire::Body::TileReply:
      return note_tile(*body.AsTileReply(), message);
    case wire::Body::MeshReply:
      return note_asset(body.AsMeshReply()->object, body.AsMeshReply()->lod, false, message);
    case wire::Body::ImageReply:
      return note_asset(body.AsImageReply()->image, body.AsImageReply()->level, true, message);
    case wire::Body::ViewReply:
      if (part_.view.empty()) part_.view = encode_body(body, message.payload);
      return;
    default:
      return;
  }
}

// The bytes are those of GET /v1/tile: no request id, no times.
void RecordingLink::note_tile(const wire::TileReplyT& reply, const Message& message) {
  const auto at = asked_.find(reply.request_id);
  if (at == asked_.end()) return;
  const auto [ask, codec] = std::exchange(at->second, {});
  asked_.erase(at);
  wire::TileReplyT plain = reply;
  plain.request_id = plain.server_us = 0;
  plain.queue_us = plain.render_us = plain.encode_us = 0;
  const Bytes file = encode_message(std::move(plain), message.payload);
  FrozenEntry entry;
  entry.tile = wire::FrozenTile(frozen_hash(file), static_cast<std::uint32_t>(file.size()),
                                ask.instance(), ask.object(), ask.distance_index(), ask.view_x(),
                                ask.view_y(), ask.phase(), ask.view_level(), ask.distance_level(),
                                ask.size_class(), ask.channels(), static_cast<std::uint8_t>(codec));
  entry.gain = static_cast<double>(ask.error_px());
  entry.spare = record_ == Record::kWholeTiles;
  add(std::move(entry), file);
}

void RecordingLink::note_asset(std::uint32_t index, std::uint8_t level, bool image,
                               const Message& message) {
  wire::BodyUnion plain = message.body;
  if (image) {
    plain.AsImageReply()->request_id = 0;
  } else {
    plain.AsMeshReply()->request_id = 0;
  }
  const Bytes file = encode_body(plain, message.payload);
  FrozenEntry entry;
  entry.is_tile = false;
  entry.asset = wire::FrozenAsset(frozen_hash(file), static_cast<std::uint32_t>(file.size()), index,
                                  level, image);
  add(std::move(entry), file);
}

void RecordingLink::add(FrozenEntry entry, const Bytes& file) {
  const std::string name = entry.name(revision_);
  const auto [at, fresh] = part_.files.emplace(name, entry);
  if (!fresh) {
    at->second.gain = std::max(at->second.gain, entry.gain);
    return;
  }
  if (kept_.ok()) kept_ = keep_(name, file);
}

}  // namespace mirage
