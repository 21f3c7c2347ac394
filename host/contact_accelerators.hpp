/// @file contact_accelerators.hpp
/// Accelerators of a fixed-point iteration x -> g(x), for any executor. They see vectors and a
/// metric and know nothing of contacts.
#pragma once
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cstdint>
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

/// Anderson acceleration, type II, window 8 (Walker and Ni 2011), the least squares in a diagonal
/// metric. An image whose defect g(x) - x has grown to more than twice the last one is rejected:
/// the iteration restarts from the last good image.
template <class Exec, class T>
class AndersonMixer {
 public:
  static constexpr int window = 8;

  /// @param weights  diagonal of the metric, [size]
  AndersonMixer(Exec& exec, std::vector<double> weights)
      : exec_(exec), weights_(std::move(weights)) {
    const std::size_t size = weights_.size();
    last_defect_.resize(size);
    last_image_.resize(size);
    defect_changes_.resize(window * size);
    image_changes_.resize(window * size);
  }

  /// Replaces `image` = g(x), at distance `defect` from x, by the next x. False: x was rejected,
  /// `image` is the one before.
  bool mix(View<const T> x, View<T> image, double defect) {
    if (has_last_ && defect > 2 * last_size_) {
      copy(last_image_.data(), image);
      restart();
      return false;
    }
    const GramSums sums = remember(x, image);
    if (has_last_) add_to_gram(sums);
    has_last_ = true;
    last_size_ = defect;
    if (depth_ > 0) subtract_combination(sums, image);
    return true;
  }

  void restart() {
    depth_ = 0;
    newest_ = -1;
    has_last_ = false;
  }

 private:
  using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, window, window>;
  using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, window, 1>;
  using GramSums = PlainSums<2 * window>;  ///< products with the new change, then with the defect

  /// Stores the new changes in column `newest` and multiplies them with all columns.
  struct RememberBody {
    const double* weights;
    View<const T> x, image;
    T *last_defect, *last_image, *defect_changes, *image_changes;
    int newest;  ///< -1: there is no last one yet
    TETWARP_HD GramSums operator()(std::int64_t i) const {
      const T defect = image[i] - x[i];
      T* changes = defect_changes + window * i;
      double change = 0;
      if (newest >= 0) {
        changes[newest] = defect - last_defect[i];
        image_changes[window * i + newest] = image[i] - last_image[i];
        change = weights[i] * changes[newest];
      }
      last_defect[i] = defect;
      last_image[i] = image[i];
      GramSums sums;
      for (int k = 0; k < window; ++k) {
        sums.value[k] = change * changes[k];
        sums.value[window + k] = weights[i] * defect * changes[k];
      }
      return sums;
    }
  };

  struct CombineBody {
    const T* image_changes;
    T factor[window];
    View<T> image;
    TETWARP_HD void operator()(std::int64_t i) const {
      T sum = 0;
      for (int k = 0; k < window; ++k) sum += factor[k] * image_changes[window * i + k];
      image[i] -= sum;
    }
  };

  struct CopyBody {
    const T* from;
    View<T> to;
    TETWARP_HD void operator()(std::int64_t i) const { to[i] = from[i]; }
  };

  void copy(const T* from, View<T> to) {
    exec_.for_each("contact/mix", to.size, CopyBody{from, to});
  }

  GramSums remember(View<const T> x, View<const T> image) {
    if (has_last_) newest_ = (newest_ + 1) % window;
    return exec_.template sum<GramSums>(
        "contact/mix", 0, x.size,
        RememberBody{weights_.data(), x, image, last_defect_.data(), last_image_.data(),
                     defect_changes_.data(), image_changes_.data(), newest_});
  }

  void add_to_gram(const GramSums& sums) {
    depth_ = min_of(depth_ + 1, window);
    for (int k = 0; k < depth_; ++k) gram_(k, newest_) = gram_(newest_, k) = sums.value[k];
  }

  void subtract_combination(const GramSums& sums, View<T> image) {
    Small gram = gram_.topLeftCorner(depth_, depth_);
    SmallVector products(depth_);
    for (int k = 0; k < depth_; ++k) products(k) = sums.value[window + k];
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
  std::vector<double> weights_;
  std::vector<T> last_defect_, last_image_;
  std::vector<T> defect_changes_, image_changes_;  ///< [size][window]
  Eigen::Matrix<double, window, window> gram_;
  int depth_ = 0;
  int newest_ = -1;
  bool has_last_ = false;
  double last_size_ = 0;
};

/// Nonsmooth nonlinear conjugate gradients over sweeps (Silcowitz-Hansen, Niebe, Erleben 2010):
/// Fletcher-Reeves on the defect, restarted when it grows.
template <class Exec, class T>
class ConjugateDirection {
 public:
  ConjugateDirection(Exec& exec, std::int64_t size)
      : exec_(exec), direction_(static_cast<std::size_t>(size)) {}

  /// Replaces `image` = g(x) by the next x.
  /// @param defect  size of image - x in the metric
  void advance(View<const T> x, View<T> image, double defect) {
    const double ratio = last_ > 0 ? (defect / last_) * (defect / last_) : 2;
    last_ = defect;
    exec_.for_each("contact/mix", image.size,
                   AdvanceBody{x, image, direction_.data(), static_cast<T>(ratio), ratio > 1});
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
  std::vector<T> direction_;
  double last_ = 0;
};

}  // namespace tetwarp
