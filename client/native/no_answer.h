#pragma once
// The reason why a server did not take a connection, in words for a person.

#include <optional>
#include <string>

#include "client/native/server_url.h"
#include "protocol/base/result.h"

namespace mirage {

/// Returns the error kNetworkConnect for a server that did not take a connection. It asks the
/// server's port once more, for at most 3 s, whether it speaks TLS and whether its certificate is
/// trusted here. `shown`: the address as the user wrote it; `problem`: what the last try said, or
/// nothing.
Error no_answer(const ServerUrl& url, const std::string& shown, const std::string& problem);
/// Returns the part of that which waiting does not mend: a server that speaks TLS or none, or a
/// certificate that is not trusted here. nullopt: none of these.
std::optional<Error> wrong_tls(const ServerUrl& url, const std::string& shown);

}  // namespace mirage
