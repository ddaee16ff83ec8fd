#pragma once
// Unpacker: unpacks what a link receives, so that a frame which takes a message only copies.
// Input:  messages as decoded from the wire, each with the time at which it came.
// Output: the same messages, unpacked (protocol/wire/unpack.h), in the order in which they came.
// Thread: its own.
// Full:   the link stops reading while many wait: waiting() tells.

#include <chrono>
#include <cstdint>
#include <functional>
#include <thread>

#include "protocol/base/bounded_queue.h"
#include "protocol/wire/message.h"

namespace mirage {

class Unpacker {
 public:
  struct Received {
    std::chrono::steady_clock::time_point came;
    std::uint32_t generation = 0;  ///< of the connection
    Message message;
  };
  /// Called on the unpacker's thread: a message is unpacked, or damaged.
  struct Hooks {
    std::function<void(Received)> unpacked;
    std::function<void(std::uint32_t generation, const Error&)> damaged;
  };

  /// `packed`: messages pass as they came.
  explicit Unpacker(Hooks hooks, bool packed = false);
  ~Unpacker();

  void add(Received received);
  /// Returns the number of messages that wait.
  std::size_t waiting() const { return queue_.size(); }

 private:
  void run();

  Hooks hooks_;
  const bool packed_;
  BoundedQueue<Received> queue_;
  std::thread thread_;
};

}  // namespace mirage
