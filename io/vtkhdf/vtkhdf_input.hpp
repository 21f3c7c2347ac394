/// @file vtkhdf_input.hpp
/// Shared by readers of VTKHDF volumes and meshes: root group, type, time steps and offsets.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "io/h5/h5.hpp"
#include "io/h5/h5_read.hpp"

namespace tetwarp {

/// An open VTKHDF file.
struct VtkhdfInput {
  h5::Object file;
  h5::Object root;            ///< /VTKHDF
  h5::Object steps;           ///< /VTKHDF/Steps, empty handle when static
  std::vector<double> times;  ///< one per step, empty when static

  bool is_temporal() const { return static_cast<bool>(steps.handle); }

  /// Throws IoError unless the file has this step (0 in static files).
  void check_step(std::int64_t step) const;
};

/// Opens `path`, whose attribute Type must be `type`: "ImageData" or "UnstructuredGrid".
VtkhdfInput open_vtkhdf(const std::string& path, const std::string& type);

/// Reads one integer per step, of shape [step] or [step][1], from `group`/`name`. All are checked
/// to lie in 0 to 2^60; a file without that dataset gives an empty vector.
std::vector<std::int64_t> read_step_offsets(const VtkhdfInput& file,
                                            const h5::Object& group,
                                            const std::string& name);

/// The same from Steps/PointDataOffsets.
std::vector<std::int64_t> read_point_data_offsets(const VtkhdfInput& file,
                                                  const std::string& array);

/// Names in groups of a file, as paths below /VTKHDF: "CellData/material".
/// @param is_read  function of such a path: those for which it is true are left out
template <class IsRead>
std::vector<std::string> paths_in(const VtkhdfInput& file,
                                  const std::vector<std::string>& groups,
                                  const IsRead& is_read) {
  std::vector<std::string> paths;
  for (const std::string& group : groups) {
    if (!h5::is_group(file.root, group)) continue;
    for (const std::string& name : h5::child_names(h5::open_group(file.root, group))) {
      const std::string path = group + "/" + name;
      if (!is_read(path)) paths.push_back(path);
    }
  }
  return paths;
}

/// The array that stands for a volume.
/// @param names    of its arrays, not empty, in the order in which they are stored
/// @param scalars  the active scalars
/// @returns `scalars` if it is one of the names, else the first one that does not begin with
///          `tetwarp_`, else the first one
std::string active_array(const std::vector<std::string>& names, const std::string& scalars);

}  // namespace tetwarp
