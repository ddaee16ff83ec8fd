#include "client/freeze/frozen_part.h"

#include <algorithm>

#include "client/folder/frozen_file.h"
#include "protocol/base/byte_stream.h"

namespace mirage {
namespace {

constexpr std::uint64_t kPartMagic = 0x3150'5a52'4652'494d;  // "MIRFRZP1"

void put_bytes(ByteWriter& out, const Bytes& bytes) {
  out.put(static_cast<std::uint64_t>(bytes.size()));
  out.put_bytes(bytes.data(), bytes.size());
}

void put_list(ByteWriter& out, const std::vector<Bytes>& list) {
  out.put(static_cast<std::uint64_t>(list.size()));
  for (const Bytes& bytes : list) put_bytes(out, bytes);
}

Bytes get_bytes(ByteReader& in) {
  const auto size = in.get<std::uint64_t>();
  const std::uint8_t* const from = in.has(size, 1) ? in.take(size) : nullptr;
  return from ? Bytes(from, from + size) : Bytes();
}

std::vector<Bytes> get_list(ByteReader& in) {
  std::vector<Bytes> out;
  const auto count = in.get<std::uint64_t>();
  for (std::uint64_t i = 0; i < count && !in.failed(); ++i) out.push_back(get_bytes(in));
  return out;
}

}  // namespace

std::string FrozenEntry::name(std::uint64_t revision) const {
  if (is_tile) return frozen_tile_name(revision, address_of(tile));
  return frozen_asset_name(revision, asset.image(), asset.index(), asset.level());
}

void FrozenPart::add(const FrozenPart& other) {
  for (const auto& [name, entry] : other.files) {
    const auto [at, fresh] = files.emplace(name, entry);
    if (fresh) continue;
    at->second.gain = std::max(at->second.gain, entry.gain);
    at->second.spare = at->second.spare && entry.spare;
  }
  pages.insert(pages.end(), other.pages.begin(), other.pages.end());
  if (opening.empty()) opening = other.opening;
  if (view.empty()) view = other.view;
  eyes += other.eyes;
}

Bytes encode_part(const FrozenPart& part) {
  ByteWriter body;
  body.put(static_cast<std::uint64_t>(part.eyes));
  body.put(static_cast<std::uint64_t>(part.files.size()));
  for (const auto& [name, entry] : part.files) {
    put_bytes(body, Bytes(name.begin(), name.end()));
    body.put(static_cast<std::uint8_t>(entry.is_tile));
    body.put(entry.tile);
    body.put(entry.asset);
    body.put(entry.gain);
    body.put(static_cast<std::uint8_t>(entry.spare));
  }
  put_list(body, part.pages);
  put_list(body, part.opening);
  put_bytes(body, part.view);
  ByteWriter out;
  out.put(kPartMagic);
  out.put(frozen_hash(body.bytes));
  out.put_bytes(body.bytes.data(), body.bytes.size());
  return out.bytes;
}

Result<FrozenPart> decode_part(const Bytes& file) {
  ByteReader in(file.data(), file.size());
  const auto magic = in.get<std::uint64_t>();
  const auto hash = in.get<std::uint64_t>();
  const Bytes body(in.at(), in.at() + in.left());
  const auto damaged = [] { return make_error(ErrorId::kIo, "a part of the freeze is damaged"); };
  if (in.failed() || magic != kPartMagic || frozen_hash(body) != hash) return damaged();
  FrozenPart out;
  out.eyes = in.get<std::uint64_t>();
  const auto count = in.get<std::uint64_t>();
  for (std::uint64_t i = 0; i < count && !in.failed(); ++i) {
    const Bytes name = get_bytes(in);
    FrozenEntry& entry = out.files[std::string(name.begin(), name.end())];
    entry.is_tile = in.get<std::uint8_t>() != 0;
    entry.tile = in.get<wire::FrozenTile>();
    entry.asset = in.get<wire::FrozenAsset>();
    entry.gain = in.get<double>();
    entry.spare = in.get<std::uint8_t>() != 0;
  }
  out.pages = get_list(in);
  out.opening = get_list(in);
  out.view = get_bytes(in);
  if (in.failed()) return damaged();
  return out;
}

}  // namespace mirage
