/// @file simulate_series.hpp
/// The columns of series.h5, filled from the records of steps.
#pragma once
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "io/vtkhdf/simulation_series.hpp"

namespace tetwarp::cli {

/// Mean and largest value of a column; of vectors those of their length.
struct SeriesSummary {
  std::string name;
  double sum = 0;
  double max = -std::numeric_limits<double>::infinity();
};

/// Turns records into rows.
class StepSeries {
 public:
  explicit StepSeries(const Scene& scene);

  const std::vector<SeriesColumn>& columns() const { return columns_; }

  /// The row of a record, which also enters the summaries; valid until the next call.
  const std::vector<double>& row_of(const StepRecord& record);

  std::size_t row_count() const { return row_count_; }
  /// Of all columns that are not positions, rotations or time.
  std::vector<SeriesSummary> summaries() const { return summaries_; }

 private:
  /// Appends the numbers of a column.
  using Fill = std::function<void(const StepRecord&, std::vector<double>&)>;

  void add(const std::string& path, int components, bool is_integer, Fill fill);
  void add_number(const std::string& path, std::function<double(const StepRecord&)> value);
  void add_count(const std::string& path, std::function<std::int64_t(const StepRecord&)> value);
  void add_vector(const std::string& path, std::function<Point3(const StepRecord&)> value);
  void add_totals();
  void add_seconds();
  void add_body(const Body& body, std::size_t index);

  std::vector<SeriesColumn> columns_;
  std::vector<Fill> fills_;
  std::vector<SeriesSummary> summaries_;  ///< one per column that has one
  std::vector<int> summary_of_;           ///< of each column, -1: none
  std::vector<double> row_;
  std::size_t row_count_ = 0;
};

}  // namespace tetwarp::cli
