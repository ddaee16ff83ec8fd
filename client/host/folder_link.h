#pragma once
// Folder link: a frozen folder of this machine in place of a connection to a server.
// Input:  messages to send; the folder's files.
// Output: messages, as the folder answers them.
// Thread: the frame loop's; it reads files in receive().
// Full:   never; a client asks for a file once until it is answered.

#include <memory>
#include <string>
#include <vector>

#include "client/folder/folder_server.h"
#include "client/link/link.h"

namespace mirage {

/// True if the name is a folder with frozen.bin in it.
bool is_frozen_folder(const std::string& name);

class FolderLink final : public Link {
 public:
  /// Opens a folder. Errors kIo, and those of FolderServer::open() with the file's name.
  static Result<std::unique_ptr<FolderLink>> open(const std::string& folder);

  void send(Bytes message) override;
  std::vector<Message> receive() override;
  bool connected() const override { return true; }
  std::uint32_t generation() const override { return 1; }
  LinkTraffic traffic() const override { return traffic_; }

  /// Returns the files that turned out to be missing or damaged.
  const std::vector<std::string>& holes() const { return holes_; }

 private:
  FolderLink() = default;

  std::string folder_;
  FolderServer server_;
  std::vector<std::string> holes_;
  LinkTraffic traffic_;
};

}  // namespace mirage
