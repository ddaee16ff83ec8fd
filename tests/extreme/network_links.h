#pragma once
// Network links: links that misbehave, around a link that does not.

#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "client/link/link.h"

namespace mirage::extreme {

/// Passes everything on to another link.
class Around : public Link {
 public:
  explicit Around(Link& inner) : inner_(inner) {}
  void send(Bytes bytes) override { inner_.send(std::move(bytes)); }
  std::vector<Message> receive() override { return inner_.receive(); }
  bool connected() const override { return inner_.connected(); }
  std::uint32_t generation() const override { return inner_.generation(); }
  LinkTraffic traffic() const override { return inner_.traffic(); }

 protected:
  Link& inner_;
};

/// Lets nothing through while it is closed. Nothing is lost except by lose().
class Gate final : public Around {
 public:
  using Around::Around;
  void close() { open_ = false; }
  /// Drops the messages that wait at the closed gate.
  void lose() {
    collect();
    up_.clear();
    down_.clear();
  }
  void open() {
    open_ = true;
    for (Bytes& bytes : std::exchange(up_, {})) {
      inner_.send(std::move(bytes));
      collect();
    }
  }
  void send(Bytes bytes) override {
    if (open_) return inner_.send(std::move(bytes));
    up_.push_back(std::move(bytes));
  }
  std::vector<Message> receive() override {
    collect();
    if (!open_) return {};
    return std::exchange(down_, {});
  }

 private:
  void collect() {
    for (Message& m : inner_.receive()) down_.push_back(std::move(m));
  }
  bool open_ = true;
  std::vector<Bytes> up_;
  std::vector<Message> down_;
};

/// Changes the order of messages within some calls, and delivers a fifth of them twice. Greetings
/// stay first, because nothing can be said before them.
class Scrambler final : public Around {
 public:
  Scrambler(Link& inner, std::uint64_t seed) : Around(inner), random_(seed) {}
  void send(Bytes bytes) override {
    const Result<Message> message = decode_message(bytes.data(), bytes.size());
    if (message && message->body.AsHello()) return inner_.send(std::move(bytes));
    hold(up_, std::move(bytes));
    for (Bytes& due : take_due(up_)) inner_.send(std::move(due));
  }
  std::vector<Message> receive() override {
    std::vector<Message> out;
    for (Bytes& due : take_due(up_)) inner_.send(std::move(due));
    for (Message& m : inner_.receive()) {
      if (m.body.AsWelcome()) {
        out.push_back(std::move(m));
      } else {
        hold(down_, encode_body(m.body, m.payload));
      }
    }
    for (const Bytes& due : take_due(down_)) {
      Result<Message> message = decode_message(due.data(), due.size());
      if (message) out.push_back(message.take());
    }
    return out;
  }

 private:
  struct Held {
    Bytes bytes;
    std::uint64_t calls_left = 0;
  };
  void hold(std::vector<Held>& list, Bytes bytes) {
    if (random_() % 5 == 0) list.push_back({bytes, random_() % 12});
    list.push_back({std::move(bytes), random_() % 6});
  }
  std::vector<Bytes> take_due(std::vector<Held>& list) {
    std::shuffle(list.begin(), list.end(), random_);
    std::vector<Bytes> due;
    std::vector<Held> kept;
    for (Held& h : list) {
      if (h.calls_left == 0) {
        due.push_back(std::move(h.bytes));
      } else {
        --h.calls_left;
        kept.push_back(std::move(h));
      }
    }
    list = std::move(kept);
    return due;
  }
  std::mt19937_64 random_;
  std::vector<Held> up_, down_;
};

}  // namespace mirage::extreme
