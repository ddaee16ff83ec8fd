#include "client/freeze/site.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <regex>
#include <set>
#include <thread>

#include "protocol/base/clock.h"

namespace mirage {
namespace {

constexpr std::int64_t kPosterPatienceUs = 120'000'000;
constexpr std::chrono::milliseconds kPosterPause{200};
// Files that index.html does not name, but its scripts do.
constexpr const char* kNamedByScripts[] = {"socket_worker.js", "download.js", "archive.js"};
constexpr const char* kTold = "<meta name=\"mirage-folder\" content=\"./\">\n</head>";

struct Answer {
  int status = 0;
  Bytes body;
};

Result<Answer> get(int port, const std::string& path) {
  const int connection = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  Bytes all;
  bool whole = false;
  if (::connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) {
    const std::string request =
        "GET " + path + " HTTP/1.0\r\nHost: localhost\r\nConnection: close\r\n\r\n";
    whole = ::send(connection, request.data(), request.size(), MSG_NOSIGNAL) ==
            static_cast<ssize_t>(request.size());
    std::uint8_t block[65536];
    for (ssize_t n = 0; whole && (n = ::recv(connection, block, sizeof(block), 0)) != 0;) {
      whole = n > 0;
      if (whole) all.insert(all.end(), block, block + n);
    }
  }
  ::close(connection);
  const std::string end = "\r\n\r\n";
  const auto body = std::search(all.begin(), all.end(), end.begin(), end.end());
  if (!whole || body == all.end()) {
    return make_error(ErrorId::kNetworkClosed, "the server did not answer GET " + path);
  }
  Answer out;
  const std::string head(all.begin(), body);
  std::sscanf(head.c_str(), "HTTP/%*s %d", &out.status);
  out.body.assign(body + static_cast<std::ptrdiff_t>(end.size()), all.end());
  return out;
}

// Waits for the poster, which the server makes when it has nothing else to do.
Result<Answer> get_page(int port) {
  const SteadyClock clock;
  const std::string poster = "id=\"poster\"";
  while (true) {
    Result<Answer> page = get(port, "/");
    if (!page || page->status != 200) return page;
    const bool there = std::search(page->body.begin(), page->body.end(), poster.begin(),
                                   poster.end()) != page->body.end();
    if (there || clock.now_us() > kPosterPatienceUs) return page;
    std::this_thread::sleep_for(kPosterPause);
  }
}

}  // namespace

Result<std::map<std::string, Bytes>> fetch_site(int port) {
  std::map<std::string, Bytes> out;
  const Result<Answer> page = get_page(port);
  if (!page) return page.error();
  if (page->status != 200) return out;  // a server without a page
  std::string text(page->body.begin(), page->body.end());
  static const std::regex part("(?:src|href)=\"((w-[0-9a-f]+)/[A-Za-z0-9_.-]+)\"");
  std::set<std::string> names = {"impostor.js"};
  for (std::sregex_iterator at(text.begin(), text.end(), part), end; at != end; ++at) {
    names.insert((*at)[1]);
    for (const char* name : kNamedByScripts) names.insert((*at)[2].str() + "/" + name);
  }
  for (const std::string& name : names) {
    Result<Answer> file = get(port, "/" + name);
    if (!file) return file.error();
    if (file->status == 200) out[name] = std::move(file->body);
  }
  // Its words for other sites have this server's address.
  static const std::regex told(
      "<meta (?:property=\"og:|name=\"twitter:)[^>]*>\n?|<link rel=\"alternate\"[^>]*>\n?");
  text = std::regex_replace(text, told, "");
  const std::size_t head = text.find("</head>");
  if (head != std::string::npos) text.replace(head, 7, kTold);
  out["index.html"] = Bytes(text.begin(), text.end());
  return out;
}

}  // namespace mirage
