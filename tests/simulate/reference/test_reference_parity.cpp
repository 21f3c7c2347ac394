/// The Simulator on the back ends cpu and reference against the reference.
#include <gtest/gtest.h>

#include "tests/support/parity_run.hpp"

namespace tetwarp::test {
namespace {

class ReferenceParity : public testing::TestWithParam<NamedScene> {};

TEST_P(ReferenceParity, StepsAsTheReferenceDoes) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    run_both(GetParam().make(seed), Backend::cpu, 10, [](int, auto&) {});
  }
}

INSTANTIATE_TEST_SUITE_P(cpu,
                         ReferenceParity,
                         testing::ValuesIn(parity_scenes()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(ReferenceBackend, StepsAsTheReferenceDoes) {
  for (const NamedScene& named : parity_scenes()) {
    SCOPED_TRACE(named.name);
    run_both(named.make(6), Backend::reference, 5, [](int, auto&) {});
  }
}

TEST(ReferenceOverrides, OfHandlesActAsInTheReference) {
  for (const NamedScene& named : parity_scenes()) {
    if (std::string(named.name) != "handled") continue;
    run_both(named.make(9), Backend::cpu, 10, [](int step, auto& bodies) {
      if (step == 2) bodies.move_handle("pull", {0.02, -0.01, 0.03});
      if (step == 4) bodies.release_handle("pull");
      if (step == 5) bodies.release_handle("brick");
      if (step == 7) bodies.move_handle("pull", {0, 0.05, 0});
    });
  }
}

TEST(ReferenceOverrides, OfScriptsActAsInTheReference) {
  for (const NamedScene& named : parity_scenes()) {
    if (std::string(named.name) != "scripted") continue;
    run_both(named.make(9), Backend::cpu, 10, [](int step, auto& bodies) {
      if (step == 3) bodies.move_script("wall", {0.02, -0.01, 0.03}, {0.1, 0.2, 0});
      if (step == 6) bodies.move_script("jaw", {0, 0, 0.05}, {0, 0.2, -0.1});
    });
  }
}

}  // namespace
}  // namespace tetwarp::test
