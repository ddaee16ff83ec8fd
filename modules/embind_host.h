#pragma once
// One instance of the transcoder with its host, in the place of a JavaScript engine. While the
// instance starts, emscripten's embind announces types, classes and functions; the host notes them
// by name, so that C++ calls "KTX2File.transcodeImage" and the like. One thread at a time.

#include <basis_transcoder.h>

#include <concepts>
#include <string>
#include <unordered_map>
#include <vector>

#include "modules/emval.h"

namespace mirage {

/// Type of an argument or a result, as embind announces it.
enum class WireType : std::uint8_t { kOther, kVoid, kUnsigned32, kEmval };

class EmbindImage;

class EmbindHost : public Z_a_instance_t {
 public:
  /// Starts an instance. Throws WasmTrap, std::bad_alloc.
  EmbindHost();
  /// Makes an instance in the state that `image` keeps, which is much faster. Throws as above.
  explicit EmbindHost(const EmbindImage& image);
  ~EmbindHost();
  EmbindHost(const EmbindHost&) = delete;
  EmbindHost& operator=(const EmbindHost&) = delete;

  /// Calls a function by its name: "initializeBasis", "KTX2File" (makes an object), or
  /// "KTX2File.isValid" (the object comes first). Throws WasmTrap.
  template <std::same_as<std::uint32_t>... Arguments>
  std::uint32_t call(const std::string& name, Arguments... arguments) {
    const Callee callee = callee_of(name, sizeof...(arguments));
    void* const instance = callee.target.module_instance;
    if (!callee.returns) {
      using Function = void (*)(void*, std::uint32_t, Arguments...);
      reinterpret_cast<Function>(callee.target.func)(instance, callee.context, arguments...);
      return 0;
    }
    using Function = std::uint32_t (*)(void*, std::uint32_t, Arguments...);
    return reinterpret_cast<Function>(callee.target.func)(instance, callee.context, arguments...);
  }

  /// Keeps the state between two calls. There are no values then.
  EmbindImage image();
  EmvalTable& values() { return values_; }
  wasm_rt_memory_t& memory();
  /// True once the transcoder has asked for more than 1 GiB.
  bool reached_limit() const { return reached_limit_; }

  // Called by embind_imports.cpp. Addresses and types are the transcoder's.
  std::string text_at(std::uint32_t address);
  std::uint32_t word_at(std::uint32_t address);
  bool grow(std::uint32_t bytes);
  void add_type(std::uint32_t type, WireType wire) { notes_.types[type] = wire; }
  void add_class(std::uint32_t type, std::uint32_t name) { notes_.classes[type] = text_at(name); }
  /// `types` is an address of `count` types: the result first. `context` goes to the invoker.
  void add_function(const std::string& name, std::uint32_t count, std::uint32_t types,
                    std::uint32_t invoker, std::uint32_t context);
  const std::string& class_name(std::uint32_t type) { return notes_.classes[type]; }
  WireType wire_type(std::uint32_t type) const;
  /// Notes a signature that emval calls use, and returns its number. `kind` 1 is a constructor.
  std::uint32_t add_caller(std::uint32_t count, std::uint32_t types, std::uint32_t kind);
  /// Calls `object.method(…)`, or `new object(…)` if `method` is null; `arguments` is an address.
  double call_value(std::uint32_t caller, std::uint32_t object, const std::string* method,
                    std::uint32_t arguments);

 private:
  friend class EmbindImage;
  struct Announced {
    std::vector<std::uint32_t> types;  // the result first; they may be announced later
    std::uint32_t invoker = 0, context = 0;
  };
  struct Caller {
    std::vector<std::uint32_t> types;  // the result first
    bool constructs = false;
  };
  /// Everything that the transcoder has announced.
  struct Notes {
    std::unordered_map<std::uint32_t, WireType> types;
    std::unordered_map<std::uint32_t, std::string> classes;
    std::unordered_map<std::string, Announced> functions;
    std::vector<Caller> callers;
  };
  struct Callee {
    wasm_rt_funcref_t target;
    std::uint32_t context;
    bool returns;
  };
  void instantiate();
  Callee callee_of(const std::string& name, std::size_t arguments);
  std::vector<std::uint32_t> types_at(std::uint32_t count, std::uint32_t address);

  Z_basis_transcoder_instance_t instance_ = {};
  EmvalTable values_;
  Notes notes_;
  bool reached_limit_ = false;
};

/// State of an instance: its notes, and its memory up to the last byte that is not zero.
class EmbindImage {
  friend class EmbindHost;
  EmbindHost::Notes notes_;
  std::vector<std::uint8_t> memory_;
};

}  // namespace mirage
