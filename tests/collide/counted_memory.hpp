/// @file counted_memory.hpp
/// Counts allocations of the test program.
#pragma once
#include <cstdint>

namespace tetwarp::test {

/// Allocations of memory by all threads since the program began.
std::int64_t allocation_count();

}  // namespace tetwarp::test
