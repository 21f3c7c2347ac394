/// @file host_tasks.hpp
/// What executors of a device leave to threads of the host. Defined in host/base/host_tasks.cpp.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>

namespace tetwarp {

/// task(i) once for every i in [0, count) on at most `threads` threads of the host, the calling one
/// included; they begin in the order of i. @throws as parallel_tasks()
void run_host_tasks(int threads,
                    std::int64_t count,
                    const std::function<void(std::int64_t i)>& task);

/// Copies `size` bytes by stores that bypass the caches where the processor has them: lines are
/// written without being loaded first, and are not there to be read soon.
void stream_copy(const std::byte* from, std::byte* to, std::size_t size);

}  // namespace tetwarp
