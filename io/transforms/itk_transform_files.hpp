/// @file itk_transform_files.hpp
/// Files of transforms by type and parameters, as ITK and ANTs write them.
#pragma once
#include <string>
#include <vector>

#include "io/transforms/itk_transform.hpp"

namespace tetwarp {

/// The transforms of a text file (.tfm, .txt), in its order.
/// @throws IoError  when it is none, or damaged
std::vector<ItkTransform> read_itk_text(const std::string& path);

/// The transforms of a MATLAB file (.mat).
/// @throws IoError  as above
std::vector<ItkTransform> read_itk_matlab(const std::string& path);

/// Whether a file is HDF5 and holds transforms of ITK.
bool is_itk_hdf5(const std::string& path);

/// The transforms of such a file, in its order; parameters of fields stay there.
/// @throws IoError  when it is damaged
std::vector<ItkTransform> read_itk_hdf5(const std::string& path);

}  // namespace tetwarp
