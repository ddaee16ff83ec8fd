#pragma once
// Recording link: a connection whose replies are kept as files.
// Input:  messages to send; a server's messages.
// Output: the same messages, and a part with their files.
// Thread: the frame loop's.
// Full:   never; each file is handed on at once.

#include <functional>
#include <string>
#include <unordered_map>

#include "client/freeze/frozen_part.h"
#include "client/link/link.h"
#include "protocol/codec/codec_id.h"

namespace mirage {

/// The part of a scene that its client is told of.
enum class Record : std::uint8_t {
  kAll,
  kTiles,       ///< no geometry
  kWholeTiles,  ///< no geometry, and no parts of objects
};

class RecordingLink final : public Link {
 public:
  /// Keeps a file; error: it could not be written.
  using Keep = std::function<Result<void>(const std::string& name, const Bytes& file)>;

  /// `inner` passes messages on as they came.
  RecordingLink(Link& inner, Record record, Keep keep);

  void send(Bytes message) override;
  std::vector<Message> receive() override;
  bool connected() const override { return inner_.connected(); }
  std::uint32_t generation() const override { return inner_.generation(); }
  LinkTraffic traffic() const override { return inner_.traffic(); }

  const FrozenPart& part() const { return part_; }
  /// Returns the first error of keeping a file.
  const Result<void>& kept() const { return kept_; }

 private:
  struct Asked {
    wire::Ask ask;
    TileCodec codec = TileCodec::kZstd;
  };
  void note_tile(const wire::TileReplyT& reply, const Message& message);
  void note_asset(std::uint32_t index, std::uint8_t level, bool image, const Message& message);
  void note(Message& message);
  void add(FrozenEntry entry, const Bytes& file);

  Link& inner_;
  const Record record_;
  Keep keep_;
  std::uint64_t revision_ = 0;
  TileCodec welcome_codec_ = TileCodec::kZstd;
  std::unordered_map<std::uint32_t, Asked> asked_;
  FrozenPart part_;
  Result<void> kept_;
};

}  // namespace mirage
