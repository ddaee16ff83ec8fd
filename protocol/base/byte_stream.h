#pragma once
// Writes and reads plain little-endian values.

#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

namespace mirage {

// Values are written as the memory of trivially copyable types; all supported targets are
// little-endian (checked here), so the bytes are too.
#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "the geometry codec needs a little-endian target"
#endif

class ByteWriter {
 public:
  template <typename T>
  void put(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    put_bytes(&v, sizeof(T));
  }
  void put_bytes(const void* from, std::size_t n) {
    const auto* p = static_cast<const std::uint8_t*>(from);
    bytes.insert(bytes.end(), p, p + n);
  }
  std::vector<std::uint8_t> bytes;
};

/// Reads values in order. A read past the end gives zeros and marks the reader as failed.
class ByteReader {
 public:
  ByteReader(const std::uint8_t* bytes, std::size_t size) : at_(bytes), left_(size) {}

  template <typename T>
  T get() {
    static_assert(std::is_trivially_copyable_v<T>);
    T v{};
    if (const std::uint8_t* p = take(sizeof(T))) std::memcpy(&v, p, sizeof(T));
    return v;
  }
  /// Returns the next `n` bytes in place; nullptr if fewer are left.
  const std::uint8_t* take(std::size_t n) {
    if (failed_ || n > left_) {
      failed_ = true;
      return nullptr;
    }
    const std::uint8_t* p = at_;
    at_ += n;
    left_ -= n;
    return p;
  }
  /// True if `n` items of `each` bytes are left. Counts have 64 bits, because sums that a peer
  /// declares may overflow the size type of a 32-bit machine.
  bool has(std::uint64_t n, std::size_t each) const { return !failed_ && n <= left_ / each; }
  bool failed() const { return failed_; }
  /// The bytes that have not been read yet.
  const std::uint8_t* at() const { return at_; }
  std::size_t left() const { return left_; }
  bool at_end() const { return !failed_ && left_ == 0; }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
  bool failed_ = false;
};

}  // namespace mirage
