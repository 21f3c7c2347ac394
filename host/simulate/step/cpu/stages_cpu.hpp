/// @file stages_cpu.hpp
/// Stages of a step that the host computes in vectors; see vector_stages.hpp.
#pragma once
#include <cstdint>
#include <type_traits>

#include "host/exec/exec_cpu.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"
#include "kernels/body/block_assemble.hpp"
#include "kernels/body/island_cg.hpp"
#include "kernels/body/tet_force.hpp"

namespace tetwarp {

inline void tet_forces(CpuExec& exec, const char* label, const TetForceOp& op) {
  exec.for_ranges(label, op.tets.count, [&](std::int64_t begin, std::int64_t end) {
    vector_stages().tet_forces(op, begin, end);
  });
}

inline void block_assemble(CpuExec& exec, const char* label, const BlockAssembleOp& op) {
  exec.for_ranges(label, op.rows.upper.size, [&](std::int64_t begin, std::int64_t end) {
    vector_stages().assemble(op, begin, end);
  });
}

/// GradientProductOp of a run of rows.
template <class T>
struct VectorProductOp {
  GradientArrays<T> a;

  template <int>
  PlainSums<1> run(std::int64_t begin, std::int64_t end) const {
    if constexpr (std::is_same_v<T, double>) {
      return vector_stages().product(a, begin, end);
    } else {
      return vector_stages().product_float(a, begin, end);
    }
  }
};

template <class T>
void gradient_product(CpuExec& exec,
                      const GradientArrays<T>& a,
                      std::int64_t begin,
                      std::int64_t end,
                      PlainSums<1>* curvature) {
  exec.sum_runs_to(gradient_label(), begin, end, VectorProductOp<T>{a}, curvature);
}

}  // namespace tetwarp
