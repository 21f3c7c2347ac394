/// @file image_write.hpp
/// Writing NRRD files and MetaImages.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include <tetwarp/io.hpp>

#include "io/files/volume_sink.hpp"

namespace tetwarp {

/// Throws what make_image_sink() throws about its arguments, and writes nothing.
void check_image(const std::string& path,
                 const Grid& grid,
                 const std::vector<ArrayHeader>& arrays,
                 const VolumeWriteOptions& options);

/// A file of one array without steps, packed where options.compress is above 0.
/// @throws IoError  on several arrays, and when the file cannot be created
std::unique_ptr<VolumeSink> make_image_sink(const std::string& path,
                                            const Grid& grid,
                                            const std::vector<ArrayHeader>& arrays,
                                            const VolumeWriteOptions& options,
                                            bool is_temporal);

}  // namespace tetwarp
