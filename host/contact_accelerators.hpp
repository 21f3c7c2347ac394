/// @file contact_accelerators.hpp
/// Accelerators of a fixed-point iteration x -> g(x) on the host. They see vectors and a diagonal
/// metric and know nothing of contacts. All have
///
///     double observe(x, image)             looks at image = g(x); the size of image - x
///     bool advance(x, image, that size)    may replace image by the next x; whether it did
#pragma once
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "kernels/hd.hpp"
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
  const double* weights;
  View<const T> x, image;

  TETWARP_HD PlainSums<1> operator()(std::int64_t i) const {
    const double defect = double{image[i]} - double{x[i]};
    return {{weights[i] * defect * defect}};
  }
};

/// Size of image - x in a diagonal metric.
template <class Exec, class T>
double defect_of(Exec& exec,
                 const std::vector<double>& weights,
                 View<const T> x,
                 View<const T> image) {
  const DefectBody<T> body{weights.data(), x, image};
  return sqrt(exec.template sum<PlainSums<1>>("contact/mix", 0, x.size, body).value[0]);
}

/// The iteration as it is.
template <class Exec, class T>
class PlainSteps {
 public:
  PlainSteps(Exec& exec, const std::vector<double>& weights) : exec_(exec), weights_(weights) {}

  double observe(View<const T> x, View<const T> image) {
    return defect_of(exec_, weights_, x, image);
  }
  bool advance(View<const T>, View<T>, double) { return false; }

 private:
  Exec& exec_;
  const std::vector<double>& weights_;
};

/// Anderson acceleration, type II, window 8 (Walker and Ni 2011), the least squares in a diagonal
/// metric. An image whose defect g(x) - x has grown to more than twice the last one is rejected:
/// the iteration restarts from the last good image.
template <class Exec, class T>
class AndersonMixer {
 public:
  static constexpr int window = 8;

  /// @param weights  diagonal of the metric, [size]; kept by the caller
  AndersonMixer(Exec& exec, const std::vector<double>& weights)
      : exec_(exec),
        weights_(weights),
        now_(weights.size()),
        last_(weights.size()),
        defect_changes_(window * weights.size()),
        image_changes_(window * weights.size()) {}

  double observe(View<const T> x, View<const T> image) {
    newest_ = has_last_ ? (newest_ + 1) % window : -1;
    sums_ = exec_.template sum_runs<GramSums>(
        "contact/mix", 0, x.size,
        ObserveBody{weights_.data(), x, image, last_.defect.data(), last_.image.data(),
                    now_.defect.data(), now_.image.data(), defect_changes_.data(),
                    image_changes_.data(), newest_});
    return std::sqrt(sums_.value[2 * window]);
  }

  bool advance(View<const T>, View<T> image, double defect) {
    if (has_last_ && defect > 2 * last_size_) {
      exec_.for_each("contact/mix", image.size, CopyBody{last_.image.data(), image});
      restart();
      return true;
    }
    if (has_last_) add_to_gram();
    std::swap(now_, last_);
    has_last_ = true;
    last_size_ = defect;
    if (depth_ == 0) return false;
    subtract_combination(image);
    return true;
  }

 private:
  using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, window, window>;
  using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, window, 1>;
  /// Products with the new change, then with the defect; the square of the defect.
  using GramSums = PlainSums<2 * window + 1>;

  struct Iterate {
    explicit Iterate(std::size_t size) : defect(size), image(size) {}
    std::vector<T> defect, image;
  };

  /// One run of entries: stores the iterate and its changes in column `newest`, multiplies them
  /// with all columns.
  struct ObserveBody {
    const double* weights;
    View<const T> x, image;
    const T *last_defect, *last_image;
    T *now_defect, *now_image, *defect_changes, *image_changes;
    int newest;  ///< -1: there is no last one yet

    GramSums operator()(std::int64_t first, std::int64_t last) const {
      const auto count = static_cast<int>(last - first);
      const std::int64_t column = newest < 0 ? 0 : newest * x.size;
      T* const newest_defect = defect_changes + column + first;
      T* const newest_image = image_changes + column + first;
      double change[Exec::run_length] = {}, weighted[Exec::run_length];
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
    static double product(const double* a, const T* b, int count) {
      double lanes[4] = {};
      for (int i = 0; i + 4 <= count; i += 4) {
        for (int lane = 0; lane < 4; ++lane) lanes[lane] += a[i + lane] * b[i + lane];
      }
      for (int i = count - count % 4; i < count; ++i) lanes[0] += a[i] * b[i];
      return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
    }
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

  struct CopyBody {
    const T* from;
    View<T> to;
    TETWARP_HD void operator()(std::int64_t i) const { to[i] = from[i]; }
  };

  void restart() {
    depth_ = 0;
    has_last_ = false;
  }

  void add_to_gram() {
    depth_ = min_of(depth_ + 1, window);
    for (int k = 0; k < depth_; ++k) gram_(k, newest_) = gram_(newest_, k) = sums_.value[k];
  }

  void subtract_combination(View<T> image) {
    Small gram = gram_.topLeftCorner(depth_, depth_);
    SmallVector products(depth_);
    for (int k = 0; k < depth_; ++k) products(k) = sums_.value[window + k];
    // Old and new changes differ in size by many orders: scale first, then regularize.
    const SmallVector scale = gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    gram = scale.asDiagonal() * gram * scale.asDiagonal();
    gram.diagonal().array() += 1e-12;
    const SmallVector factors =
        scale.asDiagonal() * gram.ldlt().solve(scale.asDiagonal() * products);
    if (!factors.allFinite()) return restart();
    CombineBody body{image_changes_.data(), {}, image};
    for (int k = 0; k < depth_; ++k) body.factor[k] = static_cast<T>(factors(k));
    exec_.for_each("contact/mix", image.size, body);
  }

  Exec& exec_;
  const std::vector<double>& weights_;
  Iterate now_, last_;
  std::vector<T> defect_changes_, image_changes_;  ///< [window][size]
  Eigen::Matrix<double, window, window> gram_;
  GramSums sums_;  ///< of the last look
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
  /// @param weights  diagonal of the metric, [size]; kept by the caller
  ConjugateDirection(Exec& exec, const std::vector<double>& weights)
      : exec_(exec), weights_(weights), direction_(weights.size()) {}

  double observe(View<const T> x, View<const T> image) {
    return defect_of(exec_, weights_, x, image);
  }
  bool advance(View<const T> x, View<T> image, double defect) {
    const double ratio = last_ > 0 ? (defect / last_) * (defect / last_) : 2;
    last_ = defect;
    exec_.for_each("contact/mix", image.size,
                   AdvanceBody{x, image, direction_.data(), static_cast<T>(ratio), ratio > 1});
    return true;
  }

 private:
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

  Exec& exec_;
  const std::vector<double>& weights_;
  std::vector<T> direction_;
  double last_ = 0;
};

}  // namespace tetwarp
