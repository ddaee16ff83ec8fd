#pragma once
/* Runtime of the C code that wasm2c makes of the transcoder. That code is compiled with this header
   in front. It replaces the runtime of wabt, whose call depth and jump buffer are global: here both
   belong to an instance, so that threads share nothing, and a trap is a C++ exception. */

#include <stdint.h>
#include <wasm-rt.h>

/* The host of one instance, as the generated code knows it; wasm2c gives the name. */
struct Z_a_instance_t {
  uint32_t call_depth;
};

#ifndef __cplusplus
#define wasm_rt_call_stack_depth (instance->Z_a_instance->call_depth)
#else

namespace mirage {

inline constexpr uint32_t kWasmPageBytes = 65536;
inline constexpr uint32_t kMaxWasmPages = 16384;  ///< 1 GiB

/// Thrown when the transcoder cannot go on. Its instance is then of no further use.
struct WasmTrap {
  const char* reason;  ///< has static storage
};

/// Grows the memory of an instance to at least `bytes`. False: above 1 GiB, or no memory is left.
bool grow_wasm_memory(wasm_rt_memory_t& memory, uint64_t bytes);

}  // namespace mirage
#endif
