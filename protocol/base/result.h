#pragma once
// Result<T>: a value or an Error. Misuse (reading the wrong side) is a bug and terminates.

#include <cstdlib>
#include <optional>
#include <utility>
#include <variant>

#include "protocol/base/error.h"

namespace mirage {

template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}      // NOLINT: implicit by design
  Result(Error error) : state_(std::move(error)) {}  // NOLINT: implicit by design

  bool ok() const { return std::holds_alternative<T>(state_); }
  explicit operator bool() const { return ok(); }

  T& value() {
    if (!ok()) std::abort();
    return *std::get_if<T>(&state_);
  }
  const T& value() const {
    if (!ok()) std::abort();
    return *std::get_if<T>(&state_);
  }
  T take() { return std::move(value()); }
  const Error& error() const {
    if (ok()) std::abort();
    return *std::get_if<Error>(&state_);
  }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  T& operator*() { return value(); }
  const T& operator*() const { return value(); }

 private:
  std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT: implicit by design

  bool ok() const { return !error_.has_value(); }
  explicit operator bool() const { return ok(); }
  const Error& error() const {
    if (ok()) std::abort();
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

}  // namespace mirage
