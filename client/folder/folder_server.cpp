#include "client/folder/folder_server.h"

#include <utility>

#include "client/folder/frozen_file.h"

namespace mirage {
namespace {

// Returns a file's message with the number of the request that it answers.
Result<Bytes> numbered(const Bytes& file, std::uint32_t request_id) {
  Result<Message> message = decode_message(file.data(), file.size());
  if (!message) return message.error();
  wire::BodyUnion& body = message->body;
  if (wire::TileReplyT* tile = body.AsTileReply()) {
    tile->request_id = request_id;
  } else if (wire::MeshReplyT* mesh = body.AsMeshReply()) {
    mesh->request_id = request_id;
  } else if (wire::ImageReplyT* image = body.AsImageReply()) {
    image->request_id = request_id;
  } else if (wire::ViewReplyT* view = body.AsViewReply()) {
    view->request_id = request_id;
  } else {
    return make_error(ErrorId::kWireValue, "a file that answers nothing");
  }
  return encode_body(body, message->payload);
}

}  // namespace

Result<void> FolderServer::open(const Bytes& frozen) {
  *this = FolderServer();
  Result<std::vector<Bytes>> parts = decode_frozen(frozen);
  if (!parts) return parts.error();
  for (Bytes& part : *parts) {
    const Result<Message> message = decode_message(part.data(), part.size());
    if (!message) return message.error();
    if (Result<void> known = learn(*message, part); !known) return known;
  }
  if (revision_ == 0) return make_error(ErrorId::kWireValue, "the folder describes no scene");
  for (const Bytes& part : opening_) {
    const Result<Message> message = decode_message(part.data(), part.size());
    if (message.ok() && message->body.AsCatalogue()) learn(*message->body.AsCatalogue());
  }
  return {};
}

Result<void> FolderServer::learn(const Message& message, const Bytes& whole) {
  switch (message.body.type) {
    case wire::Body::ViewReply:
      view_ = whole;
      return {};
    case wire::Body::Welcome:
      revision_ = message.body.AsWelcome()->revision;
      codec_ = message.body.AsWelcome()->codec;
      break;
    case wire::Body::Catalogue:
    case wire::Body::LightProbePage:
    case wire::Body::ImagePage:
    case wire::Body::ObjectPage:
    case wire::Body::InstancePage:
      break;
    default:
      return make_error(ErrorId::kWireValue, "a message that opens no scene");
  }
  opening_.push_back(whole);
  return {};
}

void FolderServer::learn(const wire::CatalogueT& page) {
  for (const wire::FrozenTile& tile : page.tiles) {
    File file{tile.hash(), tile.bytes(), {}};
    file.gone.tiles = {wire::FrozenTile(0, 0, tile.instance(), tile.object(), tile.distance_index(),
                                        tile.view_x(), tile.view_y(), tile.phase(),
                                        tile.view_level(), tile.distance_level(), tile.size_class(),
                                        tile.channels(), tile.codec())};
    files_[frozen_tile_name(revision_, address_of(tile))] = std::move(file);
  }
  for (const wire::FrozenAsset& asset : page.assets) {
    File file{asset.hash(), asset.bytes(), {}};
    file.gone.assets = {wire::FrozenAsset(0, 0, asset.index(), asset.level(), asset.image())};
    files_[frozen_asset_name(revision_, asset.image(), asset.index(), asset.level())] =
        std::move(file);
  }
}

Result<void> FolderServer::ask(const std::uint8_t* bytes, std::size_t size) {
  const Result<Message> message = decode_message(bytes, size);
  if (!message) return message.error();
  const wire::BodyUnion& body = message->body;
  if (const wire::HelloT* hello = body.AsHello()) {
    messages_.insert(messages_.end(), opening_.begin(), opening_.end());
    if (hello->view) send_view(*hello->view);
  } else if (const wire::ViewRequestT* view = body.AsViewRequest()) {
    send_view(*view);
  } else if (const wire::RequestBatchT* batch = body.AsRequestBatch()) {
    for (const wire::Ask& ask : batch->asks) {
      const TileAddress address{ask.instance(),
                                {ask.view_level(), ask.view_x(), ask.view_y()},
                                {ask.distance_level(), ask.distance_index()},
                                ask.size_class(),
                                ask.channels(),
                                ask.phase(),
                                static_cast<TileCodec>(codec_)};
      want(ask.request_id(), frozen_tile_name(revision_, address));
    }
    for (const wire::MeshAsk& ask : batch->mesh_asks) {
      want(ask.request_id(), frozen_asset_name(revision_, false, ask.object(), ask.lod()));
    }
    for (const wire::ImageAsk& ask : batch->image_asks) {
      want(ask.request_id(), frozen_asset_name(revision_, true, ask.image(), ask.level()));
    }
  } else if (const wire::OpenRequestT* open = body.AsOpenRequest()) {
    wire::InstancePageT nothing;  // all that the folder knows came with the opening
    nothing.request_id = open->request_id;
    nothing.last = true;
    messages_.push_back(encode_message(std::move(nothing)));
  } else if (const wire::GroundRequestT* ground = body.AsGroundRequest()) {
    refuse(ground->request_id, wire::RefusalReason::NoGeometry);
  } else if (body.AsReferenceRequest()) {
    refuse(0, wire::RefusalReason::NoReference);
  }
  return {};
}

void FolderServer::send_view(const wire::ViewRequestT& request) {
  Result<Bytes> view = numbered(view_, request.request_id);
  if (!request.home || !view) {
    refuse(request.request_id,
           request.home ? wire::RefusalReason::NoView : wire::RefusalReason::BadKey);
    return;
  }
  messages_.push_back(view.take());
}

void FolderServer::want(std::uint32_t request_id, const std::string& name) {
  if (files_.count(name) == 0 || lost_.count(name) != 0) {
    refuse(request_id, wire::RefusalReason::BadKey);
    return;
  }
  std::vector<std::uint32_t>& waiting = asked_[name];
  if (waiting.empty()) fetches_.push_back(name);
  waiting.push_back(request_id);
}

void FolderServer::fetched(const std::string& name, const Bytes* file) {
  const auto at = asked_.find(name);
  if (at == asked_.end()) return;
  const std::vector<std::uint32_t> waiting = std::move(at->second);
  asked_.erase(at);
  const File& known = files_.at(name);
  const bool whole = file && file->size() == known.bytes && frozen_hash(*file) == known.hash;
  if (!whole) lose(name);
  for (const std::uint32_t id : waiting) {
    Result<Bytes> message = whole ? numbered(*file, id) : Result<Bytes>(Bytes());
    if (!whole || !message) {
      refuse(id, wire::RefusalReason::BadKey);
    } else {
      messages_.push_back(message.take());
    }
  }
}

void FolderServer::lose(const std::string& name) {
  lost_.insert(name);
  holes_.push_back(name);
  messages_.push_back(encode_message(std::move(files_.at(name).gone)));
}

void FolderServer::refuse(std::uint32_t request_id, wire::RefusalReason reason) {
  wire::RefusedT refused;
  refused.request_id = request_id;
  refused.reason = reason;
  messages_.push_back(encode_message(std::move(refused)));
}

std::vector<std::string> FolderServer::take_fetches() { return std::exchange(fetches_, {}); }
std::vector<Bytes> FolderServer::take_messages() { return std::exchange(messages_, {}); }
std::vector<std::string> FolderServer::take_holes() { return std::exchange(holes_, {}); }

}  // namespace mirage
