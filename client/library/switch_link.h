#pragma once
// Switch link: a link whose connection a program replaces or drops while its session goes on.
// Input:  messages to send; a server's address.
// Output: messages of the present connection.
// Thread: one at a time.
// Full:   as NativeLink.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "client/link/link.h"
#include "protocol/base/result.h"

namespace mirage {
class NativeLink;
struct ServerUrl;
}  // namespace mirage

namespace mirage::library {

class SwitchLink final : public Link {
 public:
  SwitchLink();
  ~SwitchLink() override;
  /// Connects to another server.
  void connect(const ServerUrl& url, std::function<void()> arrived);
  /// Drops the connection.
  void drop();
  /// True from connect() to drop().
  bool wanted() const { return native_ != nullptr; }
  /// Drops the connection and makes it anew.
  void reconnect();

  void send(Bytes message) override;
  std::vector<Message> receive() override;
  bool connected() const override;
  std::uint32_t generation() const override;
  LinkTraffic traffic() const override;

  /// Returns why the connection failed; nullopt: it did not.
  std::optional<Error> problem() const;

 private:
  std::unique_ptr<NativeLink> native_;
  std::string address_;  ///< of the server
  bool tls_ = false;
  std::int64_t tried_us_ = 0;  ///< when connecting to it began, by the steady clock
  std::uint32_t former_ = 0;   ///< generations of former connections
};

}  // namespace mirage::library
