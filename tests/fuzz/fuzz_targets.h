#pragma once
// Fuzz targets as functions. libFuzzer calls one through LLVMFuzzerTestOneInput (compiled with
// MIRAGE_FUZZ_ENTRY); the replay program calls all of them by name.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace mirage::fuzz {

void run_message(const std::uint8_t* data, std::size_t size);
void run_tile(const std::uint8_t* data, std::size_t size);
void run_model(const std::uint8_t* data, std::size_t size);
void run_image(const std::uint8_t* data, std::size_t size);
void run_draco(const std::uint8_t* data, std::size_t size);
void run_session(const std::uint8_t* data, std::size_t size);
void run_meshopt(const std::uint8_t* data, std::size_t size);

/// Ends the program, as a crash would, because a property that every input must have does not hold.
[[noreturn]] inline void fail(const char* what) {
  std::fprintf(stderr, "fuzz target: %s\n", what);
  std::abort();
}

}  // namespace mirage::fuzz
