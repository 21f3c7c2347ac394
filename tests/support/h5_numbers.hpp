/// @file h5_numbers.hpp
/// Numbers of HDF5 files for tests.
#pragma once
#include <hdf5.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace tetwarp::test {

/// All numbers of a dataset in the order of the file.
inline std::vector<double> h5_numbers(const std::string& path, const std::string& dataset) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t data = file < 0 ? -1 : H5Dopen2(file, dataset.c_str(), H5P_DEFAULT);
  if (data < 0) throw std::runtime_error(path + " has no " + dataset);
  const hid_t space = H5Dget_space(data);
  std::vector<double> numbers(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  if (!numbers.empty()) {
    H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data());
  }
  H5Sclose(space);
  H5Dclose(data);
  H5Fclose(file);
  return numbers;
}

}  // namespace tetwarp::test
