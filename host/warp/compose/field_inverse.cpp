/// @file field_inverse.cpp
/// Damped Newton steps of many points at once, and cells whose images hold a point.
#include "host/warp/compose/field_inverse.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <variant>

#include "host/base/parallel.hpp"
#include "host/base/point3.hpp"
#include "host/warp/cpu/transform_links.hpp"

namespace tetwarp {
namespace {
constexpr int most_steps = 50;
constexpr int most_halvings = 10;

/// A point on its way to an x.
struct Search {
  std::size_t point = 0;  ///< whose inverse it is
  Point3 target{}, x{};
  Point3 missing{};  ///< target - x - u(x)
};

bool holds(const Bounds& box, const Point3& x, double slack) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(x[axis] >= box.low[axis] - slack && x[axis] <= box.high[axis] + slack)) return false;
  }
  return true;
}

/// The d with column[0] d0 + column[1] d1 + column[2] d2 = right, by Cramer's rule; `right` itself
/// where the columns are nearly in a plane.
Point3 solution(const std::array<Point3, 3>& column, const Point3& right) {
  const Point3 normal = cross(column[1], column[2]);
  const double determinant = dot(column[0], normal);
  if (!(std::abs(determinant) > 1e-9 * norm(column[0]) * norm(column[1]) * norm(column[2]))) {
    return right;
  }
  return {dot(right, normal) / determinant, dot(column[0], cross(right, column[2])) / determinant,
          dot(column[0], cross(column[1], right)) / determinant};
}

/// Cells of a field or a spline, each with a box around all positions to which it is taken.
class ImageCells {
 public:
  explicit ImageCells(const Transform& field) {
    if (const auto* const spline = std::get_if<BSplineTransform>(&field)) {
      grid_ = &spline->grid;
      spline_ = spline->coefficients.data();
    } else {
      const auto& linear = std::get<DisplacementField>(field);
      grid_ = &linear.grid;
      linear_ = linear.displacement.data();
    }
  }

  const Grid& grid() const { return *grid_; }

  /// Calls visit(low, high, box) for each cell, which reaches from index low to index high.
  template <class Visit>
  void for_each(const Visit& visit) const {
    // A linear field goes on for half a voxel beyond its outermost centers, a spline ends one knot
    // before its outermost ones.
    const std::int64_t first = spline_ ? 1 : -1, end = spline_ ? -2 : 0;
    const auto& dims = grid_->dims;
    for (std::int64_t k = first; k < dims[2] + end; ++k) {
      for (std::int64_t j = first; j < dims[1] + end; ++j) {
        for (std::int64_t i = first; i < dims[0] + end; ++i) visit_cell({i, j, k}, visit);
      }
    }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;

  template <class Visit>
  void visit_cell(const Cell& cell, const Visit& visit) const {
    Bounds image;
    Point3 low{}, high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = index_of(cell[axis], axis);
      high[axis] = index_of(cell[axis] + 1, axis);
    }
    for (int corner = 0; corner < 8; ++corner) {
      Cell node = cell;
      Point3 index = low;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if ((corner >> axis & 1) == 0) continue;
        ++node[axis];
        index[axis] = high[axis];
      }
      const Point3 x = grid_->world_of(index);
      image.include(linear_ ? plus(x, displacement(linear_, node)) : x);
    }
    if (spline_) widen(cell, image);
    visit(low, high, image);
  }

  /// The index of a node of the cells along an axis: half a voxel before the first center, the
  /// centers, half a voxel behind the last one [voxel].
  double index_of(std::int64_t node, std::size_t axis) const {
    return std::clamp(static_cast<double>(node), -0.5,
                      static_cast<double>(grid_->dims[axis]) - 0.5);
  }

  /// By the largest and smallest coefficients around a cell: a spline is a mean of them.
  void widen(const Cell& cell, Bounds& image) const {
    Bounds range;
    for (int n = 0; n < 64; ++n) {
      range.include(displacement(
          spline_, {cell[0] - 1 + n % 4, cell[1] - 1 + n / 4 % 4, cell[2] - 1 + n / 16}));
    }
    image.low = plus(image.low, range.low);
    image.high = plus(image.high, range.high);
  }

  template <class Number>
  Point3 displacement(const Number* numbers, Cell node) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      node[axis] = std::clamp<std::int64_t>(node[axis], 0, grid_->dims[axis] - 1);
    }
    const Number* const at =
        numbers + 3 * (node[0] + grid_->dims[0] * (node[1] + grid_->dims[1] * node[2]));
    return {static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])};
  }

  const Grid* grid_ = nullptr;
  const float* linear_ = nullptr;
  const double* spline_ = nullptr;
};

/// Positions in bins of equal size, to find those in a box.
class Bins {
 public:
  Bins(const std::vector<Point3>& points, const std::vector<std::size_t>& chosen, double size)
      : points_(points), size_(size) {
    for (const std::size_t p : chosen) bounds_.include(points[p]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double length = bounds_.high[axis] - bounds_.low[axis];
      count_[axis] = static_cast<std::int64_t>(std::min(length / size_, 63.0)) + 1;
      edge_[axis] = std::max(length / static_cast<double>(count_[axis]), size_ * 1e-3);
    }
    bins_.resize(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]));
    for (const std::size_t p : chosen) {
      const std::array<std::int64_t, 3> bin = bin_of(points[p]);
      bins_[place(bin[0], bin[1], bin[2])].push_back(p);
    }
  }

  template <class Visit>
  void for_each_in(const Bounds& box, double slack, const Visit& visit) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!(box.high[axis] + slack >= bounds_.low[axis]) ||
          !(box.low[axis] - slack <= bounds_.high[axis])) {
        return;
      }
    }
    const Point3 margin{slack, slack, slack};
    const auto first = bin_of(minus(box.low, margin)), last = bin_of(plus(box.high, margin));
    for (std::int64_t k = first[2]; k <= last[2]; ++k) {
      for (std::int64_t j = first[1]; j <= last[1]; ++j) {
        for (std::int64_t i = first[0]; i <= last[0]; ++i) {
          for (const std::size_t p : bins_[place(i, j, k)]) {
            if (holds(box, points_[p], slack)) visit(p);
          }
        }
      }
    }
  }

 private:
  std::array<std::int64_t, 3> bin_of(const Point3& x) const {
    std::array<std::int64_t, 3> bin{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto last = static_cast<double>(count_[axis] - 1);
      bin[axis] = static_cast<std::int64_t>(
          std::clamp((x[axis] - bounds_.low[axis]) / edge_[axis], 0.0, last));
    }
    return bin;
  }
  std::size_t place(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>(i + count_[0] * (j + count_[1] * k));
  }

  const std::vector<Point3>& points_;
  double size_;
  Bounds bounds_;
  std::array<std::int64_t, 3> count_{};
  Point3 edge_{};
  std::vector<std::vector<std::size_t>> bins_;
};

/// Finds the inverses of many points.
class InverseFinder {
 public:
  InverseFinder(const Transform& field, int threads, const std::function<void()>& progress)
      : links_(links_of(field)),
        threads_(threads),
        progress_(progress),
        cells_(field),
        spacing_(std::ranges::min(cells_.grid().spacing)) {
    const Grid& grid = cells_.grid();
    Point3 last{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      last[axis] = 0.5 * static_cast<double>(grid.dims[axis] - 1);
    }
    center_ = grid.world_of(last);
  }

  FieldInverse apply(std::vector<Point3>& points) {
    targets_ = points;
    is_found_.assign(points.size(), false);
    std::vector<Search> searches;
    for (std::size_t p = 0; p < points.size(); ++p) {
      begin({p, targets_[p], targets_[p], {}}, searches, points);
    }
    run(searches, points);
    for (const int starts : {1, 3}) search_cells(starts, points);
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (!is_found_[p]) result_.not_found.push_back(p);
    }
    return result_;
  }

 private:
  double tolerance() const { return 1e-6 * spacing_; }

  /// Begins again in each cell that may be taken to a point without an inverse.
  /// @param starts  positions in a cell where it begins, along each axis
  void search_cells(int starts, std::vector<Point3>& points) {
    std::vector<std::size_t> left;
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (!is_found_[p]) left.push_back(p);
    }
    if (left.empty()) return;
    const Bins bins(targets_, left, 2 * spacing_);
    std::vector<Search> searches;
    cells_.for_each([&](const Point3& low, const Point3& high, const Bounds& image) {
      bins.for_each_in(image, tolerance(), [&](std::size_t p) {
        for (int n = 0; n < starts * starts * starts && !is_found_[p]; ++n) {
          const std::array<int, 3> part{n % starts, n / starts % starts, n / starts / starts};
          Point3 index{};
          for (std::size_t axis = 0; axis < 3; ++axis) {
            index[axis] = low[axis] + (high[axis] - low[axis]) * (part[axis] + 0.5) / starts;
          }
          begin({p, targets_[p], cells_.grid().world_of(index), {}}, searches, points);
        }
      });
    });
    run(searches, points);
  }

  /// Adds a search, and runs all where they are many.
  void begin(const Search& search, std::vector<Search>& searches, std::vector<Point3>& points) {
    constexpr std::size_t most_at_once = 1 << 16;
    searches.push_back(search);
    if (searches.size() == most_at_once) run(searches, points);
  }

  /// Makes Newton steps. A search ends when its residual is small enough, or a step does not reduce
  /// it.
  /// @param searches  empty afterwards
  void run(std::vector<Search>& searches, std::vector<Point3>& points) {
    if (progress_) progress_();
    evaluate(searches);
    for (int n = 0; !searches.empty(); ++n) {
      keep_found(searches, points);
      if (n == most_steps) searches.clear();
      make_step(searches);
    }
  }

  void evaluate(std::vector<Search>& searches) const {
    const auto count = std::ssize(searches);
    parallel_for(threads_for(threads_, count), count, [&](std::int64_t s) {
      Search& search = searches[static_cast<std::size_t>(s)];
      search.missing = minus(search.target, image_of(search.x));
    });
  }

  /// Where the field takes x.
  Point3 image_of(Point3 x) const {
    for (const TransformLink& link : links_) link.move(x.data());
    return x;
  }

  void keep_found(std::vector<Search>& searches, std::vector<Point3>& points) {
    std::erase_if(searches, [&](const Search& search) {
      if (is_found_[search.point]) return true;
      const double residual = norm(search.missing);
      if (!(residual <= tolerance())) return false;
      is_found_[search.point] = true;
      points[search.point] = search.x;
      result_.largest_residual = std::max(result_.largest_residual, residual);
      return true;
    });
  }

  /// Makes one step of all searches. Those whose residual it does not reduce end.
  void make_step(std::vector<Search>& searches) const {
    const std::vector<Point3> steps = newton_steps(searches);
    std::vector<Search> nearer, left = searches;
    std::vector<Point3> left_steps = steps;
    double share = 1;
    for (int n = 0; n < most_halvings && !left.empty(); ++n, share /= 2) {
      std::vector<Search> tried = left;
      for (std::size_t s = 0; s < tried.size(); ++s) {
        for (std::size_t axis = 0; axis < 3; ++axis)
          tried[s].x[axis] += share * left_steps[s][axis];
      }
      evaluate(tried);
      std::size_t count = 0;
      for (std::size_t s = 0; s < tried.size(); ++s) {
        if (norm(tried[s].missing) < norm(left[s].missing)) {
          nearer.push_back(tried[s]);
        } else {
          left[count] = left[s];
          left_steps[count++] = left_steps[s];
        }
      }
      left.resize(count);
      left_steps.resize(count);
    }
    searches = std::move(nearer);
  }

  std::vector<Point3> newton_steps(const std::vector<Search>& searches) const {
    std::vector<Point3> steps(searches.size());
    const auto count = std::ssize(searches);
    parallel_for(threads_for(threads_, count), count, [&](std::int64_t s) {
      steps[static_cast<std::size_t>(s)] = newton_step(searches[static_cast<std::size_t>(s)]);
    });
    return steps;
  }

  /// By differences of the map, taken towards the center of the grid, beyond whose rim it jumps.
  Point3 newton_step(const Search& search) const {
    const double distance = 1e-4 * spacing_;
    const Point3 here = minus(search.target, search.missing);
    std::array<Point3, 3> columns;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Point3 moved = search.x;
      moved[axis] += moved[axis] > center_[axis] ? -distance : distance;
      const double change = moved[axis] - search.x[axis];
      columns[axis] = minus(image_of(moved), here);
      for (double& entry : columns[axis]) entry /= change;
    }
    return solution(columns, search.missing);
  }

  std::vector<TransformLink> links_;
  int threads_;
  const std::function<void()>& progress_;
  ImageCells cells_;
  double spacing_;
  Point3 center_{};
  std::vector<Point3> targets_;
  std::vector<bool> is_found_;
  FieldInverse result_;
};
}  // namespace

FieldInverse invert_field(const Transform& field,
                          std::vector<Point3>& points,
                          int threads,
                          const std::function<void()>& progress) {
  return InverseFinder(field, threads, progress).apply(points);
}

}  // namespace tetwarp
