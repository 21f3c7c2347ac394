/// @file backend_choice.hpp
/// Which back end a warp of known size takes for Backend::automatic: cpu where that does the whole
/// work before a device has started.
#pragma once
#include <string>
#include <utility>

#include <tetwarp/backend.hpp>
#include <tetwarp/export.hpp>
#include <tetwarp/warp.hpp>

namespace tetwarp {

/// Estimated time of a warp on the threads of the options, if the mesh covers all
/// voxels [s]. Right within a factor of three: voxels outside cost less, steep maps and tetrahedra
/// of less than 30 voxels more.
/// @param samples  output voxels times components, of all outputs and steps
TETWARP_EXPORT double estimated_cpu_seconds(const WarpOptions& options,
                                            double samples,
                                            bool has_hexahedra,
                                            bool has_ten_nodes = false);

/// As choose_backend() for the options, but `automatic` takes cpu where the whole work takes that
/// less than a device takes to start.
/// @param cpu_seconds  of the whole work
TETWARP_EXPORT std::pair<Backend, std::string> choose_backend_for(double cpu_seconds,
                                                                  const WarpOptions& options);

}  // namespace tetwarp
