/// @file test_device.cpp
/// Only for machines with a device: fails without one, so that skipped tests are not taken for
/// passed ones.
#include <gtest/gtest.h>

#include <tetwarp/backend.hpp>

namespace tetwarp::test {
namespace {

TEST(Device, IsUsable) {
  const BackendStatus cuda = available_backends().front();
  EXPECT_TRUE(cuda.usable) << cuda.reason;
}

}  // namespace
}  // namespace tetwarp::test
