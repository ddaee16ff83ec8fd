#pragma once
// Page folder: a page for browsers as a server gets it, useful only for its size.

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/process.h"

namespace mirage::test {

/// Returns a folder for --web. Its one part is /w-1/core.wasm, with this many bytes.
inline std::string page_folder(std::size_t part_bytes) {
  const std::filesystem::path folder = scratch_folder() + "/page";
  std::filesystem::create_directories(folder / "w-1");
  std::ofstream(folder / "index.html") << "a page";
  std::ofstream(folder / "w-1" / "core.wasm", std::ios::binary) << std::string(part_bytes, 'w');
  return folder.string();
}

inline constexpr const char* kAskForPart = "GET /w-1/core.wasm HTTP/1.1\r\nHost: x\r\n\r\n";

}  // namespace mirage::test
