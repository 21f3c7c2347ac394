/// @file host_copies.hpp
/// HostCopies: memory of the executor on host threads, and copies of it.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <new>
#include <vector>

#include "host/exec/host_buffer.hpp"
#include "host/exec/huge_pages.hpp"
#include "kernels/base/host_copy.hpp"
#include "kernels/base/slice_bytes.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

/// The copies of CpuExec, with the interface of DeviceCopies. They are left out where stages can
/// read and write the memory of the caller; all work has been done when a call returns.
class HostCopies {
 public:
  template <class T>
  using Vector = std::vector<T>;
  /// A vector that stages read from one end to the other many times.
  template <class T>
  using LargeVector = std::vector<T, HugePageAllocator<T>>;
  /// An array that the host renews in every step.
  template <class T>
  using Input = LargeVector<T>;
  template <class T>
  using Buffer = HostBuffer<T>;
  template <class T>
  using PinnedBuffer = HostBuffer<T>;
  template <class T>
  struct Staged {};  ///< empty: the argument of upload() is read in place

  void begin_compute(void*, bool) {}
  void end_compute(bool) {}
  void wait_computed() {}
  void end_download() {}
  void wait_delivered() {}
  void drain() noexcept {}
  void wait() const {}

  /// Host memory for a stage to read: no copy.
  template <class T>
  View<const T> resident(const char*, const T* host, std::int64_t size, Buffer<T>&) {
    return {host, size};
  }
  template <class T>
  View<const T> upload(const char*, const T* host, std::int64_t size, Staged<T>&) {
    return {host, size};
  }
  template <class T>
  View<const T> input(const T* host, std::int64_t size, Vector<T>&) const {
    return {host, size};
  }
  /// Values that stages read later: used in place, since the caller keeps them unchanged. Other
  /// executors copy them to `own`.
  template <class T>
  View<const T> keep(View<const T> values, Vector<T>&) const {
    return values;
  }
  /// What stages wrote, for the host to read: used in place. Other executors copy it.
  template <class T>
  View<const T> on_host(View<const T> values, std::vector<T>&) const {
    return values;
  }
  /// Host memory for a stage to write: no copy.
  template <class T>
  T* writable(T* host, std::int64_t, Buffer<T>&) {
    return host;
  }
  /// Copies writable() memory to the host: stages have written to it directly.
  void download(const char*, const std::byte*, std::byte*, const SliceBytes&) {}
  bool downloads_async(const void*) const { return true; }

  /// Sets the size; entries are undefined.
  template <class T, class Memory>
  void resize(std::vector<T, Memory>& values, std::int64_t size) const {
    values.resize(static_cast<std::size_t>(size));
  }
  /// Sets the size; all entries become zero.
  template <class T, class Memory>
  void make_zeros(std::vector<T, Memory>& values, std::int64_t size) const {
    values.assign(static_cast<std::size_t>(size), T{});
  }
  /// Copies from the host to memory of the executor.
  template <class T, class Memory>
  void put(const T* host, std::int64_t size, std::vector<T, Memory>& values) const {
    values.assign(host, host + size);
  }
  template <class T, class Memory>
  void put(const std::vector<T>& host, std::vector<T, Memory>& values) const {
    values.assign(host.begin(), host.end());
  }
  /// As put(); an executor may leave out what has not changed since the last call.
  template <class T>
  void renew(const T* host, std::int64_t size, Input<T>& values) const {
    put(host, size, values);
  }
  /// Copies entries to the host after all preceding stages.
  template <class T>
  void get(View<const T> from, T* to) const {
    std::copy_n(from.data, from.size, to);
  }
  /// Several arrays; a device waits once for all.
  void get_all(std::initializer_list<HostCopy> copies) const {
    for (const HostCopy& copy : copies) get(copy.from, copy.to);
  }
  /// As get(); on a device `to` is valid after wait_computed().
  template <class T>
  void fetch(View<const T> from, PinnedBuffer<T>& to) {
    get(from, to.view(from.size).data);
  }
  /// One value of executor memory; on a device this synchronizes.
  template <class T>
  T load(const T* value) const {
    return *value;
  }
  /// The value, or the second argument where reading it would synchronize.
  template <class T>
  T load_without_sync(const T* value, T) const {
    return *value;
  }
  /// Whether the host reads results after this step. A device returns true every few steps only.
  bool is_sync_point(std::int64_t) const { return true; }

  template <class T, class Memory>
  View<T> view(std::vector<T, Memory>& values) const {
    return {values.data(), static_cast<std::int64_t>(values.size())};
  }
  template <class T, class Memory>
  View<const T> view(const std::vector<T, Memory>& values) const {
    return {values.data(), static_cast<std::int64_t>(values.size())};
  }
  /// Default-constructs a State in memory of the executor; replaces that of the previous call.
  template <class State>
  State* state() {
    static_assert(sizeof(State) <= sizeof(state_) && alignof(State) <= 16);
    return new (state_) State{};
  }

 private:
  alignas(16) std::byte state_[1024] = {};
};

}  // namespace tetwarp
