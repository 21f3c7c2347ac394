/// @file h5_rows.cpp
/// Datasets with an unlimited first axis, flushed so that readers see whole rows.
#include "io/h5/h5_rows.hpp"

#include <array>
#include <filesystem>
#include <tetwarp/error.hpp>

#include "io/h5/h5_disk.hpp"
#include "io/h5/h5_read.hpp"
#include "io/h5/h5_write.hpp"

namespace tetwarp::h5 {

GrowingDataset GrowingDataset::create(const Object& parent,
                                      const std::string& name,
                                      hid_t file_type,
                                      hsize_t width,
                                      hsize_t chunk_rows) {
  const int rank = width == 0 ? 1 : 2;
  const std::array<hsize_t, 2> dims{0, width}, limits{H5S_UNLIMITED, width};
  const std::array<hsize_t, 2> chunk{chunk_rows, width};
  const Handle space(H5Screate_simple(rank, dims.data(), limits.data()), H5Sclose);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(properties.id(), rank, chunk.data());
  GrowingDataset grown;
  grown.dataset_ = create_dataset(parent, name, file_type, space.id(), properties.id());
  grown.width_ = width;
  return grown;
}

GrowingDataset GrowingDataset::open(const Object& parent, const std::string& name, hsize_t width) {
  Dataset dataset = open_dataset(parent, name);
  const bool has_width =
      width == 0 ? dataset.dims.size() == 1
                 : dataset.dims.size() == 2 && dataset.dims[1] == static_cast<std::int64_t>(width);
  if (!has_width) dataset.fail("has another shape than this run writes; use another folder");
  GrowingDataset grown;
  grown.rows_ = static_cast<hsize_t>(dataset.rows());
  grown.dataset_ = std::move(static_cast<Object&>(dataset));
  grown.width_ = width;
  return grown;
}

void GrowingDataset::set_extent(hsize_t rows) {
  const std::array<hsize_t, 2> dims{rows, width_};
  if (H5Dset_extent(dataset_.id(), dims.data()) < 0) {
    dataset_.fail_with_reason("cannot be resized");
  }
  rows_ = rows;
}

void GrowingDataset::append(hid_t memory_type, hsize_t count, const void* values) {
  if (count == 0) return;
  const int rank = width_ == 0 ? 1 : 2;
  const std::array<hsize_t, 2> start{rows_, 0}, size{count, width_};
  set_extent(rows_ + count);
  const Handle space(H5Dget_space(dataset_.id()), H5Sclose);
  const Handle memory(H5Screate_simple(rank, size.data(), nullptr), H5Sclose);
  if (H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr) <
          0 ||
      H5Dwrite(dataset_.id(), memory_type, memory.id(), space.id(), H5P_DEFAULT, values) < 0) {
    dataset_.fail_with_reason("cannot be written");
  }
}

void GrowingDataset::truncate(hsize_t rows) {
  if (rows < rows_) set_extent(rows);
}

void flush(const Object& file) {
  if (H5Fflush(file.id(), H5F_SCOPE_LOCAL) < 0) file.fail_with_reason("cannot be written");
}

void close_written(Object& file, const Disk& disk) {
  if (!file.handle.close()) file.fail_with_reason("cannot be written");
  disk.check(file);
}

Object create_growing_file(const std::string& path, Disk& disk) {
  std::error_code error;
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error)) {
    throw IoError(path, "", "exists and is not a plain file; choose another folder");
  }
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder, error);  // else creating fails
  return create_file(path, path, disk);
}

Object open_growing_file(const std::string& path, Disk& disk) {
  static_cast<void>(open_file(path));  // names what is wrong with a file that is missing or damaged
  return reopen_growing_file(path, disk);
}

Object reopen_growing_file(const std::string& path, Disk& disk) {
  Object file{path, "", {}};
  const Handle access = disk_access(&disk);
  file.handle = Handle(H5Fopen(path.c_str(), H5F_ACC_RDWR, access.id()), H5Fclose);
  if (!file.handle) file.fail_with_reason("cannot be opened for writing");
  return file;
}

}  // namespace tetwarp::h5
