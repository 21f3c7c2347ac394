/// @file solve_arrays.hpp
/// Arrays of the solve of a step in memory of an executor, and its system in memory of the host.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/simulate/step/stepper.hpp"
#include "host/simulate/step/system_pattern.hpp"
#include "kernels/body/island_cg.hpp"

namespace tetwarp {

/// Arrays of conjugate gradients in T numbers; for float also the copy of the system.
template <class Exec, class T>
struct SolveArrays {
  typename Exec::template LargeVector<T> copy, inverse, r, z, p, q;

  SolveArrays(Exec& exec,
              const SystemRows& rows,
              std::int64_t value_count,
              std::int64_t rigid_count) {
    if (sizeof(T) != sizeof(double)) exec.make_zeros(copy, value_count);
    exec.make_zeros(inverse, 9 * std::int64_t{rows.unknown_count} + 36 * rigid_count);
    for (auto* array : {&r, &z, &p, &q}) exec.make_zeros(*array, 3 * std::int64_t{rows.count});
  }

  GradientArrays<T> views(Exec& exec,
                          const SystemRows& rows,
                          std::int64_t node_count,
                          View<const double> values,
                          View<const double> load,
                          View<double> x) {
    GradientArrays<T> a;
    a.rows = rows;
    a.values = values;
    if constexpr (std::is_same_v<T, double>) {
      a.copy = values;
    } else {
      a.copy = exec.view(const_cast<const decltype(copy)&>(copy));
    }
    a.inverse = {rows.pair, rows.block_of, rows.unknown_count, node_count, exec.view(inverse)};
    a.load = load;
    a.x = x;
    a.r = exec.view(r);
    a.z = exec.view(z);
    a.p = exec.view(p);
    a.q = exec.view(q);
    return a;
  }
};

/// One index = one number: rounds it.
struct RoundOp {
  View<const double> from;
  View<float> to;
  TETWARP_HD void operator()(std::int64_t i) const { to[i] = static_cast<float>(from[i]); }
};

/// Fractions of a step, one per body and obstacle or none, by node and rigid body.
inline void fractions_of(const Model& model,
                         std::span<const double> of_bodies,
                         std::vector<double>& result) {
  result.clear();
  if (of_bodies.empty()) return;
  const auto of = [&](std::size_t body) {
    if (body >= of_bodies.size()) {
      throw std::invalid_argument(
          "simulation: expected fractions of all bodies and obstacles, got " +
          std::to_string(of_bodies.size()));
    }
    return of_bodies[body];
  };
  for (std::size_t b = 0; b + 1 < model.body_node.size(); ++b) {
    result.resize(static_cast<std::size_t>(model.body_node[b + 1]), of(b));
  }
  for (const std::int32_t body : model.rigid.body) {
    result.push_back(of(static_cast<std::size_t>(body)));
  }
}

/// The system of a step as BodyStepper::system() returns it. In memory of a device it is copied,
/// once per step, and the pattern is made a second time.
template <class Exec>
class HostSystem {
 public:
  /// To be called before the system changes.
  void forget() { has_values_ = false; }
  SystemRows rows(const Model& model, const SystemRows& own) {
    if constexpr (Exec::reads_are_free) {
      return own;
    } else {
      if (!pattern_) pattern_ = make_system_pattern(model);
      return rows_of(*pattern_);
    }
  }
  StepSystem get(Exec& exec,
                 const Model& model,
                 const SystemRows& rows,
                 View<const double> values,
                 View<const double> load,
                 View<const double> x) {
    const std::int64_t numbers = 9 * rows.column.size;
    if constexpr (Exec::reads_are_free) {
      return {rows, {values.data, numbers}, load, x};
    } else {
      const SystemRows own = this->rows(model, rows);
      if (!std::exchange(has_values_, true)) {
        copy(exec, View<const double>{values.data, numbers}, values_);
        copy(exec, load, load_);
        copy(exec, x, x_);
      }
      return {own, numbers_in(values_), numbers_in(load_), numbers_in(x_)};
    }
  }

 private:
  static void copy(Exec& exec, View<const double> own, std::vector<double>& host) {
    host.resize(static_cast<std::size_t>(own.size));
    exec.get(own, host.data());
  }
  static View<const double> numbers_in(const std::vector<double>& host) {
    return {host.data(), static_cast<std::int64_t>(host.size())};
  }

  bool has_values_ = false;  ///< of the present step
  std::optional<SystemPattern> pattern_;
  std::vector<double> values_, load_, x_;
};

}  // namespace tetwarp
