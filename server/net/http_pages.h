#pragma once
// What is answered over HTTP: health, metrics, tiles.
// Input:  requests as libwebsockets reads them; tiles as the hub has them. Output: answers.
// Thread: the network loop's.
// Full:   tiles wait in the tile queue as a client's do, and are refused as busy (503).

#include <cstdint>
#include <map>
#include <string>

#include "protocol/base/clock.h"
#include "server/net/tile_http.h"
#include "server/net/web_pages.h"

struct lws;

namespace mirage {

class Admission;
struct Counters;
struct EndpointOptions;
class SessionHub;

/// What belongs to one HTTP connection; libwebsockets fills it with zeros and frees it.
struct HttpPeer {
  std::uint32_t request;    ///< of the tile it waits for; 0: none
  HttpAnswer* answer;       ///< to be written
  const std::string* file;  ///< under way: of the page for browsers
  std::size_t sent;         ///< of it, bytes
};

class HttpPages {
 public:
  HttpPages(const EndpointOptions& options, Admission& admission)
      : options_(options), admission_(admission) {}

  /// What is asked from now on is answered by these; who waits for a tile of others is told to come
  /// back.
  void serve(SessionHub& hub, Counters& counters);

  /// From now on browsers get this page.
  void serve(WebPages web) { web_ = std::move(web); }

  // These return what the libwebsockets callback is to return.
  int answer(lws* wsi, HttpPeer& peer, const std::string& path, bool stopping);
  /// At the address of --admin: metrics always, tiles not.
  int answer_operator(lws* wsi, const std::string& path, bool stopping) const;
  int write(lws* wsi, HttpPeer& peer);
  void gone(HttpPeer& peer);

  /// Has written what the hub has for those who wait.
  void hand_out();
  bool waiting() const { return !waiting_.empty(); }

 private:
  struct Waiting {
    lws* wsi;
    HttpPeer* peer;
    TileCodec codec;
    std::string if_none_match;
  };
  HttpAnswer page(const std::string& path, bool stopping) const;
  std::string metrics() const;
  int get_tile(lws* wsi, HttpPeer& peer, const std::string& path);
  int get_file(lws* wsi, HttpPeer& peer, const WebFile& file) const;
  static int write_file(lws* wsi, HttpPeer& peer);

  SessionHub* hub_ = nullptr;
  Counters* counters_ = nullptr;
  const EndpointOptions& options_;
  Admission& admission_;
  const SteadyClock clock_;
  WebPages web_;
  std::map<std::uint32_t, Waiting> waiting_;  ///< by the hub's number
};

}  // namespace mirage
