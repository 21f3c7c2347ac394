/// @file nifti_write.hpp
/// Writing NIfTI files.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

#include "io/files/volume_sink.hpp"

namespace tetwarp {

/// Throws what make_nifti_sink() throws about its arguments, and writes nothing.
void check_nifti(const std::string& path, const Grid& grid, const std::vector<ArrayHeader>& arrays);

/// A NIfTI file of one array.
std::unique_ptr<VolumeSink> make_nifti_sink(const std::string& path,
                                            const Grid& grid,
                                            const std::vector<ArrayHeader>& arrays,
                                            const VolumeWriteOptions& options,
                                            bool is_temporal);

}  // namespace tetwarp
