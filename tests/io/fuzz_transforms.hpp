/// @file fuzz_transforms.hpp
/// Files of transforms for fuzz_io.
#pragma once
#include <hdf5.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/io_files.hpp"

namespace tetwarp::test {

inline std::string repeated(const std::string& word, int count) {
  std::string text;
  for (int n = 0; n < count; ++n) text += word;
  return text;
}

/// A composite of a displacement field and an affine transform, as ITK's HDF5 writer lays it out.
inline void write_itk_seed(const std::string& path) {
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t group = H5Gcreate2(file, "TransformGroup", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const auto write = [](hid_t parent, const char* name, hid_t type, hsize_t count,
                        const void* data) {
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    const hid_t set = H5Dcreate2(parent, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data);
    H5Dclose(set);
    H5Sclose(space);
  };
  const hid_t text = H5Tcopy(H5T_C_S1);
  H5Tset_size(text, H5T_VARIABLE);
  const std::vector<double> field(24, 0.5), affine{1, 0, 0, 0, 1, 0, 0, 0, 1, 2, 3, 4};
  const std::vector<double> grid{2, 2, 2, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::vector<double> center{0, 0, 0};
  const char* const types[] = {"CompositeTransform_double_3_3",
                               "DisplacementFieldTransform_double_3_3",
                               "AffineTransform_double_3_3"};
  for (int n = 0; n < 3; ++n) {
    const hid_t one =
        H5Gcreate2(group, std::to_string(n).c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    write(one, "TransformType", text, 1, &types[n]);
    const std::vector<double>& parameters = n == 1 ? field : affine;
    const std::vector<double>& fixed = n == 1 ? grid : center;
    if (n > 0) {
      write(one, "TransformParameters", H5T_NATIVE_DOUBLE, parameters.size(), parameters.data());
      write(one, "TransformFixedParameters", H5T_NATIVE_DOUBLE, fixed.size(), fixed.data());
    }
    H5Gclose(one);
  }
  H5Tclose(text);
  H5Gclose(group);
  H5Fclose(file);
}

inline void write_transform_seeds(const ScratchFolder& folder) {
  const auto write = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder / name, std::ios::binary) << text;
  };
  write("t.tfm",
        "#Insight Transform File V1.0\nTransform: Euler3DTransform_double_3_3\n"
        "Parameters: 0 0 0.2 5 0 0\nFixedParameters: 0 0 0 0\n");
  write("b.tfm",
        "#Insight Transform File V1.0\nTransform: CompositeTransform_double_3_3\n"
        "Transform: BSplineTransform_double_3_3\nParameters:" +
            repeated(" 0.5", 192) +
            "\nFixedParameters: 4 4 4 0 0 0 1 1 1 1 0 0 0 1 0 0 0 1\n"
            "Transform: DisplacementFieldTransform_double_3_3\nParameters:" +
            repeated(" 1", 24) + "\nFixedParameters: 2 2 2 0 0 0 1 1 1 1 0 0 0 1 0 0 0 1\n");
  write_itk_seed(folder / "itk");
  std::string matlab;
  for (const auto& [variable, count] :
       {std::pair("AffineTransform_double_3_3", 12), {"fixed", 3}}) {
    const std::int32_t head[5] = {0, count, 1, 0,
                                  static_cast<std::int32_t>(std::strlen(variable)) + 1};
    matlab.append(reinterpret_cast<const char*>(head), sizeof head);
    matlab.append(variable, std::strlen(variable) + 1)
        .append(static_cast<std::size_t>(8 * count), '\0');
  }
  write("t.mat", matlab);
}

}  // namespace tetwarp::test
