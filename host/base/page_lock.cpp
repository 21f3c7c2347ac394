/// @file page_lock.cpp
/// Locks memory in place for copies to a device, where CUDA is built in.
#include <tetwarp/page_lock.hpp>
#include <utility>

#include "host/base/warp_backend.hpp"

namespace tetwarp {

PageLock::PageLock(void* data, std::size_t bytes)
    : data_(cuda_lock_pages(data, bytes) ? data : nullptr) {}

PageLock::PageLock(PageLock&& other) noexcept : data_(std::exchange(other.data_, nullptr)) {}

PageLock& PageLock::operator=(PageLock&& other) noexcept {
  std::swap(data_, other.data_);
  return *this;
}

PageLock::~PageLock() {
  if (data_ != nullptr) cuda_unlock_pages(data_);
}

}  // namespace tetwarp
