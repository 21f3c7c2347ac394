/// @file buffer.hpp
/// Memory of the measured volumes: aligned to huge pages, no page touched before its first use.
#pragma once
#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

namespace tetwarp::bench {

/// Owns bytes whose content is undefined. Sources and outputs of the library and of the floors all
/// lie in such buffers, so that page size and alignment are the same for both.
class Buffer {
 public:
  Buffer() = default;
  explicit Buffer(std::size_t size) {
    // Spare bytes: a vector load may start at the last sample.
    const std::size_t pages = (size + spare + page - 1) / page;
    data_.reset(static_cast<std::byte*>(std::aligned_alloc(page, pages * page)));
    if (!data_) throw std::bad_alloc();
    ::madvise(data_.get(), pages * page, MADV_HUGEPAGE);  // may fail: small pages work, too
  }

  std::byte* data() const { return data_.get(); }

 private:
  struct Free {
    void operator()(std::byte* bytes) const { std::free(bytes); }
  };
  static constexpr std::size_t page = std::size_t{2} << 20;
  static constexpr std::size_t spare = 64;

  std::unique_ptr<std::byte, Free> data_;
};

}  // namespace tetwarp::bench
