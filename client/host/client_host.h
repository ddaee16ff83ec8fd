#pragma once
// Client host: connects a client to a server. It owns the link, modelled if asked for, and the
// clock.
// Input:  a server's address and options.
// Output: a session of the client.
// Thread: the GL thread.
// Full:   as link and session (native_link.h, client_session.h).

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "client/frame/reference_frame.h"
#include "client/link/net_model.h"
#include "client/session/session_options.h"
#include "protocol/base/clock.h"
#include "protocol/base/result.h"

namespace mirage {

class Client;
class ClientSession;
class FolderLink;
class ModelledLink;
class NativeLink;
struct LinkTraffic;
struct LinkUse;
struct ServerUrl;

struct HostOptions {
  std::string url;            ///< of a server, or the name of a frozen folder
  std::string ca_file;        ///< ServerUrl::ca_file
  bool virtual_time = false;  ///< time advances only when told to; the link is modelled
  std::optional<NetModel> net;
  double connect_timeout_s = 10;
  ClientOptions session;
  /// The network thread calls it when something arrived; may be empty.
  std::function<void()> wake;
};

class ClientHost {
 public:
  /// `client` must outlive the host, which ends its session.
  ClientHost(HostOptions options, Client& client);
  ~ClientHost();

  /// Connects. Errors kUsage, kNetworkConnect; of a folder those of FolderLink::open().
  Result<void> open();
  /// Takes in what arrives until the scene is known, and lets virtual time pass. Errors kAuth,
  /// kNetworkClosed, and the error for which the scene was refused.
  Result<void> wait_for_scene();
  /// Takes in what arrives until the scene, or a view of it, can be drawn. Errors as
  /// wait_for_scene().
  Result<void> wait_for_picture();
  /// Returns the server's full render for a camera, at the time of the session's last frame. It is
  /// out of band: it takes neither bytes nor virtual time. Errors kComparison, kNetworkTimeout.
  Result<ReferenceFrame> reference(const Camera& camera, std::uint32_t supersample);

  ClientSession& session();
  const ClientSession& session() const;
  /// Waits until a server has said something, or the time is over.
  void wait_message(int timeout_ms) const;
  /// True while the connection is up; a folder is always there.
  bool link_up() const;
  LinkTraffic traffic() const;
  /// Closes the connection to a server and opens another one; the session goes on.
  void reconnect();
  /// Returns the session's time, µs: that of the clock minus what leave_out_since() has left out.
  std::int64_t now_us() const { return clock_->now_us() - left_out_us_; }
  const Clock& clock() const { return *clock_; }
  /// True if a network is modelled between the session and the socket.
  bool modelled() const { return modelled_ != nullptr; }
  /// Returns the recent use of link and server; nullopt on real time.
  std::optional<LinkUse> link_use();
  /// Returns the virtual clock; nullptr on real time.
  VirtualClock* virtual_clock() { return virtual_clock_; }
  /// Leaves the time since `clock_us` (of clock()) out of the session's time.
  void leave_out_since(std::int64_t clock_us) { left_out_us_ += clock_->now_us() - clock_us; }

 private:
  Result<void> open_folder();
  Result<void> open_server();
  /// Waits for the connection. Errors: those of no_answer().
  Result<void> wait_connected(const ServerUrl& url);
  /// Returns why a scene will not come any more; nullopt: it may.
  std::optional<Error> hopeless(std::int64_t waited_us) const;
  Result<void> wait_until(const std::function<bool()>& there);

  HostOptions options_;
  Client& client_;
  std::unique_ptr<Clock> clock_;
  VirtualClock* virtual_clock_ = nullptr;
  std::int64_t left_out_us_ = 0;
  std::unique_ptr<NativeLink> native_;  ///< to a server
  std::unique_ptr<FolderLink> folder_;  ///< in place of one
  std::unique_ptr<ModelledLink> modelled_;
};

}  // namespace mirage
