#include "client/native/no_answer.h"

#include <arpa/inet.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <memory>

namespace mirage {
namespace {

constexpr int kPatienceS = 3;
constexpr unsigned kNapMs = 50;

struct Free {
  void operator()(SSL_CTX* c) const { SSL_CTX_free(c); }
  void operator()(BIO* b) const { BIO_free_all(b); }
};

/// A server's answer to the beginning of TLS.
struct Handshake {
  bool done = false;
  bool other_language = false;   ///< what came back is no TLS, or nothing
  long certificate = X509_V_OK;  ///< why the certificate is not trusted: X509_V_ERR_*
};

bool is_address(const std::string& host) {
  unsigned char bytes[16];
  return inet_pton(AF_INET, host.c_str(), bytes) == 1 ||
         inet_pton(AF_INET6, host.c_str(), bytes) == 1;
}

// Begins TLS with the server, trusting any certificate, and closes the connection again.
Handshake shake_hands(const ServerUrl& url) {
  Handshake out;
  const std::unique_ptr<SSL_CTX, Free> context(SSL_CTX_new(TLS_client_method()));
  if (!context) return out;
  SSL_CTX_set_default_verify_paths(context.get());
  if (!url.ca_file.empty()) {
    SSL_CTX_load_verify_locations(context.get(), url.ca_file.c_str(), nullptr);
  }
  const std::unique_ptr<BIO, Free> connection(BIO_new_ssl_connect(context.get()));
  SSL* tls = nullptr;
  if (!connection || BIO_get_ssl(connection.get(), &tls) <= 0) return out;
  BIO_set_conn_hostname(connection.get(), url.host.c_str());
  BIO_set_conn_port(connection.get(), std::to_string(url.port).c_str());
  if (is_address(url.host)) {
    X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(tls), url.host.c_str());
  } else {
    SSL_set1_host(tls, url.host.c_str());
    SSL_set_tlsext_host_name(tls, url.host.c_str());
  }
  ERR_clear_error();
  out.done = BIO_do_connect_retry(connection.get(), kPatienceS, kNapMs) == 1;
  if (out.done) out.certificate = SSL_get_verify_result(tls);
  const unsigned long why = ERR_peek_error();
  out.other_language = ERR_GET_LIB(why) == ERR_LIB_SSL &&
                       (ERR_GET_REASON(why) == SSL_R_WRONG_VERSION_NUMBER ||
                        ERR_GET_REASON(why) == SSL_R_UNEXPECTED_EOF_WHILE_READING);
  ERR_clear_error();
  return out;
}

std::string with_scheme(const ServerUrl& url, const char* scheme) {
  const bool v6 = url.host.find(':') != std::string::npos;
  return scheme + (v6 ? "[" + url.host + "]" : url.host) + ":" + std::to_string(url.port) +
         (url.path == "/" ? "" : url.path);
}

}  // namespace

std::optional<Error> wrong_tls(const ServerUrl& url, const std::string& shown) {
  const auto error = [](const std::string& text, const std::string& hint) {
    return make_error(ErrorId::kNetworkConnect, text, hint);
  };
  if (url.unix_socket) return std::nullopt;
  const Handshake tls = shake_hands(url);
  if (!url.tls && tls.done) {
    return error("the server at " + shown + " speaks TLS", "use " + with_scheme(url, "wss://"));
  }
  if (url.tls && tls.done && tls.certificate != X509_V_OK) {
    return error("the certificate of " + shown +
                     " is not trusted here: " + X509_verify_cert_error_string(tls.certificate),
                 "--tls-ca FILE trusts the certificate in that file, or those that it has signed");
  }
  if (url.tls && tls.other_language) {
    return error("the server at " + shown + " speaks no TLS", "use " + with_scheme(url, "ws://"));
  }
  return std::nullopt;
}

Error no_answer(const ServerUrl& url, const std::string& shown, const std::string& problem) {
  if (std::optional<Error> wrong = wrong_tls(url, shown)) return *wrong;
  return make_error(ErrorId::kNetworkConnect,
                    "no server answers at " + shown + (problem.empty() ? "" : ": " + problem),
                    "start one with: mirage-server builtin:forest");
}

}  // namespace mirage
