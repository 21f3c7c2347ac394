/// @file series_reader.hpp
/// Reads the numbers of every step that a simulation has written.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// An open series.h5. The run that writes it may go on; rows that it adds later are not read.
class TETWARP_IO_EXPORT SeriesReader {
 public:
  /// @throws IoError  the file is missing, damaged, or no series of a simulation
  explicit SeriesReader(const std::string& path);
  SeriesReader(SeriesReader&&) noexcept;
  ~SeriesReader();

  /// The step of the first row.
  std::int64_t first_step() const;

  /// The datasets that a name stands for, as paths in the file: of a dataset itself, of a group
  /// those that lie directly in it, sorted.
  /// @throws IoError  there is none; the text lists the names
  std::vector<std::string> paths_of(const std::string& name) const;

  /// One number per step, in the dataset's unit: of vectors their length.
  /// @throws IoError  the dataset is missing, has other rows than steps, or exceeds the memory
  std::vector<double> read(const std::string& path) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tetwarp
