#pragma once
// Frozen part: what one session has brought, apart from the files themselves.

#include <map>
#include <string>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/wire/message.h"

namespace mirage {

/// A file of the folder. Either `tile` or `asset` describes it.
struct FrozenEntry {
  bool is_tile = true;
  wire::FrozenTile tile;
  wire::FrozenAsset asset;
  double gain = 0;     ///< the most that it was worth to a view when it was asked for, per byte
  bool spare = false;  ///< only clients without geometry asked for it, and the scene has some

  std::uint32_t bytes() const { return is_tile ? tile.bytes() : asset.bytes(); }
  std::uint64_t hash() const { return is_tile ? tile.hash() : asset.hash(); }
  std::string name(std::uint64_t revision) const;
};

struct FrozenPart {
  std::map<std::string, FrozenEntry> files;  ///< by name
  std::vector<Bytes> pages;                  ///< members of groups, as they came
  std::vector<Bytes> opening;                ///< what a server says unasked, in order
  Bytes view;                                ///< the home view; empty: none came
  std::size_t eyes = 0;

  /// Adds another part's files and pages. The opening and the view stay those that came first.
  void add(const FrozenPart& other);
};

/// Return a part as a file of the working folder, and read it back. Error kIo: it is damaged.
Bytes encode_part(const FrozenPart& part);
Result<FrozenPart> decode_part(const Bytes& file);

}  // namespace mirage
