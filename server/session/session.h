#pragma once
// Sessions: everything between the socket and the stages, without any socket.
// Input:  whole messages of clients; completions of the stages
// Output: packets to write, in order of priority (control first, then the scene's description;
//         tiles under credit and bulk share the rest by bytes)
// Thread: the network loop's
// Full:   asks beyond kMaxQueuedAsksPerClient are refused as busy; a client with
//         max_outbox_bytes unread gets no more, and is closed if it reads nothing

#include <list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "protocol/model/scene_types.h"
#include "server/session/fetch_requests.h"
#include "server/session/form_requests.h"
#include "server/session/got_tile.h"
#include "server/session/picture_cache.h"
#include "server/session/picture_request.h"
#include "server/session/scene_pages.h"
#include "server/session/session_options.h"
#include "server/session/view_cache.h"
#include "server/tile/stage_queues.h"

namespace mirage {

struct EncodedParts;
struct HubState;
struct TileAddress;

class SessionHub {
 public:
  SessionHub(std::shared_ptr<const PreparedScene> scene, SessionOptions options,
             StageQueues& queues);
  ~SessionHub();

  /// Returns the hash of the scene and of what draws it. Servers with equal revisions have equal
  /// tiles for equal keys.
  std::uint64_t revision() const { return revision_; }
  /// Has the home view made, which most clients ask for first.
  void make_home_view();
  /// Opens a session for a connection. It becomes a client with a valid hello.
  SessionId open();
  bool greeted(SessionId id) const { return sessions_.at(id).greeted; }
  /// Returns the choice that an admitted hello asks for and that this hub does not show. The
  /// session is not greeted; the hub that shows it is to be given the hello.
  const std::optional<SceneChoice>& wants_elsewhere(SessionId id) const {
    return sessions_.at(id).elsewhere;
  }
  /// Sets the number of clients that were admitted here and went to other hubs. They count for
  /// max_clients.
  void set_clients_elsewhere(std::size_t clients) { clients_elsewhere_ = clients; }
  /// Takes one packet. An error means: say goodbye and close with its close code.
  Result<void> receive(SessionId id, const std::uint8_t* bytes, std::size_t size);
  void close(SessionId id);

  void complete(Completion completion);
  /// Refuses asks whose deadline passed in the queue.
  void refuse_late();
  /// True if an ask waits for the sources; give_up_fetches() is then due every few ms.
  bool waits_for_sources() const { return fetches_.waiting(); }
  /// Has tiles rendered that the sources do not bring in time.
  void give_up_fetches();

  /// Asks for a tile on behalf of HTTP. Returns the number that take_got() uses for the answer,
  /// which may be there at once.
  std::uint32_t get(const TileAddress& address);
  /// Asks for a picture on behalf of HTTP; take_pictures() has the answer, as above.
  std::uint32_t get(PictureRequest picture);
  /// Cancels a request that nobody waits for any more.
  void cancel_get(std::uint32_t request);
  std::vector<GotTile> take_got();
  std::vector<GotPicture> take_pictures();

  /// Returns the next packet to write; nullptr: the client may be sent nothing now.
  PacketPtr next_packet(SessionId id);
  /// Returns the sessions that got something to write since the last call.
  std::set<SessionId> take_writable();
  /// Returns the sessions to close: without a hello in time, or not reading.
  std::vector<std::pair<SessionId, Error>> overdue();
  void say_goodbye_to_all(const std::string& text);
  /// Sets the rights of new clients; present clients stay.
  void set_access(Access access) { access_ = std::move(access); }
  const Access& access() const { return access_; }
  /// Refuses new asks; earlier ones are still answered.
  void drain() { draining_ = true; }
  /// True if every answer is made and sent, as far as clients read.
  bool drained() const;
  /// The renderer's failure, which must end the server.
  const std::optional<Error>& failure() const { return failure_; }
  HubState state() const;
  /// Returns the pending asks of a session in all stages; 0 for a closed session.
  std::size_t asks_of(SessionId id) const;
  const SessionOptions& options() const { return options_; }
  /// Returns revision and profile as JSON, for comparing servers.
  std::string identity(bool draining) const;

 private:
  struct Session {
    std::int64_t opened_us = 0;
    bool greeted = false;
    std::optional<SceneChoice> elsewhere;  ///< set: it waits for the hub that shows this
    Grant grant;
    PacketAssembler assembler{limits::kMaxInboundTransferBytes};
    std::vector<TileCodec> codecs;  ///< common to both ends; the first is the default
    std::map<std::uint32_t, Lighting> lighting;
    std::list<TreeTelling> tree;      ///< answers to open requests, made as they are sent
    std::list<wire::MeshAsk> meshes;  ///< asked for; made as they are sent
    std::size_t next_page = 0;        ///< next page of the scene description
    Outbox outbox;
    /// One at a time, from the request until its reply is being sent.
    enum class FullRender { kNone, kUnderWay, kSending } full_render = FullRender::kNone;
    std::size_t full_render_bytes = 0;  ///< upper limit of its bytes, while there is one
    bool hopeless = false;              ///< reads no answers: is closed
    std::int64_t progress_us = 0;       ///< last time of sending, or of having nothing to send
    explicit Session(std::size_t most_bytes) : outbox(most_bytes) {}
  };

  /// Session id that stands for all requests by HTTP.
  static constexpr SessionId kGetters = 0;

  Result<void> handle(SessionId id, Session& s, Message message);
  /// Returns the rights of a client, from its hello.
  Result<Grant> admit(const wire::HelloT& hello);
  Result<void> hello(SessionId id, Session& s, const wire::HelloT& hello);
  void batch(SessionId id, Session& s, const wire::RequestBatchT& batch);
  void ask(SessionId id, const wire::Ask& ask, const Lighting& lighting, TileCodec codec);
  /// Answers from memory, or has the form made from one in memory; false: the tile is not in
  /// memory.
  bool answer_from_memory(const TileAsk& ask);
  void have_rendered(const TileAsk& ask);
  /// True if the object has tiles of this kind under this lighting.
  bool can_be(std::uint8_t channels, const ObjectDescription& object,
              const Lighting& lighting) const;
  void mesh_ask(SessionId id, Session& s, const wire::MeshAsk& ask);
  void image_ask(SessionId id, Session& s, const wire::ImageAsk& ask);
  void push_image(SessionId id, std::uint32_t request, const ImageLevel& level, const Bytes& bytes);
  void ground(SessionId id, Session& s, const wire::GroundRequestT& m);
  void push_ground(SessionId id, std::uint32_t request, GroundBlockId block,
                   const EncodedGround& ground);
  void open_groups(SessionId id, Session& s, const wire::OpenRequestT& m);
  Result<void> set_lighting(Session& s, const wire::SetLightingT& m);
  void reference(SessionId id, Session& s, const wire::ReferenceRequestT& m);
  /// True if the full renders of all clients leave room for one of `more` bytes.
  bool full_render_fits(std::size_t more) const;
  ViewJob view_job(const wire::ViewRequestT& m, const Lighting& lighting) const;
  void view(SessionId id, Session& s, const wire::ViewRequestT& m);
  void push_view(const ViewCache::Waiting& waiting, const EncodedView& view);
  void stats(SessionId id, const wire::StatsRequestT& m);

  /// True if something may be sent to the client now, made already or not.
  bool waits(const Session& s) const;
  /// Restarts the no-progress clock if the client had nothing to read. Called before more is added.
  void begin_waiting(Session& s) const;
  void push(SessionId id, Outbox::Lane lane, Bytes message);
  /// Makes the next mesh that the client asked for, and queues it.
  void push_mesh(SessionId id, Session& s);
  /// Makes the next page of the tree that the client asked for.
  static PacketPtr next_tree_page(Session& s);
  /// Queues a tile for the client that waits for it; got() does so for HTTP.
  void push_tile(const Waiter& waiter, const StoredTile& tile);
  void got(const Waiter& waiter, const StoredTile& tile);
  bool waits_still(SessionId id) const { return id == kGetters || sessions_.count(id) != 0; }
  // Completions of the stages.
  void finish(FinishedTile done);
  void finish(TooLargeTile done);
  void finish(FinishedFetch done);
  void finish(PendingFetch done);
  void finish(FinishedImage done);
  void finish(FinishedGround done);
  void finish(FinishedView done);
  void finish(FinishedReference done);
  void finish(FinishedPicture done);
  void finish(LevelsMade done);
  void finish(RendererFailure done) { failure_ = std::move(done.error); }
  /// Has the waiter's form made. If too much is under way, the waiter gets `lossless` instead.
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
  /// Scene description, made once. Empty while the scene waits for its levels of detail, which are
  /// described in it.
  std::vector<PacketPtr> pages_;
  const Bytes probe_page_;  ///< a whole message; empty: the scene has no probe
  const BoundedQueue<EncodeJob>& pixels_;
  std::unique_ptr<EncodedParts> parts_;
  FetchRequests fetches_;
  FormRequests forms_;
  ViewCache views_;
  PictureCache pictures_;
  std::map<SessionId, Session> sessions_;
  std::set<SessionId> writable_;
  SessionId next_id_ = 1;
  std::vector<GotTile> got_;
  std::vector<GotPicture> got_pictures_;
  std::uint32_t next_get_ = 1;
  std::size_t clients_ = 0;  ///< sessions with a valid hello
  std::size_t clients_elsewhere_ = 0;
  bool draining_ = false;
  std::optional<Error> failure_;
  double tile_us_ = 0;  ///< mean time of recent tiles, µs; 0: none rendered yet
};

}  // namespace mirage
