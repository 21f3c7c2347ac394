/// @file simulation_series.hpp
/// Numbers of every step of a simulation in one HDF5 file.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// A dataset with one row per step.
struct SeriesColumn {
  std::string path;         ///< inside the file, "energy/kinetic"
  int components = 1;       ///< 1: the dataset has one axis
  bool is_integer = false;  ///< int64; false: float64
};

/// Writes columns row by row. The file has its name from the beginning; rows are kept in memory
/// and written by flush(), after which the file is complete.
class TETWARP_IO_EXPORT SeriesWriter {
 public:
  /// Creates the file; one of that name is replaced. @param first_step  of the first row, stored as
  /// the attribute `first_step`
  SeriesWriter(const std::string& path,
               const std::vector<SeriesColumn>& columns,
               std::int64_t first_step);
  /// Opens a file with these columns, to append behind the row of `step`, and changes nothing yet:
  /// drop_later() must be called before append(). Throws IoError when it has no such row or other
  /// columns.
  static SeriesWriter reopen(const std::string& path,
                             const std::vector<SeriesColumn>& columns,
                             std::int64_t step);
  SeriesWriter(SeriesWriter&&) noexcept;
  ~SeriesWriter();  ///< flushes without errors

  /// Removes the rows behind the one that was named.
  void drop_later();

  /// The step of the first row.
  std::int64_t first_step() const;

  /// Appends a row. @param values  of all columns, one behind the other; whole numbers in integer
  /// columns
  void append(std::span<const double> values);

  /// Writes the rows that are kept. Throws IoError.
  void flush();

 private:
  struct State;
  explicit SeriesWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace tetwarp
