/// @file fuzz_memory.hpp
#pragma once

namespace tetwarp::test {

/// Exit code of a program linked with fuzz_memory.cpp that requests far more memory than its files
/// hold.
constexpr int large_allocation_exit_code = 43;

}  // namespace tetwarp::test
