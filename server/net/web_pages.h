#pragma once
// The viewer page for browsers: the files of a folder made by scripts/web, held in memory in the
// form they are sent.
// Thread: read when the server starts, then by the network loop alone.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "protocol/base/result.h"
#include "server/net/forwarded.h"

namespace mirage {

struct WebFile {
  std::string type;      ///< MIME type of the content
  std::string encoding;  ///< br, gzip or none
  bool page = false;     ///< index.html: never cached, as it names the other files
  bool shared = false;   ///< a part beside it, whose name stays: pages of other sites use it
  std::shared_ptr<const std::string> body;
  /// of a page: names in a policy (CSP) for the style and the script that stand in it
  std::string style_hash, script_hash;
};

class WebPages {
 public:
  /// Reads a page. `folder` has index.html, and folders of parts whose names change with their
  /// content; a file may have NAME.gz and NAME.br beside it. Error kIo: index.html is missing, or a
  /// file cannot be read.
  static Result<WebPages> read(const std::string& folder);

  bool empty() const { return files_.empty(); }
  /// Returns a file; nullptr: there is none. `path` is the requested path, "/" for index.html;
  /// `accepted` is the Accept-Encoding header.
  const WebFile* find(const std::string& path, const std::string& accepted) const;
  /// Returns the header lines of a file, one a line. `host`: what the browser called;
  /// `embed_origins`: pages that may show this one in a frame, besides its own.
  static std::string headers(const WebFile& file, const std::string& host,
                             const std::vector<std::string>& embed_origins);

 private:
  std::map<std::string, std::map<std::string, WebFile>> files_;  ///< by path, then by encoding
};

/// Returns the address of what was called, such as https://example.org:9870; empty: no browser
/// sends such a Host.
std::string address_of(const Called& called);
/// Returns a text that is the same text in HTML, between quotes as well.
std::string escaped(const std::string& text);

/// True if an Accept-Encoding header accepts this encoding: it names it, without q=0.
bool accepts_encoding(const std::string& accepted, const std::string& encoding);

/// Returns the folder where scripts/web or an installation put the page, relative to this program;
/// empty: none.
std::string web_folder_beside_program();

}  // namespace mirage
