#include "modules/wasm_runtime.h"

#include <sys/mman.h>

#include <cstdarg>
#include <mutex>
#include <new>
#include <string>
#include <vector>

namespace mirage {

bool grow_wasm_memory(wasm_rt_memory_t& memory, uint64_t bytes) {
  const uint64_t pages = (bytes + kWasmPageBytes - 1) / kWasmPageBytes;
  if (pages <= memory.pages) return true;
  if (pages > kMaxWasmPages || pages > memory.max_pages) return false;
  void* const moved =
      mremap(memory.data, memory.size, pages * kWasmPageBytes, MREMAP_MAYMOVE);  // zeros the rest
  if (moved == MAP_FAILED) return false;
  memory.data = static_cast<uint8_t*>(moved);
  memory.pages = static_cast<uint32_t>(pages);
  memory.size = memory.pages * kWasmPageBytes;
  return true;
}

namespace {

const char* trap_reason(wasm_rt_trap_t trap) {
  switch (trap) {
    case WASM_RT_TRAP_OOB:
      return "it reads or writes outside of its memory";
    case WASM_RT_TRAP_EXHAUSTION:
      return "its calls nest too deeply";
    case WASM_RT_TRAP_CALL_INDIRECT:
      return "it calls a function that does not exist";
    case WASM_RT_TRAP_UNREACHABLE:
      return "it gives up";
    default:
      return "it computes a number that does not exist";
  }
}

}  // namespace
}  // namespace mirage

// The functions below are named and described in wasm-rt.h; the generated code calls them.
extern "C" {

void wasm_rt_trap(wasm_rt_trap_t trap) { throw mirage::WasmTrap{mirage::trap_reason(trap)}; }

bool wasm_rt_is_initialized() { return true; }

uint32_t wasm_rt_register_func_type(uint32_t params, uint32_t results, ...) {
  std::string type = std::to_string(params) + ":";
  va_list list;
  va_start(list, results);
  for (uint32_t i = 0; i < params + results; ++i) {
    type += std::to_string(va_arg(list, unsigned)) + " ";
  }
  va_end(list);
  static std::mutex mutex;
  static std::vector<std::string> types;
  const std::lock_guard lock(mutex);
  for (uint32_t i = 0; i < types.size(); ++i) {
    if (types[i] == type) return i + 1;
  }
  types.push_back(type);
  return static_cast<uint32_t>(types.size());
}

void wasm_rt_allocate_memory(wasm_rt_memory_t* memory, uint32_t initial_pages, uint32_t max_pages) {
  // Pages come from the system one by one at their first use, because most stay untouched.
  const uint32_t bytes = initial_pages * mirage::kWasmPageBytes;
  void* const data =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (data == MAP_FAILED) throw std::bad_alloc();
  *memory = {static_cast<uint8_t*>(data), initial_pages, max_pages, bytes};
}

void wasm_rt_free_memory(wasm_rt_memory_t* memory) {
  if (memory->data) munmap(memory->data, memory->size);
  *memory = {};
}

void wasm_rt_allocate_funcref_table(wasm_rt_funcref_table_t* table, uint32_t elements,
                                    uint32_t max_elements) {
  *table = {new wasm_rt_funcref_t[elements](), max_elements, elements};
}

void wasm_rt_free_funcref_table(wasm_rt_funcref_table_t* table) {
  delete[] table->data;
  *table = {};
}

}  // extern "C"
