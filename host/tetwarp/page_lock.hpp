/// @file page_lock.hpp
/// Host memory that a device copies to and from directly.
#pragma once
#include <cstddef>

#include <tetwarp/export.hpp>

namespace tetwarp {

/// Locks host memory in place for as long as it lives: a CUDA device then copies to and from it at
/// the speed of the bus, and beside kernels and other work of the host. Locking itself takes time:
/// lock what many steps use, e.g. the buffers of WarpTarget.
class TETWARP_EXPORT PageLock {
 public:
  PageLock() = default;
  /// @param data   outlives the lock; steps in flight that use it must be finished before its end
  /// @param bytes  its size
  PageLock(void* data, std::size_t bytes);
  PageLock(PageLock&& other) noexcept;
  PageLock& operator=(PageLock&& other) noexcept;
  ~PageLock();

  /// False where no CUDA device answers or the system refuses: all works as well, but slower.
  bool is_locked() const { return data_ != nullptr; }

 private:
  void* data_ = nullptr;
};

}  // namespace tetwarp
