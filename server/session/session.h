#pragma once
// Sessions: everything between the socket and the stages, without any socket.
// Input:  whole messages of clients; completions of the stages. Output: frames to write, in order
//         of priority (control first, then the scene's description; tiles under credit and bulk
//         share the rest by bytes).
// Thread: the network loop's.
// Full:   asks beyond kMaxQueuedAsksPerClient are refused as busy; a client that does not read
//         until max_outbox_bytes have piled up gets nothing more and is closed.

#include <list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/session/fetch_requests.h"
#include "server/session/form_requests.h"
#include "server/session/got_tile.h"
#include "server/session/image_cache.h"
#include "server/session/scene_pages.h"
#include "server/session/session_options.h"
#include "server/session/view_cache.h"
#include "server/tile/stage_queues.h"

namespace mirage {

struct HubState;
struct TileAddress;

class SessionHub {
 public:
  SessionHub(std::shared_ptr<const PreparedScene> scene, SessionOptions options,
             StageQueues& queues);

  /// Equal for servers whose tiles of equal keys are equal: of the scene and of what draws it.
  std::uint64_t revision() const { return revision_; }
  /// Has the home view made, which most clients ask for first.
  void make_home_view();
  /// A connection; it is a client once its hello was right.
  SessionId open();
  bool greeted(SessionId id) const { return sessions_.at(id).greeted; }
  /// One WebSocket message. An error means: say goodbye and close with its close code.
  Result<void> receive(SessionId id, const std::uint8_t* bytes, std::size_t size);
  void close(SessionId id);

  void complete(Completion completion);
  /// Refuses asks whose deadline passed while they were queued.
  void refuse_late();
  /// Whether somebody waits for the sources: then give_up_fetches() is due every few ms.
  bool waits_for_sources() const { return fetches_.waiting(); }
  /// Has rendered what the sources do not bring in time.
  void give_up_fetches();

  /// A tile for who asks by HTTP; the number it is answered under, by take_got(), maybe at once.
  std::uint32_t get(const TileAddress& address);
  /// Nobody waits for it any more.
  void cancel_get(std::uint32_t request);
  std::vector<GotTile> take_got();

  /// Next frame to write; nullptr when there is nothing the client may be sent now.
  FramePtr next_frame(SessionId id);
  /// Sessions that got something to write since the last call.
  std::set<SessionId> take_writable();
  /// Sessions to close: never said hello, or do not read.
  std::vector<std::pair<SessionId, Error>> overdue();
  void say_goodbye_to_all(const std::string& text);
  bool all_written() const;
  /// Who may be a client from now on; those that are stay.
  void set_access(Access access) { access_ = std::move(access); }
  const Access& access() const { return access_; }
  /// Nothing more is taken on; what was asked for is answered still.
  void drain() { draining_ = true; }
  /// Everything that was asked for is answered and sent, as far as it is taken.
  bool drained() const;
  /// Why the server must end: the renderer has failed.
  const std::optional<Error>& failure() const { return failure_; }
  HubState state() const;
  /// Asks of a session that are waited for, wherever; of one that is closed there are none.
  std::size_t asks_of(SessionId id) const;
  const SessionOptions& options() const { return options_; }
  /// Revision and profile as JSON, for whoever compares servers.
  std::string identity(bool draining) const;

 private:
  struct Session {
    std::int64_t opened_us = 0;
    bool greeted = false;
    Grant grant;
    FrameAssembler assembler{limits::kMaxInboundTransferBytes};
    std::vector<TileCodec> codecs;  ///< that both ends have; the first is used unless asked
    std::map<std::uint32_t, Lighting> lighting;
    std::list<TreeTelling> tree;      ///< answers to what was asked of it, made as they are sent
    std::list<wire::MeshAsk> meshes;  ///< asked for, and made as they are sent
    std::size_t next_page = 0;        ///< of the scene description
    Outbox outbox;
    /// One at a time, from the request until its reply is on its way.
    enum class FullRender { kNone, kUnderWay, kSending } full_render = FullRender::kNone;
    std::size_t full_render_bytes = 0;  ///< it takes at most, while there is one
    bool hopeless = false;              ///< does not read what it is answered: is closed
    std::int64_t progress_us = 0;       ///< when something was last sent, or nothing waited
    explicit Session(std::size_t most_bytes) : outbox(most_bytes) {}
  };

  /// As a waiter for tiles, all who ask by HTTP.
  static constexpr SessionId kGetters = 0;

  Result<void> handle(SessionId id, Session& s, Message message);
  /// Who says this may be a client.
  Result<Grant> admit(const wire::HelloT& hello);
  Result<void> hello(SessionId id, Session& s, const wire::HelloT& hello);
  void batch(SessionId id, Session& s, const wire::RequestBatchT& batch);
  void ask(SessionId id, const wire::Ask& ask, const Lighting& lighting, TileCodec codec);
  /// Answers from memory, or has it made from what is there; false: the tile is not in memory.
  bool answer_from_memory(const TileAsk& ask);
  void have_rendered(const TileAsk& ask);
  /// Whether the object has tiles of this kind under this lighting.
  bool can_be(std::uint8_t channels, const ObjectDescription& object,
              const Lighting& lighting) const;
  void mesh_ask(SessionId id, Session& s, const wire::MeshAsk& ask);
  void image_ask(SessionId id, Session& s, const wire::ImageAsk& ask);
  void push_image(SessionId id, std::uint32_t request, const ImageLevel& level, const Bytes& bytes);
  void open_groups(SessionId id, Session& s, const wire::OpenRequestT& m);
  Result<void> set_lighting(Session& s, const wire::SetLightingT& m);
  void reference(SessionId id, Session& s, const wire::ReferenceRequestT& m);
  /// Of all clients, that one of `more` bytes may be added.
  bool full_render_fits(std::size_t more) const;
  ViewJob view_job(const wire::ViewRequestT& m, const Lighting& lighting) const;
  void view(SessionId id, Session& s, const wire::ViewRequestT& m);
  void push_view(const ViewCache::Waiting& waiting, const EncodedView& view);
  void stats(SessionId id, const wire::StatsRequestT& m);

  /// There is something that it may be sent now, made already or not.
  bool waits(const Session& s) const;
  /// Before something more is to be sent: until now it owed us no reading if nothing waited.
  void begin_waiting(Session& s) const;
  void push(SessionId id, Outbox::Lane lane, Bytes message);
  /// The next of the meshes it asked for.
  void push_mesh(SessionId id, Session& s);
  /// The next page of what was asked of the tree.
  static FramePtr next_tree_page(Session& s);
  /// The lane whose turn it is; nullptr when neither may send.
  void push_tile(const Waiter& waiter, const StoredTile& tile);
  void got(const Waiter& waiter, const StoredTile& tile);
  bool waits_still(SessionId id) const { return id == kGetters || sessions_.count(id) != 0; }
  // What the stages have done.
  void finish(FinishedTile done);
  void finish(TooLargeTile done);
  void finish(FinishedFetch done);
  void finish(PendingFetch done);
  void finish(FinishedImage done);
  void finish(FinishedView done);
  void finish(FinishedReference done);
  void finish(RendererFailure done) { failure_ = std::move(done.error); }
  /// Has the waiter's form made; while there is too much to do, it is sent this one.
  void convert(const Waiter& waiter, const TileId& id, const StoredTilePtr& lossless);
  void refuse(SessionId id, std::uint32_t request, wire::RefusalReason reason);

  std::shared_ptr<const PreparedScene> scene_;
  const SessionOptions options_;
  Access access_;
  const std::uint64_t revision_;
  const Clock& clock_;
  Counters& counters_;
  TileQueue& queue_;
  TileStore& store_;
  const std::vector<FramePtr> pages_;  ///< scene description, made once
  const Bytes probe_page_;             ///< whole message; empty: the scene has no probe
  const BoundedQueue<EncodeJob>& pixels_;
  ImageCache images_;
  FetchRequests fetches_;
  FormRequests forms_;
  ViewCache views_;
  std::map<SessionId, Session> sessions_;
  std::set<SessionId> writable_;
  SessionId next_id_ = 1;
  std::vector<GotTile> got_;
  std::uint32_t next_get_ = 1;
  std::size_t clients_ = 0;  ///< sessions that are greeted
  bool draining_ = false;
  std::optional<Error> failure_;
  double tile_us_ = 0;  ///< what a tile takes, mean of the last ones; 0: none was rendered
};

}  // namespace mirage
