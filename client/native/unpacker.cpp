#include "client/native/unpacker.h"

#include <utility>

#include "client/native/quiet_thread.h"
#include "protocol/wire/unpack.h"

namespace mirage {

Unpacker::Unpacker(Hooks hooks, bool packed)
    : hooks_(std::move(hooks)),
      packed_(packed),
      queue_(SIZE_MAX),
      thread_(quiet_thread("mirage-unpack", [this] { run(); })) {}

Unpacker::~Unpacker() {
  queue_.close();
  while (queue_.try_pop()) continue;  // nobody takes them any more
  thread_.join();
}

void Unpacker::add(Received received) { queue_.push(std::move(received)); }

void Unpacker::run() {
  MessageUnpacker unpacker;
  while (std::optional<Received> next = queue_.pop()) {
    const Result<void> done = packed_ ? Result<void>() : unpacker.unpack(next->message);
    if (!done) {
      hooks_.damaged(next->generation, done.error());
    } else {
      hooks_.unpacked(std::move(*next));
    }
  }
}

}  // namespace mirage
