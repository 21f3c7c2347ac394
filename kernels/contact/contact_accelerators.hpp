/// @file contact_accelerators.hpp
/// Accelerators of a fixed-point iteration x -> g(x), for any executor. They work on vectors with a
/// diagonal metric and do not depend on contacts. All have the members
///
///     columns            work vectors of the size of x that they need
///     observe(x, image)  records image = g(x)
///     defect()           norm of image - x at the last observe(); on a device this synchronizes
///     advance(x, image)  may replace image by an accelerated x; returns whether it may have
///     forget()           what follows does not depend on what was observed
///
/// All decisions of an accelerator are computed in memory of the executor, without synchronizing.
#pragma once
#include <cstdint>

#include "kernels/base/plain_sums.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

/// One index = one entry of the squared difference of two vectors in a diagonal metric.
template <class T>
struct DefectOp {
  View<const double> weights;
  View<const T> x, image;

  TETWARP_HD PlainSums<1> operator()(std::int64_t i) const {
    const double defect = double{image[i]} - double{x[i]};
    return {{weights[i] * defect * defect}};
  }
};

/// No acceleration: the next x is g(x).
template <class Exec, class T>
class PlainSteps {
 public:
  static constexpr int columns = 0;

  TETWARP_ANY_EXEC PlainSteps(Exec& exec, View<const double> weights, View<T>)
      : exec_(exec), weights_(weights), sums_(exec.template state<PlainSums<1>>()) {}

  TETWARP_ANY_EXEC void observe(View<const T> x, View<const T> image) {
    exec_.sum_to("contact/mix", 0, x.size, DefectOp<T>{weights_, x, image}, sums_);
  }
  TETWARP_ANY_EXEC double defect() { return sqrt(exec_.load(&sums_->value[0])); }
  TETWARP_ANY_EXEC bool advance(View<const T>, View<T>) { return false; }
  TETWARP_ANY_EXEC void forget() {}

 private:
  Exec& exec_;
  View<const double> weights_;
  PlainSums<1>* sums_;
};

/// Nonsmooth nonlinear conjugate gradients over sweeps (Silcowitz-Hansen, Niebe, Erleben 2010):
/// Fletcher-Reeves on the defect, restarted when it grows.
template <class Exec, class T>
class ConjugateDirection {
 public:
  static constexpr int columns = 1;

  struct State {
    PlainSums<1> square;  ///< |g(x) - x|^2
    double last = 0;      ///< its value at the step before
    double ratio = 0;     ///< of square and last: the factor of the old direction
    bool is_restart = true;
  };

  /// A single index: the factor of the next step, or a restart.
  struct DecideOp {
    State* state;
    TETWARP_HD void operator()(std::int64_t) const {
      const double square = state->square.value[0];
      state->is_restart = !(state->last > 0 && square <= state->last);
      state->ratio = state->is_restart ? 0 : square / state->last;
      state->last = square;
    }
  };

  /// A single index: the next step is a restart.
  struct ForgetOp {
    State* state;
    TETWARP_HD void operator()(std::int64_t) const { state->last = 0; }
  };

  struct AdvanceOp {
    const State* state;
    View<const T> x;
    View<T> image;
    T* direction;

    template <int max_count>
    TETWARP_HD void run(std::int64_t first, std::int64_t last) const {
      const bool is_restart = state->is_restart;
      const T ratio = static_cast<T>(state->ratio);
      for (std::int64_t i = first; i < last; ++i) {
        const T defect = image[i] - x[i];
        const T before = is_restart ? T(0) : ratio * direction[i];
        image[i] += before;
        direction[i] = is_restart ? T(0) : before + defect;
      }
    }
  };

  /// @param weights  diagonal of the metric, [size]
  /// @param work     [size]
  TETWARP_ANY_EXEC ConjugateDirection(Exec& exec, View<const double> weights, View<T> work)
      : exec_(exec),
        weights_(weights),
        direction_(work.data),
        state_(exec.template state<State>()) {}

  TETWARP_ANY_EXEC void observe(View<const T> x, View<const T> image) {
    exec_.sum_to("contact/mix", 0, x.size, DefectOp<T>{weights_, x, image}, &state_->square);
  }
  /// The state, in memory of the executor.
  const State* state() const { return state_; }
  TETWARP_ANY_EXEC double defect() { return sqrt(exec_.load(&state_->square.value[0])); }
  TETWARP_ANY_EXEC bool advance(View<const T> x, View<T> image) {
    exec_.once("contact/mix", DecideOp{state_});
    exec_.for_runs("contact/mix", image.size, AdvanceOp{state_, x, image, direction_});
    return true;
  }
  TETWARP_ANY_EXEC void forget() { exec_.once("contact/mix", ForgetOp{state_}); }

 private:
  Exec& exec_;
  View<const double> weights_;
  T* direction_;
  State* state_;
};

}  // namespace tetwarp
