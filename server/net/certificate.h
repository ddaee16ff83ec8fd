#pragma once
#include <string>

#include "protocol/base/result.h"

namespace mirage {

/// Whether a chain of certificates and a private key, PEM files, can be read and belong together.
/// Error kIo.
Result<void> check_certificate(const std::string& chain_path, const std::string& key_path);

}  // namespace mirage
