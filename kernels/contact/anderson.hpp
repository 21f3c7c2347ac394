/// @file anderson.hpp
/// Anderson acceleration of a fixed-point iteration; see contact_accelerators.hpp.
#pragma once
#include <cstdint>

#include "kernels/base/plain_sums.hpp"
#include "kernels/base/small_cholesky.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

constexpr int anderson_window = 8;

/// Scalars of the last steps, and the action of the next one.
struct AndersonState {
  static constexpr int window = anderson_window;
  enum class Action { keep, reject, combine };

  /// Products of the columns of changes with the newest one, then with the defect; |defect|^2.
  PlainSums<2 * window + 1> sums;
  double gram[window][window] = {};  ///< products of the changes of defects
  double factor[window] = {};        ///< of the changes of images, in the next x
  double last_square = 0;            ///< |defect|^2 of the last accepted step
  int now = 0;                       ///< index of the stored iterate, of two, that is written next
  int depth = 0;                     ///< columns in use
  int newest = -1;                   ///< column of the next change; -1: no last iterate yet
  bool has_last = false;
  bool is_solved = false;  ///< `factor` was found by the last decide()
  Action action = Action::keep;

  TETWARP_HD double square() const { return sums.value[2 * window]; }

  /// Sets the action after observe(): keep, reject, or combine the image with the columns.
  TETWARP_HD_RARE void decide() {
    if (take_sums()) find_factors();
    finish();
  }

  /// The first part of decide().
  /// @return  whether to solve the least squares problem, which sets `factor`
  TETWARP_HD bool take_sums() {
    is_solved = false;
    if (has_last && square() > 4 * last_square) {
      action = Action::reject;  // the last iterate stays; the next one overwrites the rejected one
      restart();
      return false;
    }
    if (has_last) add_to_gram();
    now = 1 - now;
    has_last = true;
    last_square = square();
    action = Action::keep;
    return depth > 0;
  }
  /// The last part of decide().
  TETWARP_HD void finish() {
    if (action == Action::reject) return;
    if (is_solved) action = Action::combine;
    if (has_last) newest = (newest + 1) % window;
  }
  /// Entry of the matrix of the least squares problem, its columns scaled.
  TETWARP_HD double scaled(int i, int j, double scale_i, double scale_j) const {
    return scale_i * gram[i][j] * scale_j + (i == j ? 1e-12 : 0.0);
  }
  TETWARP_HD double scale_of(int i) const { return 1 / sqrt(max_of(gram[i][i], 1e-300)); }
  /// Stores the solution, or restarts if it is not finite.
  /// @param scaled_solution  [depth]
  TETWARP_HD void set_factors(bool is_positive, const double* scaled_solution) {
    bool is_finite = is_positive;
    for (int k = 0; k < window; ++k) {
      factor[k] = k < depth ? scaled_solution[k] : 0;
      is_finite = is_finite && fabs(factor[k]) < 1e30;  // in float32, too
    }
    is_solved = is_finite;
    if (!is_finite) restart();
  }

  /// What follows does not depend on earlier steps.
  TETWARP_HD void restart() {
    depth = 0;
    has_last = false;
    newest = -1;
  }

 private:
  TETWARP_HD void add_to_gram() {
    depth = min_of(depth + 1, window);
    for (int k = 0; k < depth; ++k) gram[k][newest] = gram[newest][k] = sums.value[k];
  }
  TETWARP_HD void find_factors() {
    // The changes differ in size by many orders of magnitude, so the matrix is scaled before it is
    // regularized.
    double matrix[window][window], solution[window], scale[window];
    for (int i = 0; i < depth; ++i) {
      scale[i] = scale_of(i);
      for (int j = 0; j <= i; ++j) matrix[i][j] = scaled(i, j, scale[i], scale[j]);
      solution[i] = scale[i] * sums.value[window + i];
    }
    const bool is_positive = solve_small_spd(matrix, depth, solution);
    for (int k = 0; k < depth; ++k) solution[k] *= scale[k];
    set_factors(is_positive, solution);
  }
};

/// A single index: the action of the next step.
struct AndersonDecideOp {
  AndersonState* state;
  TETWARP_HD void operator()(std::int64_t) const { state->decide(); }
};

/// A single index: forgets the steps so far.
struct AndersonForgetOp {
  AndersonState* state;
  TETWARP_HD void operator()(std::int64_t) const { state->restart(); }
};

template <class Exec>
TETWARP_ANY_EXEC void anderson_decide(Exec& exec, AndersonState* state) {
  exec.once("contact/mix", AndersonDecideOp{state});
}

/// Anderson acceleration, type II, window 8 (Walker and Ni 2011), with the least squares in a
/// diagonal metric. An image whose defect g(x) - x is more than twice the last one is rejected; the
/// iteration then restarts from the image before it.
template <class Exec, class T>
class AndersonMixer {
 public:
  static constexpr int window = anderson_window;
  static constexpr int columns = 4 + 2 * window;
  using GramSums = PlainSums<2 * window + 1>;

  /// Layout of the work vectors: defect and image of two iterates; changes of defects; changes of
  /// images.
  struct Columns {
    T* first;
    std::int64_t size;

    TETWARP_HD T* defect(int which) const { return first + 2 * which * size; }
    TETWARP_HD T* image(int which) const { return first + (2 * which + 1) * size; }
    TETWARP_HD T* defect_changes() const { return first + 4 * size; }
    TETWARP_HD T* image_changes() const { return first + (4 + window) * size; }
  };

  /// Clears the columns of changes: columns not yet written enter sums with a factor of zero.
  struct ZeroOp {
    T* values;
    TETWARP_HD void operator()(std::int64_t i) const { values[i] = 0; }
  };

  /// One run of entries: stores defect and image, their changes in column `newest`, and returns
  /// the products of the new change and the defect with all columns.
  struct ObserveOp {
    const AndersonState* state;
    const double* weights;
    View<const T> x, image;
    Columns columns;

    /// @tparam max_count  upper bound of last - first
    template <int max_count>
    TETWARP_HD GramSums run(std::int64_t first, std::int64_t last) const {
      const int newest = state->newest, now = state->now;
      const auto count = static_cast<int>(last - first);
      const std::int64_t place = first + (newest < 0 ? 0 : newest * x.size);
      T* const newest_defect = columns.defect_changes() + place;
      T* const newest_image = columns.image_changes() + place;
      T* const now_defect = columns.defect(now) + first;
      T* const now_image = columns.image(now) + first;
      const T* const last_defect = columns.defect(1 - now) + first;
      const T* const last_image = columns.image(1 - now) + first;
      double change[max_count] = {}, weighted[max_count];
      GramSums sums;
      for (int i = 0; i < count; ++i) {
        const T defect = image[first + i] - x[first + i];
        weighted[i] = weights[first + i] * defect;
        sums.value[2 * window] += weighted[i] * defect;
        if (newest >= 0) {
          newest_defect[i] = defect - last_defect[i];
          newest_image[i] = image[first + i] - last_image[i];
          change[i] = weights[first + i] * newest_defect[i];
        }
        now_defect[i] = defect;
        now_image[i] = image[first + i];
      }
      for (int k = 0; k < window; ++k) {
        const T* const changes = columns.defect_changes() + k * x.size + first;
        sums.value[k] = product(change, changes, count);
        sums.value[window + k] = product(weighted, changes, count);
      }
      return sums;
    }

    /// In four partial sums, which compilers vectorize.
    TETWARP_HD static double product(const double* a, const T* b, int count) {
      double lanes[4] = {};
      for (int i = 0; i + 4 <= count; i += 4) {
        for (int lane = 0; lane < 4; ++lane) lanes[lane] += a[i + lane] * b[i + lane];
      }
      for (int i = count - count % 4; i < count; ++i) lanes[0] += a[i] * b[i];
      return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
    }
  };

  struct AdvanceOp {
    const AndersonState* state;
    Columns columns;
    View<T> image;

    template <int max_count>
    TETWARP_HD void run(std::int64_t first, std::int64_t last) const {
      if (state->action == AndersonState::Action::keep) return;
      if (state->action == AndersonState::Action::reject) {
        const T* const good = columns.image(1 - state->now);
        for (std::int64_t i = first; i < last; ++i) image[i] = good[i];
        return;
      }
      T factor[window];
      for (int k = 0; k < window; ++k) factor[k] = static_cast<T>(state->factor[k]);
      for (std::int64_t i = first; i < last; ++i) {
        T sum = 0;
        for (int k = 0; k < window; ++k) {
          sum += factor[k] * columns.image_changes()[k * image.size + i];
        }
        image[i] -= sum;
      }
    }
  };

  /// @param weights  diagonal of the metric, [size]
  /// @param work     [columns][size]
  TETWARP_ANY_EXEC AndersonMixer(Exec& exec, View<const double> weights, View<T> work)
      : exec_(exec),
        weights_(weights),
        columns_{work.data, weights.size},
        state_(exec.template state<AndersonState>()) {
    exec_.for_each("contact/mix", 2 * window * weights.size, ZeroOp{columns_.defect_changes()});
  }

  TETWARP_ANY_EXEC void observe(View<const T> x, View<const T> image) {
    exec_.sum_runs_to("contact/mix", 0, x.size,
                      ObserveOp{state_, weights_.data, x, image, columns_}, &state_->sums);
  }
  TETWARP_ANY_EXEC double defect() { return sqrt(exec_.load(&state_->sums.value[2 * window])); }
  TETWARP_ANY_EXEC bool advance(View<const T>, View<T> image) {
    anderson_decide(exec_, state_);
    exec_.for_runs("contact/mix", image.size, AdvanceOp{state_, columns_, image});
    // If the action is not read, the image counts as replaced, which is always correct.
    return exec_.load_without_sync(&state_->action, AndersonState::Action::combine) !=
           AndersonState::Action::keep;
  }
  TETWARP_ANY_EXEC void forget() { exec_.once("contact/mix", AndersonForgetOp{state_}); }

 private:
  Exec& exec_;
  View<const double> weights_;
  Columns columns_;
  AndersonState* state_;
};

}  // namespace tetwarp
