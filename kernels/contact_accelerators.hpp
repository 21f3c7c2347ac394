/// @file contact_accelerators.hpp
/// Accelerators of a fixed-point iteration x -> g(x), for any executor. They see vectors and a
/// diagonal metric and know nothing of contacts. All have
///
///     columns                              vectors of the size of x that they need to work with
///     double observe(x, image)             looks at image = g(x); the size of image - x
///     bool advance(x, image, that size)    may replace image by the next x; whether it did
#pragma once
#include <cstdint>

#include "kernels/small_cholesky.hpp"
#include "kernels/view.hpp"

namespace tetwarp {

/// Sums of one pass over a vector; plain numbers, added in the executor's fixed tree.
template <int count>
struct PlainSums {
  double value[count] = {};

  TETWARP_HD PlainSums& operator+=(const PlainSums& other) {
    for (int k = 0; k < count; ++k) value[k] += other.value[k];
    return *this;
  }
};

/// One index = one entry of the squared difference of two vectors in a diagonal metric.
template <class T>
struct DefectBody {
  View<const double> weights;
  View<const T> x, image;

  TETWARP_HD PlainSums<1> operator()(std::int64_t i) const {
    const double defect = double{image[i]} - double{x[i]};
    return {{weights[i] * defect * defect}};
  }
};

/// Size of image - x in a diagonal metric.
template <class Exec, class T>
TETWARP_ANY_EXEC double defect_of(Exec& exec,
                                  View<const double> weights,
                                  View<const T> x,
                                  View<const T> image) {
  const DefectBody<T> body{weights, x, image};
  return sqrt(exec.template sum<PlainSums<1>>("contact/mix", 0, x.size, body).value[0]);
}

/// The iteration as it is.
template <class Exec, class T>
class PlainSteps {
 public:
  static constexpr int columns = 0;

  TETWARP_ANY_EXEC PlainSteps(Exec& exec, View<const double> weights, View<T>)
      : exec_(exec), weights_(weights) {}

  TETWARP_ANY_EXEC double observe(View<const T> x, View<const T> image) {
    return defect_of(exec_, weights_, x, image);
  }
  TETWARP_ANY_EXEC bool advance(View<const T>, View<T>, double) { return false; }

 private:
  Exec& exec_;
  View<const double> weights_;
};

/// Anderson acceleration, type II, window 8 (Walker and Ni 2011), the least squares in a diagonal
/// metric. An image whose defect g(x) - x has grown to more than twice the last one is rejected:
/// the iteration restarts from the last good image.
template <class Exec, class T>
class AndersonMixer {
 public:
  static constexpr int window = 8;
  static constexpr int columns = 4 + 2 * window;

  /// Products with the new change, then with the defect; the square of the defect.
  using GramSums = PlainSums<2 * window + 1>;

  /// One run of entries: stores the iterate and its changes in column `newest`, multiplies them
  /// with all columns.
  struct ObserveBody {
    const double* weights;
    View<const T> x, image;
    const T *last_defect, *last_image;
    T *now_defect, *now_image, *defect_changes, *image_changes;
    int newest;  ///< -1: there is no last one yet

    /// @tparam most  entries of a run: scratch numbers
    template <int most>
    TETWARP_HD GramSums run(std::int64_t first, std::int64_t last) const {
      const auto count = static_cast<int>(last - first);
      const std::int64_t place = newest < 0 ? 0 : newest * x.size;
      T* const newest_defect = defect_changes + place + first;
      T* const newest_image = image_changes + place + first;
      double change[most] = {}, weighted[most];
      GramSums sums;
      for (int i = 0; i < count; ++i) {
        const T defect = image[first + i] - x[first + i];
        weighted[i] = weights[first + i] * defect;
        sums.value[2 * window] += weighted[i] * defect;
        if (newest >= 0) {
          newest_defect[i] = defect - last_defect[first + i];
          newest_image[i] = image[first + i] - last_image[first + i];
          change[i] = weights[first + i] * newest_defect[i];
        }
        now_defect[first + i] = defect;
        now_image[first + i] = image[first + i];
      }
      for (int k = 0; k < window; ++k) {
        const T* const changes = defect_changes + k * x.size + first;
        sums.value[k] = product(change, changes, count);
        sums.value[window + k] = product(weighted, changes, count);
      }
      return sums;
    }

    /// In four lanes, which compilers turn into vectors.
    TETWARP_HD static double product(const double* a, const T* b, int count) {
      double lanes[4] = {};
      for (int i = 0; i + 4 <= count; i += 4) {
        for (int lane = 0; lane < 4; ++lane) lanes[lane] += a[i + lane] * b[i + lane];
      }
      for (int i = count - count % 4; i < count; ++i) lanes[0] += a[i] * b[i];
      return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
    }
  };

  struct ZeroBody {
    T* values;
    TETWARP_HD void operator()(std::int64_t i) const { values[i] = 0; }
  };

  struct CombineBody {
    const T* image_changes;
    T factor[window];
    View<T> image;
    TETWARP_HD void operator()(std::int64_t i) const {
      T sum = 0;
      for (int k = 0; k < window; ++k) sum += factor[k] * image_changes[k * image.size + i];
      image[i] -= sum;
    }
  };

  /// @param weights  diagonal of the metric, [size]
  /// @param work     [columns][size]
  TETWARP_ANY_EXEC AndersonMixer(Exec& exec, View<const double> weights, View<T> work)
      : exec_(exec), weights_(weights), work_(work.data) {
    // All columns of changes take part, those not yet written with a factor of zero.
    exec_.for_each("contact/mix", 2 * window * weights.size, ZeroBody{column(4)});
  }

  TETWARP_ANY_EXEC double observe(View<const T> x, View<const T> image) {
    newest_ = has_last_ ? (newest_ + 1) % window : -1;
    const ObserveBody body{weights_.data,
                           x,
                           image,
                           column(2 * (1 - now_)),
                           column(2 * (1 - now_) + 1),
                           column(2 * now_),
                           column(2 * now_ + 1),
                           column(4),
                           column(4 + window),
                           newest_};
    sums_ = exec_.template sum_runs<GramSums>("contact/mix", 0, x.size, body);
    return sqrt(sums_.value[2 * window]);
  }

  TETWARP_ANY_EXEC bool advance(View<const T>, View<T> image, double defect) {
    if (has_last_ && defect > 2 * last_size_) {
      exec_.copy("contact/mix", View<const T>{column(2 * (1 - now_) + 1), image.size}, image);
      restart();
      return true;
    }
    if (has_last_) add_to_gram();
    now_ = 1 - now_;
    has_last_ = true;
    last_size_ = defect;
    if (depth_ == 0) return false;
    subtract_combination(image);
    return true;
  }

 private:
  TETWARP_HD T* column(int k) const { return work_ + k * weights_.size; }

  TETWARP_HD void restart() {
    depth_ = 0;
    has_last_ = false;
  }

  TETWARP_HD void add_to_gram() {
    depth_ = min_of(depth_ + 1, window);
    for (int k = 0; k < depth_; ++k) gram_[k][newest_] = gram_[newest_][k] = sums_.value[k];
  }

  TETWARP_ANY_EXEC void subtract_combination(View<T> image) {
    // Old and new changes differ in size by many orders: scale first, then regularize.
    double gram[window][window], factors[window], scale[window];
    for (int i = 0; i < depth_; ++i) {
      scale[i] = 1 / sqrt(max_of(gram_[i][i], 1e-300));
      for (int j = 0; j < i; ++j) gram[i][j] = scale[i] * gram_[i][j] * scale[j];
      gram[i][i] = scale[i] * gram_[i][i] * scale[i] + 1e-12;
      factors[i] = scale[i] * sums_.value[window + i];
    }
    CombineBody body{column(4 + window), {}, image};
    bool is_finite = solve_small_spd(gram, depth_, factors);
    for (int k = 0; k < depth_; ++k) {
      body.factor[k] = static_cast<T>(scale[k] * factors[k]);
      is_finite = is_finite && fabs(body.factor[k]) < INFINITY;
    }
    if (!is_finite) return restart();
    exec_.for_each("contact/mix", image.size, body);
  }

  Exec& exec_;
  View<const double> weights_;
  T* work_;  ///< columns: defect and image, twice; changes of defects; changes of images
  double gram_[window][window];
  GramSums sums_;  ///< of the last look
  int now_ = 0;    ///< which of the two iterates is written next
  int depth_ = 0;
  int newest_ = -1;  ///< column of the last look
  bool has_last_ = false;
  double last_size_ = 0;
};

/// Nonsmooth nonlinear conjugate gradients over sweeps (Silcowitz-Hansen, Niebe, Erleben 2010):
/// Fletcher-Reeves on the defect, restarted when it grows.
template <class Exec, class T>
class ConjugateDirection {
 public:
  static constexpr int columns = 1;

  struct AdvanceBody {
    View<const T> x;
    View<T> image;
    T* direction;
    T ratio;
    bool is_restart;
    TETWARP_HD void operator()(std::int64_t i) const {
      const T defect = image[i] - x[i];
      if (is_restart) {
        direction[i] = 0;
        return;
      }
      image[i] += ratio * direction[i];
      direction[i] = ratio * direction[i] + defect;
    }
  };

  /// @param weights  diagonal of the metric, [size]
  /// @param work     [size]
  TETWARP_ANY_EXEC ConjugateDirection(Exec& exec, View<const double> weights, View<T> work)
      : exec_(exec), weights_(weights), direction_(work.data) {}

  TETWARP_ANY_EXEC double observe(View<const T> x, View<const T> image) {
    return defect_of(exec_, weights_, x, image);
  }
  TETWARP_ANY_EXEC bool advance(View<const T> x, View<T> image, double defect) {
    const double ratio = last_ > 0 ? (defect / last_) * (defect / last_) : 2;
    last_ = defect;
    exec_.for_each("contact/mix", image.size,
                   AdvanceBody{x, image, direction_, static_cast<T>(ratio), ratio > 1});
    return true;
  }

 private:
  Exec& exec_;
  View<const double> weights_;
  T* direction_;
  double last_ = 0;
};

}  // namespace tetwarp
