/// @file h5_rows.hpp
/// Datasets that grow by rows while a program runs.
#pragma once
#include <cstdint>
#include <string>

#include "io/h5/h5.hpp"

namespace tetwarp::h5 {

/// Rows of datasets with one row per step that are stored together.
inline constexpr hsize_t step_chunk = 256;

struct Disk;

/// A chunked dataset [row] or [row][width] whose rows are appended.
class GrowingDataset {
 public:
  /// Creates it without rows.
  /// @param width       numbers per row; 0: one number, and the dataset has one axis
  /// @param chunk_rows  rows that are stored together, > 0
  static GrowingDataset create(const Object& parent,
                               const std::string& name,
                               hid_t file_type,
                               hsize_t width,
                               hsize_t chunk_rows);

  /// Opens one that create() made. Throws IoError when its width is another.
  static GrowingDataset open(const Object& parent, const std::string& name, hsize_t width);

  hsize_t rows() const { return rows_; }

  /// Writes rows behind the last one.
  void append(hid_t memory_type, hsize_t count, const void* values);

  /// Removes all rows from `rows` on. @pre rows <= rows()
  void truncate(hsize_t rows);

 private:
  void set_extent(hsize_t rows);

  Object dataset_;
  hsize_t width_ = 0;
  hsize_t rows_ = 0;
};

/// Writes what is buffered, so that the file can be read as it is now.
void flush(const Object& file);

/// Closes a file, of which nothing else may be open. Throws IoError if a write has failed.
void close_written(Object& file, const Disk& disk);

/// Creates a file that has its name from the beginning, for output that is read while it grows.
/// @param disk  as of create_file()
Object create_growing_file(const std::string& path, Disk& disk);

/// Opens such a file to append to it. Throws IoError when it is missing or damaged.
Object open_growing_file(const std::string& path, Disk& disk);

/// Opens one again that this program has written.
Object reopen_growing_file(const std::string& path, Disk& disk);

}  // namespace tetwarp::h5
