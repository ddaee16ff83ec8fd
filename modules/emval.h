#pragma once
// The few JavaScript values that the transcoder handles through emscripten's `val`: it takes a
// Uint8Array of ours, asks for its length, makes a Uint8Array over its own memory, and copies with
// `set`. Everything else traps.

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "modules/wasm_runtime.h"

namespace mirage {

struct JsUndefined {};
struct JsHeap {};        ///< Module.HEAP8
struct JsHeapBuffer {};  ///< Module.HEAP8.buffer
struct JsUint8Array {};  ///< the class
/// A Uint8Array over bytes of ours, to be read or to be written. They outlive the value.
struct JsSource {
  std::span<const std::uint8_t> bytes;
};
struct JsTarget {
  std::span<std::uint8_t> bytes;
};
/// A Uint8Array over memory of the transcoder.
struct JsView {
  std::uint32_t begin = 0, length = 0;
};
using JsValue = std::variant<JsUndefined, double, std::string, JsHeap, JsHeapBuffer, JsUint8Array,
                             JsSource, JsTarget, JsView>;

/// `object.key`, as far as the transcoder asks.
JsValue js_property(const JsValue& object, const JsValue& key);

/// `new constructor(arguments…)`, as far as the transcoder makes objects.
JsValue js_new(const JsValue& constructor, std::span<const JsValue> arguments);

/// `object.name(arguments…)`. Only `set` is known, which copies into an array of the same length.
void js_call(const JsValue& object, const std::string& name, std::span<const JsValue> arguments,
             const wasm_rt_memory_t& memory);

/// Returns the bytes of the transcoder's memory from `begin` on. Traps outside of it.
std::span<std::uint8_t> wasm_bytes(const wasm_rt_memory_t& memory, std::uint32_t begin,
                                   std::uint32_t length);

/// Values that the transcoder holds, by handle, with a count of its references.
class EmvalTable {
 public:
  std::uint32_t add(JsValue value);
  const JsValue& at(std::uint32_t handle) const;
  void add_reference(std::uint32_t handle);
  void drop_reference(std::uint32_t handle);

 private:
  struct Slot {
    JsValue value;
    std::uint32_t references = 0;  // 0: free
  };
  std::uint32_t index_of(std::uint32_t handle) const;

  std::vector<Slot> slots_;
  std::vector<std::uint32_t> free_;
};

}  // namespace mirage
