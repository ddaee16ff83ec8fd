#pragma once
// Load run: one run, phase by phase.
// Input:  options.
// Output: results; replies go to the tile verifier on their way.
// Thread: the caller's, which is also the network's.
// Full:   never; open loop: asks are sent at their times, whether earlier ones were answered or
//         not.
//
//   meet the server -> plan -> warm -> connect -> ask -> wait for answers -> close

#include <memory>
#include <unordered_map>
#include <vector>

#include "client/load/load_clients.h"
#include "client/load/message_view.h"
#include "client/load/options.h"
#include "client/load/reconnects.h"
#include "client/load/report.h"
#include "client/load/request_plan.h"
#include "client/load/tile_verifier.h"
#include "client/scene/scene_view.h"
#include "protocol/base/clock.h"

namespace mirage {

class LoadRun final : private LoadSink {
 public:
  explicit LoadRun(const LoadOptions& options) : options_(options) {}

  /// Runs all phases. Errors: kUsage, kNetworkConnect, kNetworkClosed, kNetworkTimeout, kAuth,
  /// kBusy, kWireVersion; all of them occur before asking begins. Later failures are counted in the
  /// results.
  Result<LoadResults> run();

 private:
  /// Index of the client that meets the server and warms it up. Afterwards it is like the others.
  static constexpr std::uint32_t kScout = 0;
  enum class Stage : std::uint8_t { kAway, kGreeting, kDescribed, kDown };
  struct Client {
    Stage stage = Stage::kAway;
    std::uint32_t pages = 0;    // pages of the scene's description
    std::uint32_t waiting = 0;  // unanswered asks
  };
  enum class AskState : std::uint8_t { kPlanned, kWaiting, kDone, kGivenUp };

  // The phases of a run.
  Result<void> meet_server();
  Result<void> make_plan();
  Result<void> warm_up();
  void connect_others();
  void ask_at_intended_times();
  void wait_for_answers();
  void count_unanswered();
  std::optional<wire::StatsT> server_stats();

  // Implements LoadSink.
  void on_open(std::uint32_t client) override;
  Result<void> on_message(std::uint32_t client, const std::uint8_t* bytes,
                          std::size_t size) override;
  void on_down(std::uint32_t client, const std::string& id, const std::string& text) override;

  Result<void> take_welcome(std::uint32_t client, const wire::Welcome& welcome);
  Result<void> take_page(Client& c, std::uint32_t client, const MessageView& message);
  Result<void> take_tile(std::uint32_t client, const MessageView& message);
  void take_refusal(std::uint32_t client, const wire::Refused& refused);
  /// Returns the planned ask with this id if `client` waits for it, and ends that wait.
  const PlannedAsk* answered(std::uint32_t client, std::uint32_t request_id);
  /// Counts a tile for which nobody waits any more: late, or never asked for.
  void take_late_tile(std::uint32_t client, std::uint32_t request_id, std::int64_t now_us);
  bool same_content(const wire::TileReply& reply);
  void described(Client& c, std::uint32_t client);
  void ask(std::size_t index, std::int64_t now_us);
  Phase phase_of(const TileNeed& need) const;
  Result<void> write_urls() const;
  Bytes ask_message(std::uint32_t request_id, const TileNeed& need) const;
  Error why_down() const;
  /// Serves the network until `done` or the deadline. Returns true if done.
  template <typename Done>
  bool serve_until(Done done, std::int64_t deadline_us);
  void serve(std::int64_t wait_us);
  void show_progress(std::int64_t now_us);

  void try_again();
  /// Repeats the asks that the client still waits for.
  void ask_again(std::uint32_t client);

  const LoadOptions& options_;
  SteadyClock clock_;
  std::unique_ptr<LoadClients> link_;
  TileVerifier verifier_;
  std::vector<Client> clients_;
  std::uint32_t described_ = 0;  // connected clients that know the scene
  std::uint32_t down_ = 0;
  std::string down_id_, down_text_;  // of the client that went down last
  SceneView scene_;
  std::uint32_t scene_pages_ = 0;
  std::vector<std::uint64_t> scratch_;
  RequestPlan plan_;
  std::vector<AskState> asks_;
  std::size_t waiting_ = 0;
  std::size_t next_ask_ = 0;
  Reconnects reconnects_{options_.seed};
  std::size_t warm_sent_ = 0, warm_answered_ = 0;
  std::int64_t start_us_ = 0;
  std::int64_t last_tile_us_ = 0;
  std::unordered_map<TileId, std::uint64_t> contents_;
  std::optional<wire::StatsT> stats_;
  LoadResults results_;
  const char* phase_ = "connecting";
  std::int64_t progress_us_ = 0;
  std::uint64_t progress_tiles_ = 0, progress_bytes_ = 0, tiles_seen_ = 0;
};

}  // namespace mirage
