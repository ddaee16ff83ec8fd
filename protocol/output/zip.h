#pragma once
// A zip archive without compression: equal entries give equal bytes.

#include <string>
#include <vector>

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"

namespace mirage {

struct ZipEntry {
  std::string name;  ///< with / between folders; UTF-8
  Bytes bytes;
};

/// Returns the archive, every entry dated 1980-01-01. Format: PKWARE, APPNOTE.TXT 6.3. Error
/// kUsage: more than 65,535 entries or 4 GB, which the format cannot count.
Result<Bytes> stored_zip(const std::vector<ZipEntry>& entries);

}  // namespace mirage
