#pragma once
#include <string>

#include "protocol/base/result.h"

namespace mirage {

/// Checks that a certificate chain and a private key, both PEM files, can be read and belong
/// together. Error kIo.
Result<void> check_certificate(const std::string& chain_path, const std::string& key_path);

}  // namespace mirage
