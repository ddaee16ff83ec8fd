#pragma once
// Site: the page of a server, as files that lie in a folder.

#include <map>
#include <string>

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"

namespace mirage {

/// Fetches the page of the server on a port of this machine, by name: index.html, with the home
/// view's picture in it, and all that it refers to. The page is told to read a folder. Without a
/// page in the server it is empty. Errors kNetworkConnect, kNetworkClosed.
Result<std::map<std::string, Bytes>> fetch_site(int port);

}  // namespace mirage
