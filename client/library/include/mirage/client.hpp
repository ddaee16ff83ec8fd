// C++17 on top of libmirage-client: an owner of a client, and its last failure as text. Header only;
// the interface in C is all that the library promises.
#ifndef MIRAGE_CLIENT_HPP
#define MIRAGE_CLIENT_HPP

#include <mirage/client.h>
#include <mirage/frame.h>
#include <mirage/stats.h>

#include <memory>
#include <string>

namespace mirage_client_cpp {

/// Returns a struct of the interface with its size set and everything else zero.
template <typename T>
T sized() {
  T out{};
  out.size = sizeof(T);
  return out;
}

/// Owns a client. Movable; false if it could not be made. Call detach() while its context is current.
class Client {
 public:
  Client() = default;
  /// Sets the version of `desc`.
  explicit Client(mirage_client_desc desc) {
    desc.version = MIRAGE_CLIENT_VERSION;
    mirage_client* made = nullptr;
    result_ = mirage_client_create(&desc, &made);
    client_.reset(made);
  }

  explicit operator bool() const { return client_ != nullptr; }
  mirage_client* get() const { return client_.get(); }
  /// Returns the result of making it.
  mirage_result made() const { return result_; }
  void detach(bool context_lost = false) { mirage_gl_detach(get(), context_lost ? 1 : 0); }

  /// Returns the last failure as one line; empty: there was none.
  std::string failure() const {
    mirage_error error = sized<mirage_error>();
    if (mirage_client_error(get(), &error) != MIRAGE_OK || error.result == MIRAGE_OK) return {};
    std::string line = std::string(mirage_result_name(error.result)) + ": " + error.text;
    return *error.hint ? line + " (hint: " + error.hint + ")" : line;
  }

 private:
  struct End {
    void operator()(mirage_client* client) const { mirage_client_destroy(client); }
  };
  std::unique_ptr<mirage_client, End> client_;
  mirage_result result_ = MIRAGE_WRONG_STATE;
};

}  // namespace mirage_client_cpp

#endif
