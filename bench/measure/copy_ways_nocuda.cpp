/// @file copy_ways_nocuda.cpp
/// A build without CUDA registers no rows that copy to a device.
#include <tetwarp/error.hpp>

#include "bench/measure/copy_ways.hpp"

namespace tetwarp::bench {

RingShape usual_ring() {
  return {};
}

struct CopyWays::State {};

CopyWays::CopyWays(std::size_t, CopyDirection, const RingShape&) {
  throw CudaError("this build has no CUDA");
}
CopyWays::~CopyWays() = default;
void CopyWays::staged() {}
void CopyWays::by_runtime() {}
void CopyWays::locked() {}
void CopyWays::staged_untouched() {}
void CopyWays::by_runtime_untouched() {}
void CopyWays::lock() {}
bool CopyWays::is_right() {
  return false;
}

}  // namespace tetwarp::bench
