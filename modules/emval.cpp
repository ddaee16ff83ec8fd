#include "modules/emval.h"

#include <algorithm>

namespace mirage {
namespace {

constexpr std::uint32_t kUndefined = 2;     // handles below kFirstHandle are constants
constexpr std::uint32_t kFirstHandle = 10;  // handles are even
[[noreturn]] void unknown() { throw WasmTrap{"it asks its host for something unknown"}; }

template <typename T>
bool is(const JsValue& value) {
  return std::holds_alternative<T>(value);
}

}  // namespace

std::span<std::uint8_t> wasm_bytes(const wasm_rt_memory_t& memory, std::uint32_t begin,
                                   std::uint32_t length) {
  if (begin > memory.size || length > memory.size - begin) {
    throw WasmTrap{"it hands over bytes outside of its memory"};
  }
  return {memory.data + begin, length};
}

JsValue js_property(const JsValue& object, const JsValue& key) {
  const std::string* const name = std::get_if<std::string>(&key);
  if (!name) unknown();
  if (is<JsHeap>(object) && *name == "buffer") return JsHeapBuffer{};
  if (const JsSource* const source = std::get_if<JsSource>(&object)) {
    if (*name == "length" || *name == "byteLength") {
      return static_cast<double>(source->bytes.size());
    }
    if (*name == "constructor") return JsUint8Array{};
  }
  unknown();
}

JsValue js_new(const JsValue& constructor, std::span<const JsValue> arguments) {
  if (!is<JsUint8Array>(constructor) || arguments.size() != 3 || !is<JsHeapBuffer>(arguments[0])) {
    unknown();
  }
  const double* const begin = std::get_if<double>(&arguments[1]);
  const double* const length = std::get_if<double>(&arguments[2]);
  if (!begin || !length) unknown();
  return JsView{static_cast<std::uint32_t>(*begin), static_cast<std::uint32_t>(*length)};
}

void js_call(const JsValue& object, const std::string& name, std::span<const JsValue> arguments,
             const wasm_rt_memory_t& memory) {
  if (name != "set" || arguments.size() != 1) unknown();
  const auto view = [&](const JsValue& value) {
    const JsView* const found = std::get_if<JsView>(&value);
    if (!found) unknown();
    return wasm_bytes(memory, found->begin, found->length);
  };
  const auto copy = [](std::span<const std::uint8_t> from, std::span<std::uint8_t> to) {
    if (from.size() != to.size()) throw WasmTrap{"it hands over another number of bytes"};
    std::copy(from.begin(), from.end(), to.begin());
  };
  if (const JsSource* const source = std::get_if<JsSource>(arguments.data())) {
    copy(source->bytes, view(object));
  } else if (const JsTarget* const target = std::get_if<JsTarget>(&object)) {
    copy(view(arguments[0]), target->bytes);
  } else {
    unknown();
  }
}

std::uint32_t EmvalTable::add(JsValue value) {
  if (is<JsUndefined>(value)) return kUndefined;
  if (free_.empty()) {
    free_.push_back(static_cast<std::uint32_t>(slots_.size()));
    slots_.emplace_back();
  }
  const std::uint32_t index = free_.back();
  free_.pop_back();
  slots_[index] = {std::move(value), 1};
  return kFirstHandle + 2 * index;
}

std::uint32_t EmvalTable::index_of(std::uint32_t handle) const {
  const std::uint32_t index = (handle - kFirstHandle) / 2;
  if (handle < kFirstHandle || handle % 2 != 0 || index >= slots_.size() ||
      slots_[index].references == 0) {
    unknown();
  }
  return index;
}

const JsValue& EmvalTable::at(std::uint32_t handle) const { return slots_[index_of(handle)].value; }

void EmvalTable::add_reference(std::uint32_t handle) {
  if (handle >= kFirstHandle) ++slots_[index_of(handle)].references;
}

void EmvalTable::drop_reference(std::uint32_t handle) {
  if (handle < kFirstHandle) return;
  const std::uint32_t index = index_of(handle);
  if (--slots_[index].references > 0) return;
  slots_[index].value = JsUndefined{};
  free_.push_back(index);
}

}  // namespace mirage
