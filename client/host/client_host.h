#pragma once
// A client of one server, whole but for its frame loop: the link, modelled if asked for, the
// session on it, and the renderer that takes what arrives. Thread: the GL one.

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

class ClientSession;
class FrameRenderer;
class ModelledLink;
class NativeLink;
struct LinkTraffic;
struct LinkUse;
struct TileSink;

struct HostOptions {
  std::string url;
  bool virtual_time = false;  ///< time passes only as it is told to; the link is modelled
  std::optional<NetModel> net;
  double connect_timeout_s = 10;
  ClientOptions session;
  std::function<void()> wake;  ///< called by the network thread when something came; may be empty
  std::function<void()> content_changed;  ///< texels, geometry or a scene came; may be empty
};

class ClientHost {
 public:
  /// A GL context is current; `renderer` outlives the host.
  ClientHost(HostOptions options, FrameRenderer& renderer);
  ~ClientHost();

  /// Connects. Errors kUsage, kNetworkConnect.
  Result<void> open();
  /// Takes in what comes until the scene is known, letting virtual time pass. Errors kAuth,
  /// kNetworkClosed, and what the scene was refused for.
  Result<void> wait_for_scene();
  /// The same until the scene or a view of it can be drawn.
  Result<void> wait_for_picture();
  /// The server's full render of a camera at the time of the session's last frame, out of band:
  /// neither bytes nor virtual time. Errors kComparison, kNetworkTimeout.
  Result<ReferenceFrame> reference(const Camera& camera, std::uint32_t supersample);

  ClientSession& session() { return *session_; }
  const ClientSession& session() const { return *session_; }
  const NativeLink& native() const { return *native_; }
  LinkTraffic traffic() const;
  /// Session time in µs: the clock's, without what was left out.
  std::int64_t now_us() const { return clock_->now_us() - left_out_us_; }
  const Clock& clock() const { return *clock_; }
  /// Whether a network is modelled between the session and the socket.
  bool modelled() const { return modelled_ != nullptr; }
  /// Of the last moments; nullopt in real time.
  std::optional<LinkUse> link_use();
  /// Null in real time.
  VirtualClock* virtual_clock() { return virtual_clock_; }
  /// Leaves the time since `clock_us` (of clock()) out of the session's.
  void leave_out_since(std::int64_t clock_us) { left_out_us_ += clock_->now_us() - clock_us; }

 private:
  TileSink sink();
  Result<void> wait_until(const std::function<bool()>& there);

  HostOptions options_;
  FrameRenderer& renderer_;
  std::unique_ptr<Clock> clock_;
  VirtualClock* virtual_clock_ = nullptr;
  std::int64_t left_out_us_ = 0;
  std::unique_ptr<NativeLink> native_;
  std::unique_ptr<ModelledLink> modelled_;
  std::unique_ptr<ClientSession> session_;
};

}  // namespace mirage
