/// @file fuzz_memory.cpp
/// Replaces the allocation functions: ends the program on requests far larger than its files.
#include "tests/io/fuzz_memory.hpp"

#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <new>

namespace {
constexpr std::size_t largest_allocation = std::size_t{64} << 20;  // the files hold a few KiB
}  // namespace

void* operator new(std::size_t bytes) {
  if (bytes > largest_allocation) _exit(tetwarp::test::large_allocation_exit_code);
  if (void* memory = std::malloc(bytes == 0 ? 1 : bytes)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return std::malloc(bytes);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
