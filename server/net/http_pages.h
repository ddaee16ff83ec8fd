#pragma once
// Answers over HTTP: health, metrics, tiles and the browser page.
// Input:  requests as libwebsockets reads them; tiles from the hub
// Output: answers
// Thread: the network loop's
// Full:   tiles wait in the tile queue like those of a client, and are refused as busy (503)

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <variant>

#include "protocol/base/clock.h"
#include "server/download/download_desk.h"
#include "server/net/front_page.h"
#include "server/net/tile_http.h"
#include "server/net/web_pages.h"
#include "server/tile/tile_job.h"

struct lws;

namespace mirage {

class Admission;
struct Counters;
struct EndpointOptions;
class SessionHub;

/// State of one HTTP connection; libwebsockets fills it with zeros and frees it.
struct HttpPeer {
  std::uint32_t request;    ///< of the tile or picture it waits for; 0: none
  HttpAnswer* answer;       ///< answer to be written; null: none
  const std::string* file;  ///< file of the browser page being sent; null: none
  std::size_t sent;         ///< bytes of the file sent so far
  /// keeps a file that was made for somebody; null: none
  std::shared_ptr<const std::string>* held;
};

class HttpPages {
 public:
  HttpPages(const EndpointOptions& options, Admission& admission)
      : options_(options), admission_(admission) {}

  /// Answers later requests from this hub. Requests that wait for a tile of the old hub are told to
  /// come back.
  void serve(SessionHub& hub, Counters& counters);

  /// Serves this page to browsers.
  void serve(WebPages web) { web_ = std::move(web); }

  /// Has downloads made of this scene.
  void serve(DownloadScene scene) { desk_.emplace(std::move(scene)); }

  // These return the value that the libwebsockets callback must return.
  int answer(lws* wsi, HttpPeer& peer, const std::string& path, bool stopping);
  /// Answers at the address of --admin: always metrics, never tiles.
  int answer_operator(lws* wsi, const std::string& path, bool stopping) const;
  int write(lws* wsi, HttpPeer& peer);
  void gone(HttpPeer& peer);

  /// Passes the tiles and pictures that the hub has finished to the connections that wait for them.
  void hand_out();
  bool waiting() const { return !waiting_.empty() || !pictures_.empty(); }

 private:
  struct Waiting {
    lws* wsi;
    HttpPeer* peer;
    TileCodec codec;
    std::string if_none_match;
  };
  struct WaitingForPicture {
    lws* wsi;
    HttpPeer* peer;
    PictureFormat format;
    std::string tag, address;
  };
  HttpAnswer page(const std::string& path, bool stopping) const;
  std::string metrics() const;
  int get_tile(lws* wsi, HttpPeer& peer, const std::string& path);
  int get_picture(lws* wsi, HttpPeer& peer, const std::string& path);
  /// Reads who asks for what; refuses whoever has given too many wrong tokens, and other methods
  /// than GET.
  std::variant<HttpRequest, HttpAnswer> read(lws* wsi, const std::string& path,
                                             const std::string& address) const;
  /// Sends index.html with the poster, or asks for one, for the next who come.
  int get_front(lws* wsi, const std::string& address, bool head);
  int get_oembed(lws* wsi) const;
  int get_download(lws* wsi, HttpPeer& peer, const std::string& path);
  /// Returns this server's address, as the request called it; empty: the scene is not for
  /// everybody.
  std::string open_address(lws* wsi) const;
  void ask_poster(PosterShape shape);
  /// Sends a refusal, and remembers a wrong token.
  int refuse(lws* wsi, const HttpAnswer& answer, const std::string& address);
  /// Lets a connection wait for the hub's answer to a request.
  void wait(lws* wsi, HttpPeer& peer, std::uint32_t request, int patience_s);
  static void give(lws* wsi, HttpPeer& peer, HttpAnswer answer);
  /// Forgets pictures whose connections the other side has closed, at most ten times a second.
  void drop_gone();
  int get_file(lws* wsi, HttpPeer& peer, const WebFile& file);
  /// Sends the header of a file, and the file as fast as it is read.
  static int send_file(lws* wsi, HttpPeer& peer, const std::string& type,
                       const std::string& headers, const std::string& body, bool head);
  static int write_file(lws* wsi, HttpPeer& peer);

  SessionHub* hub_ = nullptr;
  Counters* counters_ = nullptr;
  const EndpointOptions& options_;
  Admission& admission_;
  const SteadyClock clock_;
  WebPages web_;
  std::optional<DownloadDesk> desk_;  ///< nullopt: nobody may download
  /// Home view of the hub's scene.
  struct Poster {
    std::uint32_t request = 0;          ///< number at the hub; 0: it is not asked for
    std::shared_ptr<const Bytes> file;  ///< null: it is not there
  };
  std::map<PosterShape, Poster> posters_;  ///< of the shapes that somebody has come for
  /// pages with a poster, by what was called; true: gzip
  std::map<std::tuple<std::string, PosterShape, bool>, std::string> fronts_;
  // Keys are request numbers of the hub.
  std::map<std::uint32_t, Waiting> waiting_;
  std::map<std::uint32_t, WaitingForPicture> pictures_;
  std::int64_t looked_us_ = 0;  ///< when drop_gone() last looked
};

}  // namespace mirage
