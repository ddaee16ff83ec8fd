#pragma once
// The viewer's page for browsers: the files of a folder that scripts/web staged, held in memory as
// they are sent. Thread: read when the server starts, then by the network loop alone.

#include <map>
#include <memory>
#include <string>

#include "protocol/base/result.h"

namespace mirage {

struct WebFile {
  std::string type;      ///< of the content
  std::string encoding;  ///< br, gzip or none
  bool page = false;     ///< index.html: never cached, for it names the others
  std::shared_ptr<const std::string> body;
};

class WebPages {
 public:
  /// `folder` has index.html, folders of parts whose names change with their content, and beside
  /// each file NAME.gz and NAME.br where there are any. Error kIo: there is no index.html, or a
  /// file cannot be read.
  static Result<WebPages> read(const std::string& folder);

  bool empty() const { return files_.empty(); }
  /// `path` as it was asked for, "/" for index.html; `accepted`: the Accept-Encoding header.
  /// nullptr: there is no such file.
  const WebFile* find(const std::string& path, const std::string& accepted) const;
  /// What goes with a file, a line each; `host`: the Host header.
  static std::string headers(const WebFile& file, const std::string& host);

 private:
  std::map<std::string, std::map<std::string, WebFile>> files_;  ///< by path, by encoding
};

/// Whether an Accept-Encoding header takes this encoding: it is named, without q=0.
bool accepts_encoding(const std::string& accepted, const std::string& encoding);

/// Where scripts/web or an installation put the page, as seen from this program; empty: nowhere.
std::string web_folder_beside_program();

}  // namespace mirage
