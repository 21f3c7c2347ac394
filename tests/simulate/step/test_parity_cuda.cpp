/// @file test_parity_cuda.cpp
/// The Simulator on back end cuda against the reference, on a device where there is one, and on the
/// emulated one.
#include <gtest/gtest.h>

#include <tetwarp/error.hpp>

#include "tests/support/parity_run.hpp"

namespace tetwarp::test {
namespace {

TEST(CudaParity, StepsAsTheReferenceDoes) {
  for (const NamedScene& named : parity_scenes()) {
    SCOPED_TRACE(named.name);
    try {
      run_both(named.make(5), Backend::cuda, 5, [](int, auto&) {});
    } catch (const CudaError& error) {
      GTEST_SKIP() << error.what();
    }
  }
}

}  // namespace
}  // namespace tetwarp::test
