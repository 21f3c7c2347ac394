/// The Simulator on the emulated device against the reference.
#include <gtest/gtest.h>

#include "tests/scenes/parity_run.hpp"

namespace tetwarp::test {
namespace {

TEST(EmulatedParity, StepsAsTheReferenceDoes) {
  for (const NamedScene& named : parity_scenes()) {
    SCOPED_TRACE(named.name);
    run_both(named.make(5), Backend::cuda, 5, [](int, auto&) {});
  }
}

}  // namespace
}  // namespace tetwarp::test
