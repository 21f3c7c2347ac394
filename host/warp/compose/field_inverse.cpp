/// @file field_inverse.cpp
/// Damped Newton steps of many points at once, from the points and from cells that may be taken to
/// them.
#include "host/warp/compose/field_inverse.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <thread>
#include <utility>
#include <variant>

#include "host/base/parallel.hpp"
#include "host/base/point3.hpp"
#include "host/warp/compose/image_cells.hpp"
#include "host/warp/compose/position_bins.hpp"

namespace tetwarp {
namespace {
constexpr int most_steps = 50;
constexpr int most_halvings = 10;
constexpr std::size_t most_searches = 1 << 14;  ///< of a thread at once, about 400 bytes each

/// A point on its way to an x.
struct Search {
  std::size_t point = 0;  ///< whose inverse it is
  Point3 target{}, x{};
  Point3 missing{};  ///< target - x - u(x)
};

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

const Grid& field_grid(const Transform& field) {
  if (const auto* const spline = std::get_if<BSplineTransform>(&field)) return spline->grid;
  return std::get<DisplacementField>(field).grid;
}

/// The inverse at some points, which depends on these alone.
class PointsInverse {
 public:
  /// @param field, progress  kept by the caller
  /// @param targets          the points
  PointsInverse(const Transform& field,
                std::vector<Point3> targets,
                const std::function<void()>& progress)
      : field_(field),
        grid_(field_grid(field)),
        progress_(progress),
        spacing_(std::ranges::min(grid_.spacing)),
        targets_(std::move(targets)),
        found_(targets_.size()) {
    Point3 last{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      last[axis] = 0.5 * static_cast<double>(grid_.dims[axis] - 1);
    }
    center_ = grid_.world_of(last);
  }

  /// Begins at the targets.
  void search_near() {
    for (std::size_t p = 0; p < targets_.size(); ++p) begin({p, targets_[p], targets_[p], {}});
    run();
  }

  /// Begins in each cell that may be taken to a target: at its center, then at 3 x 3 x 3 positions.
  void search_cells(const ImageCells& cells) {
    const PositionBins bins(targets_, 2 * spacing_);
    for (const int starts : {1, 3}) {
      if (starts > 1 && std::ranges::all_of(found_, &std::optional<Point3>::has_value)) return;
      cells.for_each_near(
          widened(bins.bounds()), [&](const Point3& low, const Point3& high, const Bounds& image) {
            bins.for_each_in(widened(image), [&](std::size_t p) {
              for (int n = 0; n < starts * starts * starts && !found_[p]; ++n) {
                const std::array<int, 3> part{n % starts, n / starts % starts, n / starts / starts};
                Point3 index{};
                for (std::size_t axis = 0; axis < 3; ++axis) {
                  index[axis] = low[axis] + (high[axis] - low[axis]) * (part[axis] + 0.5) / starts;
                }
                begin({p, targets_[p], grid_.world_of(index), {}});
              }
            });
          });
      run();
    }
  }

  /// The x of each point; none where no search has found one.
  const std::vector<std::optional<Point3>>& found() const { return found_; }
  double largest_residual() const { return largest_residual_; }

 private:
  double tolerance() const { return 1e-6 * spacing_; }

  Bounds widened(Bounds box) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.low[axis] -= tolerance();
      box.high[axis] += tolerance();
    }
    return box;
  }

  /// Adds a search, and runs all where they are many.
  void begin(const Search& search) {
    searches_.push_back(search);
    if (searches_.size() == most_searches) run();
  }

  /// Makes Newton steps. A search ends when its residual is small enough, or a step does not reduce
  /// it.
  void run() {
    evaluate(searches_);
    for (int n = 0; !searches_.empty(); ++n) {
      progress_();
      keep_found();
      if (n == most_steps) searches_.clear();
      make_step();
    }
  }

  void evaluate(std::vector<Search>& searches) const {
    std::vector<Point3> there(searches.size());
    for (std::size_t s = 0; s < searches.size(); ++s) there[s] = searches[s].x;
    there = transformed(field_, std::move(there));
    for (std::size_t s = 0; s < searches.size(); ++s) {
      searches[s].missing = minus(searches[s].target, there[s]);
    }
  }

  void keep_found() {
    std::erase_if(searches_, [&](const Search& search) {
      if (found_[search.point]) return true;
      const double residual = norm(search.missing);
      if (!(residual <= tolerance())) return false;
      found_[search.point] = search.x;
      largest_residual_ = std::max(largest_residual_, residual);
      return true;
    });
  }

  /// Makes one step of all searches. Those whose residual it does not reduce end.
  void make_step() {
    std::vector<Point3> left_steps = newton_steps();
    std::vector<Search> nearer, left = std::move(searches_);
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
    searches_ = std::move(nearer);
  }

  /// By differences of the map, taken towards the center of the grid, beyond whose rim it jumps.
  std::vector<Point3> newton_steps() const {
    const double distance = 1e-4 * spacing_;
    std::vector<Point3> moved;
    for (const Search& search : searches_) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        Point3 x = search.x;
        x[axis] += x[axis] > center_[axis] ? -distance : distance;
        moved.push_back(x);
      }
    }
    const std::vector<Point3> there = transformed(field_, moved);
    std::vector<Point3> steps;
    for (std::size_t s = 0; s < searches_.size(); ++s) {
      const Point3 here = minus(searches_[s].target, searches_[s].missing);
      std::array<Point3, 3> columns;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double change = moved[3 * s + axis][axis] - searches_[s].x[axis];
        columns[axis] = minus(there[3 * s + axis], here);
        for (double& entry : columns[axis]) entry /= change;
      }
      steps.push_back(solution(columns, searches_[s].missing));
    }
    return steps;
  }

  const Transform& field_;
  const Grid& grid_;
  const std::function<void()>& progress_;
  double spacing_;
  Point3 center_{};
  std::vector<Point3> targets_;
  std::vector<std::optional<Point3>> found_;
  double largest_residual_ = 0;
  std::vector<Search> searches_;
};

/// Searches for the x of points, a task for every few thousand of them, so that what is found does
/// not depend on the number of threads.
class Searches {
 public:
  Searches(const Transform& field,
           std::vector<Point3>& points,
           int threads,
           const std::function<void()>& progress)
      : field_(field), points_(points), threads_(threads), progress_(progress) {
    for (std::size_t p = 0; p < points.size(); ++p) {
      (is_finite(points[p]) ? left_ : not_finite_).push_back(p);
    }
  }

  bool are_done() const { return left_.empty(); }
  InverseResult result() && {
    std::vector<std::size_t> not_found = std::move(left_);
    not_found.insert(not_found.end(), not_finite_.begin(), not_finite_.end());
    std::ranges::sort(not_found);
    return {std::move(not_found), largest_residual_};
  }

  /// Calls search(PointsInverse&) for all points without an x.
  template <class Method>
  void run(const Method& search) {
    constexpr std::int64_t most = 1 << 14;  // points of a task
    const std::int64_t tasks = (std::ssize(left_) + most - 1) / most;
    std::vector<double> residuals(static_cast<std::size_t>(tasks));
    std::vector<std::vector<std::size_t>> left(residuals.size());
    parallel_tasks(threads_, tasks, [&](std::int64_t task) {
      const auto t = static_cast<std::size_t>(task);
      const auto begin = left_.begin() + task * most;
      const auto end = begin + std::min(most, std::ssize(left_) - task * most);
      std::vector<Point3> targets;
      for (auto p = begin; p != end; ++p) targets.push_back(points_[*p]);
      PointsInverse inverse(field_, std::move(targets), progress_);
      search(inverse);
      residuals[t] = inverse.largest_residual();
      for (auto p = begin; p != end; ++p) {
        const std::optional<Point3>& x = inverse.found()[static_cast<std::size_t>(p - begin)];
        if (x) {
          points_[*p] = *x;
        } else {
          left[t].push_back(*p);
        }
      }
    });
    left_.clear();
    for (const auto& of_task : left) left_.insert(left_.end(), of_task.begin(), of_task.end());
    for (const double residual : residuals) {
      largest_residual_ = std::max(largest_residual_, residual);
    }
  }

 private:
  const Transform& field_;
  std::vector<Point3>& points_;  ///< those without an x are targets
  int threads_;
  const std::function<void()>& progress_;
  std::vector<std::size_t> left_, not_finite_;  ///< of points_
  double largest_residual_ = 0;
};
}  // namespace

InverseResult FieldInverse::apply(std::vector<Point3>& points,
                                  int threads,
                                  const std::function<void()>& progress) {
  threads = thread_count(threads);
  const std::thread::id caller = std::this_thread::get_id();
  const std::function<void()> check = [&] {
    if (progress && std::this_thread::get_id() == caller) progress();
  };
  Searches searches(field_, points, threads, check);
  searches.run([](PointsInverse& inverse) { inverse.search_near(); });
  if (!searches.are_done()) {
    if (cells_ == nullptr) cells_ = std::make_unique<const ImageCells>(field_, threads);
    searches.run([&](PointsInverse& inverse) { inverse.search_cells(*cells_); });
  }
  return std::move(searches).result();
}

}  // namespace tetwarp
