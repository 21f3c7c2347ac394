/// @file device_sweep.cuh
/// The stage "sweep" on a whole device.
#pragma once
#include <cstdint>

#include "kernels/contact/contact_sweep.hpp"
#include "kernels/contact/cuda/delassus_lanes.cuh"
#include "kernels/exec/exec_cuda.cuh"

namespace tetwarp {

/// As a recorded graph; CudaExec::forget_parts() drops it.
template <class Op>
void contact_sweep(CudaExec& exec, View<const std::int64_t> color_start, const Op& op) {
  exec.for_each_part(color_start, op);
}
template <class T>
void contact_sweep(CudaExec& exec,
                   View<const std::int64_t> color_start,
                   const DelassusSweepOp<T>& op) {
  if (has_long_rows(op.delassus)) {
    exec.for_each_part(color_start, DelassusSweepLanesOp<T>{op});
  } else {
    exec.for_each_part(color_start, op);
  }
}

}  // namespace tetwarp
