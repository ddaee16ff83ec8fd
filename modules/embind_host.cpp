#include "modules/embind_host.h"

#include <algorithm>
#include <cstring>
#include <mutex>

#include "embind_names.h"

namespace mirage {
namespace {

constexpr std::uint32_t kMaxText = 1024;    // bytes of a name
constexpr std::uint32_t kMaxTypes = 32;     // arguments of a function
constexpr std::uint32_t kMaxCallers = 256;  // signatures that emval calls use
constexpr std::uint32_t kArgumentBytes = 8;

/// Number of the function type that takes `words` 32-bit numbers and returns one or none.
std::uint32_t function_type(std::size_t words, bool returns) {
  constexpr wasm_rt_type_t kWord = WASM_RT_I32;
  const auto count = static_cast<std::uint32_t>(words);
  const std::uint32_t results = returns ? 1 : 0;
  // The runtime reads as many of them as the two numbers say.
  return wasm_rt_register_func_type(count, results, kWord, kWord, kWord, kWord, kWord, kWord, kWord,
                                    kWord, kWord, kWord, kWord, kWord);
}
constexpr std::size_t kMaxWords = 11;

}  // namespace

EmbindHost::EmbindHost() : Z_a_instance_t{} {
  instantiate();
  try {
    MIRAGE_EXPORT_call_ctors(&instance_);
  } catch (...) {
    Z_basis_transcoder_free(&instance_);
    throw;
  }
}

EmbindHost::EmbindHost(const EmbindImage& image) : Z_a_instance_t{}, notes_(image.notes_) {
  instantiate();
  std::copy(image.memory_.begin(), image.memory_.end(), memory().data);
}

void EmbindHost::instantiate() {
  static std::once_flag once;
  std::call_once(once, Z_basis_transcoder_init_module);
  try {
    Z_basis_transcoder_instantiate(&instance_, this);
  } catch (...) {
    Z_basis_transcoder_free(&instance_);
    throw;
  }
}

EmbindHost::~EmbindHost() { Z_basis_transcoder_free(&instance_); }

EmbindImage EmbindHost::image() {
  EmbindImage image;
  image.notes_ = notes_;
  std::uint32_t used = memory().size;
  while (used > 0 && memory().data[used - 1] == 0) --used;
  image.memory_.assign(memory().data, memory().data + used);
  return image;
}

wasm_rt_memory_t& EmbindHost::memory() { return *MIRAGE_EXPORT_memory(&instance_); }

std::string EmbindHost::text_at(std::uint32_t address) {
  const std::uint32_t size = memory().size;
  const std::uint32_t rest = address < size ? size - address : 0;
  const std::span<const std::uint8_t> text =
      wasm_bytes(memory(), address, std::min(rest, kMaxText));
  const auto end = std::find(text.begin(), text.end(), 0);
  if (end == text.end()) throw WasmTrap{"it hands over a name without an end"};
  return {text.begin(), end};
}

std::uint32_t EmbindHost::word_at(std::uint32_t address) {
  std::uint32_t word = 0;
  std::memcpy(&word, wasm_bytes(memory(), address, sizeof word).data(), sizeof word);
  return word;
}

bool EmbindHost::grow(std::uint32_t bytes) {
  constexpr std::uint64_t kLimit = std::uint64_t{kMaxWasmPages} * kWasmPageBytes;
  if (bytes > kLimit) {
    reached_limit_ = true;
    return false;
  }
  // Takes a fifth more than is asked, as emscripten does, so that small steps stay few.
  const std::uint64_t ample = std::uint64_t{memory().size} * 6 / 5;
  return grow_wasm_memory(memory(), std::min(std::max<std::uint64_t>(bytes, ample), kLimit)) ||
         grow_wasm_memory(memory(), bytes);
}

WireType EmbindHost::wire_type(std::uint32_t type) const {
  const auto found = notes_.types.find(type);
  return found == notes_.types.end() ? WireType::kOther : found->second;
}

std::vector<std::uint32_t> EmbindHost::types_at(std::uint32_t count, std::uint32_t address) {
  if (count < 1 || count > kMaxTypes) throw WasmTrap{"it announces too many arguments"};
  std::vector<std::uint32_t> types;
  for (std::uint32_t i = 0; i < count; ++i) types.push_back(word_at(address + 4 * i));
  return types;
}

void EmbindHost::add_function(const std::string& name, std::uint32_t count, std::uint32_t types,
                              std::uint32_t invoker, std::uint32_t context) {
  notes_.functions.insert_or_assign(name, Announced{types_at(count, types), invoker, context});
}

EmbindHost::Callee EmbindHost::callee_of(const std::string& name, std::size_t arguments) {
  const auto found = notes_.functions.find(name);
  if (found == notes_.functions.end() || found->second.types.size() != arguments + 1 ||
      arguments + 1 > kMaxWords) {
    throw WasmTrap{"it lacks a function"};
  }
  const Announced& function = found->second;
  const wasm_rt_funcref_table_t& table = *MIRAGE_EXPORT_table(&instance_);
  const bool returns = wire_type(function.types[0]) != WireType::kVoid;
  if (function.invoker >= table.size || !table.data[function.invoker].func ||
      table.data[function.invoker].func_type != function_type(arguments + 1, returns)) {
    throw WasmTrap{"it has a function of another type"};
  }
  return {table.data[function.invoker], function.context, returns};
}

std::uint32_t EmbindHost::add_caller(std::uint32_t count, std::uint32_t types, std::uint32_t kind) {
  if (notes_.callers.size() >= kMaxCallers) throw WasmTrap{"it announces too many calls"};
  notes_.callers.push_back({types_at(count, types), kind == 1});
  return static_cast<std::uint32_t>(notes_.callers.size() - 1);
}

double EmbindHost::call_value(std::uint32_t caller, std::uint32_t object, const std::string* method,
                              std::uint32_t arguments) {
  if (caller >= notes_.callers.size()) throw WasmTrap{"it makes a call that it never announced"};
  const Caller& call = notes_.callers[caller];
  std::vector<JsValue> values;
  for (std::size_t i = 1; i < call.types.size(); ++i, arguments += kArgumentBytes) {
    const std::uint32_t word = word_at(arguments);
    const WireType type = wire_type(call.types[i]);
    if (type == WireType::kEmval) {
      values.push_back(values_.at(word));
      values_.drop_reference(word);
    } else if (type == WireType::kUnsigned32) {
      values.emplace_back(static_cast<double>(word));
    } else {
      throw WasmTrap{"it hands over a value of an unknown type"};
    }
  }
  const WireType result = wire_type(call.types[0]);
  if (method && !call.constructs && result == WireType::kVoid) {
    js_call(values_.at(object), *method, values, memory());
    return 0;
  }
  if (!method && call.constructs && result == WireType::kEmval) {
    return values_.add(js_new(values_.at(object), values));
  }
  throw WasmTrap{"it makes an unknown kind of call"};
}

}  // namespace mirage
