/// @file each_backend.hpp
/// Suites over the back ends of the public calls: they run as Backends/X.Y/cpu, /cuda and
/// /reference.
#pragma once
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include <tetwarp/backend.hpp>

namespace tetwarp::test {

inline const auto each_backend = ::testing::Values(Backend::cpu, Backend::cuda, Backend::reference);

inline std::string name_of_backend(const ::testing::TestParamInfo<Backend>& info) {
  return name_of(info.param);
}

/// Skips, with the runtime's reason, if the back end is not usable.
class EachBackend : public ::testing::TestWithParam<Backend> {
 protected:
  void SetUp() override {
    for (const BackendStatus& status : available_backends()) {
      if (status.backend == GetParam() && !status.usable) GTEST_SKIP() << status.reason;
    }
  }

  /// Keeps a measured number in the test's record (--gtest_output).
  static void found(const std::string& name, double value) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.3g", value);
    RecordProperty(name, digits);
  }
};

}  // namespace tetwarp::test
