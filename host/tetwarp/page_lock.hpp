/// @file page_lock.hpp
/// Page-locked host memory: a CUDA device copies to and from it directly.
#pragma once
#include <cstddef>

#include <tetwarp/export.hpp>

namespace tetwarp {

/// Locks the pages of host memory during its lifetime. Copies between them and a CUDA device run at
/// the full speed of the bus, concurrently with kernels and with work of the host. Locking takes
/// time: use it for memory that many steps use, for example the arrays of WarpTarget.
class TETWARP_EXPORT PageLock {
 public:
  PageLock() = default;
  /// Does not throw when locking fails; see is_locked().
  /// @param data   must outlive the lock; steps in flight that use it must be finished before the
  ///               lock is destroyed
  /// @param bytes  size of `data`
  PageLock(void* data, std::size_t bytes);
  PageLock(PageLock&& other) noexcept;
  PageLock& operator=(PageLock&& other) noexcept;
  ~PageLock();

  /// False without a usable CUDA device or if the system refuses. Only the speed of copies differs.
  bool is_locked() const { return data_ != nullptr; }

 private:
  void* data_ = nullptr;
};

}  // namespace tetwarp
