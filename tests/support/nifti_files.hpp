/// @file nifti_files.hpp
/// NIfTI files written and read byte by byte, without the code under test.
#pragma once
#include <nifti1.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

namespace tetwarp::test {

/// A header of a float32 image with unit voxels and neither sform nor qform.
inline nifti_1_header float_header(const std::array<short, 3>& dims, short components) {
  nifti_1_header header{};
  header.sizeof_hdr = 348;
  const short all[8] = {5, dims[0], dims[1], dims[2], 1, components, 1, 1};
  std::copy(all, all + 8, header.dim);
  header.datatype = DT_FLOAT32;
  header.bitpix = 32;
  std::fill(header.pixdim, header.pixdim + 8, 1.0F);
  header.vox_offset = 352;
  std::memcpy(header.magic, "n+1", 4);
  return header;
}

/// Writes the header and the samples, one component after the other as NIfTI stores them, each of
/// them the same in every voxel.
inline void write_constant(const std::string& path,
                           const nifti_1_header& header,
                           const std::vector<float>& components) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(&header), sizeof header);
  file.write("\0\0\0\0", 4);
  for (const float component : components) {
    for (int voxel = 0; voxel < header.dim[1] * header.dim[2] * header.dim[3]; ++voxel) {
      file.write(reinterpret_cast<const char*>(&component), sizeof component);
    }
  }
}

inline nifti_1_header header_in(const std::string& path) {
  nifti_1_header header{};
  std::ifstream(path, std::ios::binary).read(reinterpret_cast<char*>(&header), sizeof header);
  return header;
}

/// The components of one voxel of a float32 image, in the order of the file.
inline std::vector<float> components_in(const std::string& path, int voxel) {
  const nifti_1_header header = header_in(path);
  std::ifstream file(path, std::ios::binary);
  std::vector<float> components(static_cast<std::size_t>(header.dim[5]));
  const int voxels = header.dim[1] * header.dim[2] * header.dim[3];
  for (std::size_t c = 0; c < components.size(); ++c) {
    file.seekg(static_cast<int>(header.vox_offset) + 4 * (static_cast<int>(c) * voxels + voxel));
    file.read(reinterpret_cast<char*>(&components[c]), sizeof components[c]);
  }
  return components;
}

}  // namespace tetwarp::test
