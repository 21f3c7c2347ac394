/// @file host_copy.hpp
/// HostCopy: numbers that an executor copies to the host.
#pragma once
#include "kernels/base/view.hpp"

namespace tetwarp {

/// Numbers in memory of an executor, and where on the host they are copied to.
struct HostCopy {
  View<const double> from;
  double* to;
};

}  // namespace tetwarp
