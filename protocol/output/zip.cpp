#include "protocol/output/zip.h"

#include <zlib.h>

#include <algorithm>
#include <cstdint>

namespace mirage {
namespace {

constexpr std::uint32_t kLocalHeader = 0x04034b50, kCentralHeader = 0x02014b50,
                        kEndOfDirectory = 0x06054b50;
constexpr std::uint16_t kFirstDay = 1 << 5 | 1;  // 1980-01-01
constexpr std::uint16_t kUtf8 = 1 << 11;
constexpr std::size_t kMostBytes = 4'000'000'000, kMostEntries = 65'535;

void put(Bytes& out, std::uint64_t value, int bytes) {
  for (int b = 0; b < bytes; ++b) out.push_back(static_cast<std::uint8_t>(value >> (8 * b)));
}

std::uint32_t checksum(const Bytes& bytes) {
  return static_cast<std::uint32_t>(
      crc32(crc32(0, nullptr, 0), bytes.data(), static_cast<uInt>(bytes.size())));
}

// The fields that a local and a central header share.
void put_entry(Bytes& out, const ZipEntry& entry, std::uint32_t sum) {
  put(out, 10, 2);  // version needed: 1.0
  const bool plain = std::all_of(entry.name.begin(), entry.name.end(),
                                 [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  put(out, plain ? 0 : kUtf8, 2);
  put(out, 0, 2);  // no compression
  put(out, 0, 2);  // midnight
  put(out, kFirstDay, 2);
  put(out, sum, 4);
  put(out, entry.bytes.size(), 4);
  put(out, entry.bytes.size(), 4);
  put(out, entry.name.size(), 2);
  put(out, 0, 2);  // no extra field
}

}  // namespace

Result<Bytes> stored_zip(const std::vector<ZipEntry>& entries) {
  std::size_t bytes = 0;
  for (const ZipEntry& entry : entries) bytes += entry.bytes.size();
  if (bytes > kMostBytes || entries.size() > kMostEntries) {
    return make_error(ErrorId::kUsage, "a zip archive holds 4 GB and 65,535 files at most");
  }
  Bytes out, directory;
  out.reserve(bytes + 256 * entries.size());
  for (const ZipEntry& entry : entries) {
    const std::uint32_t sum = checksum(entry.bytes);
    const std::size_t at = out.size();
    put(out, kLocalHeader, 4);
    put_entry(out, entry, sum);
    out.insert(out.end(), entry.name.begin(), entry.name.end());
    out.insert(out.end(), entry.bytes.begin(), entry.bytes.end());
    put(directory, kCentralHeader, 4);
    put(directory, 10, 2);  // version that made it
    put_entry(directory, entry, sum);
    put(directory, 0, 4);  // no comment, disk 0
    put(directory, 0, 6);  // no attributes
    put(directory, at, 4);
    directory.insert(directory.end(), entry.name.begin(), entry.name.end());
  }
  const std::size_t begin = out.size();
  out.insert(out.end(), directory.begin(), directory.end());
  put(out, kEndOfDirectory, 4);
  put(out, 0, 4);  // disk 0
  put(out, entries.size(), 2);
  put(out, entries.size(), 2);
  put(out, directory.size(), 4);
  put(out, begin, 4);
  put(out, 0, 2);  // no comment
  return out;
}

}  // namespace mirage
