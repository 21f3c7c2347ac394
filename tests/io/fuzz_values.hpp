/// @file fuzz_values.hpp
/// Changes values, shapes and types inside an HDF5 file that stays valid HDF5.
#pragma once
#include <hdf5.h>

#include <array>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace tetwarp::test {

/// Seeded numbers, the same on every machine.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t index) : engine_(seed * 0x9E3779B97F4A7C15U + index) {}

  /// From 0 to limit - 1.
  std::size_t below(std::size_t limit) { return static_cast<std::size_t>(engine_() % limit); }

 private:
  std::mt19937_64 engine_;
};

/// A number that is likely to break a reader: negative, huge, not finite.
inline double odd_number(Random& random) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr std::array numbers = {0.0,
                                  1.0,
                                  -1.0,
                                  2.0,
                                  3.0,
                                  4.0,
                                  5.0,
                                  -5.0,
                                  255.0,
                                  32768.,
                                  0x1p31,
                                  -0x1p31,
                                  0x1p32,
                                  0x1p40,
                                  0x1p62,
                                  0x1p63,
                                  -0x1p63,
                                  1e300,
                                  infinity,
                                  0.5,
                                  -infinity,
                                  1e-300,
                                  std::numeric_limits<double>::quiet_NaN()};
  return numbers[random.below(numbers.size())];
}

/// Paths of all groups and datasets in a file.
inline std::vector<std::string> object_names(hid_t file) {
  std::vector<std::string> names;
  const auto append = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  H5Lvisit(file, H5_INDEX_NAME, H5_ITER_INC, append, &names);
  return names;
}

/// Overwrites one value of a dataset of numbers.
inline void change_element(hid_t dataset, Random& random) {
  const hid_t space = H5Dget_space(dataset);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  const bool is_small = count > 0 && count < 10'000;
  std::vector<double> values(is_small ? static_cast<std::size_t>(count) : 0);
  if (is_small &&
      H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0) {
    values[random.below(values.size())] = odd_number(random);
    H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  }
  H5Sclose(space);
}

/// Replaces a dataset by one of another shape and type, chunked and empty.
inline void change_shape(hid_t file, const std::string& name, Random& random) {
  const std::array<hid_t, 5> types = {H5T_NATIVE_INT8, H5T_STD_I64BE, H5T_IEEE_F32LE, H5T_C_S1,
                                      H5T_NATIVE_LDOUBLE};
  std::vector<hsize_t> dims(random.below(6));
  for (hsize_t& dim : dims) dim = random.below(8) == 0 ? hsize_t{1} << 50 : random.below(9);
  const std::vector<hsize_t> chunk(dims.size(), 1);
  const int rank = static_cast<int>(dims.size());
  const hid_t space =
      rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, dims.data(), nullptr);
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  if (rank > 0) H5Pset_chunk(properties, rank, chunk.data());
  H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  const hid_t dataset = H5Dcreate2(file, name.c_str(), types[random.below(types.size())], space,
                                   H5P_DEFAULT, properties, H5P_DEFAULT);
  if (dataset >= 0) H5Dclose(dataset);
  H5Pclose(properties);
  H5Sclose(space);
}

/// Overwrites one number of an attribute, or all of a text, or removes the attribute.
inline void change_attribute(hid_t object, Random& random) {
  const int count = H5Aget_num_attrs(object);
  if (count <= 0) return;
  const hsize_t index = random.below(static_cast<std::size_t>(count));
  const hid_t attribute =
      H5Aopen_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, index, H5P_DEFAULT, H5P_DEFAULT);
  if (attribute < 0) return;
  const hid_t space = H5Aget_space(attribute);
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)), 0.0);
  const bool is_number = H5Aread(attribute, H5T_NATIVE_DOUBLE, values.data()) >= 0;
  if (is_number && !values.empty() && random.below(4) != 0) {
    values[random.below(values.size())] = odd_number(random);
    H5Awrite(attribute, H5T_NATIVE_DOUBLE, values.data());
  }
  H5Sclose(space);
  H5Aclose(attribute);
  if (!is_number || random.below(8) == 0) {
    H5Adelete_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, index, H5P_DEFAULT);
  }
}

/// One to three changes to the datasets and attributes of a file.
inline void damage_values(const std::string& path, Random& random) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  for (std::size_t changes = 1 + random.below(3); changes > 0; --changes) {
    const std::vector<std::string> names = object_names(file);
    const std::string& name = names[random.below(names.size())];
    const hid_t object = H5Oopen(file, name.c_str(), H5P_DEFAULT);
    if (object < 0) continue;
    if (H5Iget_type(object) != H5I_DATASET || random.below(6) == 0) {
      change_attribute(object, random);
    } else if (random.below(3) != 0) {
      change_element(object, random);
    } else {
      change_shape(file, name, random);
    }
    H5Oclose(object);
  }
  H5Fclose(file);
}

}  // namespace tetwarp::test
