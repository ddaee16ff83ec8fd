#include "server/net/certificate.h"

#include <openssl/err.h>
#include <openssl/ssl.h>

#include <memory>

namespace mirage {

Result<void> check_certificate(const std::string& chain_path, const std::string& key_path) {
  const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context(SSL_CTX_new(TLS_server_method()),
                                                                  SSL_CTX_free);
  const bool right =
      context && SSL_CTX_use_certificate_chain_file(context.get(), chain_path.c_str()) == 1 &&
      SSL_CTX_use_PrivateKey_file(context.get(), key_path.c_str(), SSL_FILETYPE_PEM) == 1 &&
      SSL_CTX_check_private_key(context.get()) == 1;
  if (right) return {};
  const char* why = ERR_reason_error_string(ERR_peek_last_error());
  Error error = make_error(ErrorId::kIo,
                           "certificate '" + chain_path + "' with key '" + key_path +
                               "': " + (why ? why : "cannot be read"),
                           "both are PEM files, the key without a passphrase");
  ERR_clear_error();
  return error;
}

}  // namespace mirage
