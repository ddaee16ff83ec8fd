#pragma once
// Rig: a server and a client in one process on virtual time: the shipped sessions, queue, store,
// codecs, modelled link and client session. Only the pixels of tiles are made up; they are a pure
// function of the key and compress like real ones.

#include <functional>
#include <memory>
#include <vector>

#include "client/frame/draw_list.h"
#include "client/hold/tile_cache.h"
#include "client/link/modelled_link.h"
#include "client/plan/selector.h"
#include "client/scene/scene_view.h"
#include "client/session/client_session.h"
#include "client/session/session_options.h"
#include "client/session/tile_sink.h"
#include "server/prepare/prepared_scene.h"
#include "server/session/session.h"
#include "server/tile/stage_queues.h"

namespace mirage::test {

/// Returns the CPU time that this thread has used, s; other load of the machine does not count.
double thread_seconds();

/// A clock that is set by hand, even backwards.
class HandClock final : public Clock {
 public:
  std::int64_t now_us() const override { return now_us_; }
  void set_us(std::int64_t t) { now_us_ = t; }

 private:
  std::int64_t now_us_ = 0;
};

/// Content of a rig's scene.
struct RigScene {
  int objects = 24;      ///< each with one instance, in rows on the ground
  double spacing_m = 4;  ///< between them; the radius of each is about 1 m
  double clip_s = 0;     ///< length of every object's animation; 0: they do not move
};
/// Returns a scene of many knots: described, not drawn.
std::shared_ptr<const PreparedScene> rig_scene(const RigScene& options);

/// The server without sockets and without a renderer.
class Host {
 public:
  Host(std::shared_ptr<const PreparedScene> scene, const Clock& clock, SessionOptions options);

  SessionHub& hub() { return *hub_; }
  TileQueue& queue() { return queues_.tiles; }
  /// Renders at most `count` of the waiting tiles. Returns their number.
  std::size_t render(std::size_t count = SIZE_MAX);
  /// Returns everything that the client may be sent now.
  std::vector<Message> messages_for(SessionId id);
  /// Returns the CPU time spent here, s.
  double busy_s() const { return busy_s_; }
  void add_busy(double seconds) { busy_s_ += seconds; }

 private:
  StoredTilePtr make(const TileJob& job) const;
  /// Makes forms of stored tiles for the clients that wait for them.
  void make_forms();

  std::shared_ptr<const PreparedScene> scene_;
  StageQueues queues_;
  std::unique_ptr<SessionHub> hub_;
  double busy_s_ = 0;
};

/// A client's connection to the host. By itself it answers at once and renders everything asked
/// for.
class HostLink final : public Link {
 public:
  explicit HostLink(Host& host, bool renders = true) : host_(host), renders_(renders) { connect(); }
  void send(Bytes bytes) override;
  std::vector<Message> receive() override;
  bool connected() const override { return up_; }
  std::uint32_t generation() const override { return generation_; }
  LinkTraffic traffic() const override { return {}; }

  /// Opens a new connection.
  void connect();
  void disconnect();
  SessionId id() const { return id_; }
  /// Returns the server's complaint about this client; empty: none.
  const std::string& complaint() const { return complaint_; }
  std::uint64_t batches() const { return batches_; }

 private:
  Host& host_;
  bool renders_;
  bool up_ = false;
  SessionId id_ = 0;
  std::uint32_t generation_ = 0;
  std::string complaint_;
  std::uint64_t batches_ = 0;
};

/// Options of a client and its link.
struct RigOptions {
  NetModel net;
  ClientOptions client;
  std::int64_t frame_us = 16'667;
  /// Makes a link between the session and the modelled link.
  std::function<std::unique_ptr<Link>(Link&)> wrap;
};

class Rig {
 public:
  Rig(std::shared_ptr<const PreparedScene> scene, const RigOptions& options);

  /// Runs one frame of the client at the present time, then advances to the next frame's time.
  DrawList frame(const Pose& pose);
  /// Runs frames for `seconds`; `pose` gets the seconds since the rig began.
  DrawList run(double seconds, const std::function<Pose(double)>& pose);

  double now_s() const { return static_cast<double>(clock.now_us()) * 1e-6; }
  /// CPU time of each frame, ms, without the host's.
  std::vector<double> frame_ms;
  std::vector<double> deciding_ms;  ///< part of it without arrivals: selector and scheduler
  /// Offset that is added to the client's time.
  std::int64_t client_offset_us = 0;
  std::uint64_t uploaded_bytes = 0;

  HandClock clock, server_clock;
  Host host;
  HostLink server_link;
  ModelledLink link;
  std::unique_ptr<Link> wrapped;
  ClientSession session;
  Camera camera;
  std::function<void(const TileRecord&, const AtlasPlanes&)> on_tile;
  std::vector<std::string> errors;  ///< errors of receive(), in words

 private:
  TileSink sink();
  std::int64_t frame_us_;
};

/// Returns the eye 1.7 m up at `at`, looking at `target`.
Pose eye_at(const glm::dvec3& at, const glm::dvec3& target = {0, 0, 0});

}  // namespace mirage::test
