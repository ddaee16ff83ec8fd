#pragma once
// Folder server: answers a client from the files of a frozen folder, in a server's messages.
// Input:  frozen.bin, messages of a client, files as they are fetched.
// Output: names of files to fetch, messages for the client, names of files that are missing or
//         damaged.
// Thread: its owner's.
// Full:   never; a client asks for a file once until it is answered.
//
// A file whose hash is not the catalogue's is never passed on. The client is told that the folder
// does not have it, and it is not fetched again.

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"
#include "protocol/wire/message.h"

namespace mirage {

class FolderServer {
 public:
  /// Takes frozen.bin. Errors: those of decode_frozen(), kWireValue.
  Result<void> open(const Bytes& frozen);
  /// Takes a whole message of the client. Error: it is none.
  Result<void> ask(const std::uint8_t* bytes, std::size_t size);
  /// Takes a file that take_fetches() has named; nullptr: it could not be read.
  void fetched(const std::string& name, const Bytes* file);

  std::vector<std::string> take_fetches();
  std::vector<Bytes> take_messages();
  std::vector<std::string> take_holes();

 private:
  /// A file of the catalogue.
  struct File {
    std::uint64_t hash = 0;
    std::uint32_t bytes = 0;
    wire::CatalogueT gone;  ///< tells the client that it is missing
  };
  Result<void> learn(const Message& message, const Bytes& whole);
  void learn(const wire::CatalogueT& page);
  void want(std::uint32_t request_id, const std::string& name);
  void refuse(std::uint32_t request_id, wire::RefusalReason reason);
  void send_view(const wire::ViewRequestT& request);
  void lose(const std::string& name);

  std::vector<Bytes> opening_;
  Bytes view_;  ///< the home view; empty: none
  std::uint64_t revision_ = 0;
  std::uint8_t codec_ = 0;
  std::map<std::string, File> files_;
  std::set<std::string> lost_;
  std::map<std::string, std::vector<std::uint32_t>> asked_;  ///< requests under way, by file
  std::vector<std::string> fetches_, holes_;
  std::vector<Bytes> messages_;
};

}  // namespace mirage
