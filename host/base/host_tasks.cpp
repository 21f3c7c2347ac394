/// @file host_tasks.cpp
/// Tasks on the threads of the process, and copies past the caches.
#include "kernels/base/host_tasks.hpp"

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstring>

#include "host/base/parallel.hpp"

namespace tetwarp {

void run_host_tasks(int threads,
                    std::int64_t count,
                    const std::function<void(std::int64_t i)>& task) {
  parallel_tasks(threads, count, task);
}

void stream_copy(const std::byte* from, std::byte* to, std::size_t size) {
  namespace hn = hwy::HWY_NAMESPACE;
  constexpr std::size_t line = 64;  ///< size of a cache line
  const hn::CappedTag<std::uint8_t, line> d;
  const std::size_t lanes = hn::Lanes(d);
  const std::size_t in_line = reinterpret_cast<std::uintptr_t>(to) % line;
  const std::size_t head = std::min(size, (line - in_line) % line);
  std::memcpy(to, from, head);
  std::size_t done = head;
  for (; done + line <= size; done += line) {
    for (std::size_t at = done; at < done + line; at += lanes) {
      hn::Stream(hn::LoadU(d, reinterpret_cast<const std::uint8_t*>(from) + at), d,
                 reinterpret_cast<std::uint8_t*>(to) + at);
    }
  }
  std::memcpy(to + done, from + done, size - done);
  hwy::FlushStream();
}

}  // namespace tetwarp
