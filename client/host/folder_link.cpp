#include "client/host/folder_link.h"

#include <spdlog/spdlog.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

#include "client/folder/frozen_file.h"

namespace mirage {
namespace {

namespace fs = std::filesystem;

std::optional<Bytes> read_whole(const fs::path& name) {
  std::ifstream file(name, std::ios::binary);
  if (!file) return std::nullopt;
  return Bytes(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

}  // namespace

bool is_frozen_folder(const std::string& name) {
  std::error_code failed;
  return fs::is_regular_file(fs::path(name) / kFrozenName, failed);
}

Result<std::unique_ptr<FolderLink>> FolderLink::open(const std::string& folder) {
  const fs::path name = fs::path(folder) / kFrozenName;
  const std::optional<Bytes> frozen = read_whole(name);
  if (!frozen) return make_error(ErrorId::kIo, "cannot read '" + name.string() + "'");
  std::unique_ptr<FolderLink> link(new FolderLink);
  link->folder_ = folder;
  if (Result<void> opened = link->server_.open(*frozen); !opened) {
    return make_error(opened.error().id, "'" + name.string() + "': " + opened.error().text,
                      "freeze the scene again into this folder");
  }
  return link;
}

void FolderLink::send(Bytes message) {
  traffic_.bytes_up += message.size();
  // A client of this build says nothing that this build cannot read.
  (void)server_.ask(message.data(), message.size());
}

std::vector<Message> FolderLink::receive() {
  for (const std::string& name : server_.take_fetches()) {
    const std::optional<Bytes> file = read_whole(fs::path(folder_) / name);
    server_.fetched(name, file ? &*file : nullptr);
  }
  for (std::string& name : server_.take_holes()) {
    spdlog::warn("'{}' of the folder '{}' is missing or damaged: it is left out", name, folder_);
    holes_.push_back(std::move(name));
  }
  std::vector<Message> out;
  for (const Bytes& bytes : server_.take_messages()) {
    traffic_.bytes_down += bytes.size();
    Result<Message> message = decode_message(bytes.data(), bytes.size());
    if (message) out.push_back(message.take());
  }
  return out;
}

}  // namespace mirage
