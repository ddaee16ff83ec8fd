#pragma once
// Link: carries whole messages to and from a server. Client logic sees no sockets: a native link, a
// browser link and a modelled link all look the same.

#include <cstdint>
#include <vector>

#include "protocol/wire/message.h"

namespace mirage {

struct LinkTraffic {
  std::uint64_t bytes_up = 0;  ///< with headers
  /// Bytes with headers, without full renders, which are not part of the product.
  std::uint64_t bytes_down = 0;
};

class Link {
 public:
  virtual ~Link() = default;
  /// Sends a message; never blocks.
  virtual void send(Bytes message) = 0;
  /// Returns the messages that have arrived by now, in order, each with the time since it arrived.
  virtual std::vector<Message> receive() = 0;
  /// Returns false while the connection is down; messages sent meanwhile are lost.
  virtual bool connected() const = 0;
  /// Returns a number that rises with every new connection. Requests sent on an older connection
  /// get no reply.
  virtual std::uint32_t generation() const = 0;
  virtual LinkTraffic traffic() const = 0;
};

}  // namespace mirage
