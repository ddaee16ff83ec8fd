#pragma once
// Link: whole messages to and from a server. Client logic sees no sockets: a native link, a browser
// link and a modelled link all look the same.

#include <cstdint>
#include <vector>

#include "protocol/wire/message.h"

namespace mirage {

struct LinkTraffic {
  std::uint64_t bytes_up = 0;    ///< framing included
  std::uint64_t bytes_down = 0;  ///< without reference frames, which are no part of the product
};

class Link {
 public:
  virtual ~Link() = default;
  /// Takes a message to send; never blocks.
  virtual void send(Bytes message) = 0;
  /// Messages that have arrived by now, in order, with how long ago that was.
  virtual std::vector<Message> receive() = 0;
  /// False while the connection is down; messages sent meanwhile are lost.
  virtual bool connected() const = 0;
  /// Rises with every new connection: what was asked on an older one will not be answered.
  virtual std::uint32_t generation() const = 0;
  virtual LinkTraffic traffic() const = 0;
};

}  // namespace mirage
