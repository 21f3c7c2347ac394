/// @file vtk_file_list.hpp
/// Series of files: ParaView's lists .pvd and .series, and numbered files.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace tetwarp {

/// A step of a series.
struct VtkListStep {
  std::optional<double> time;
  std::vector<std::string> files;  ///< its parts
};

/// The steps that a .pvd or a .series lists, in order of their times.
/// @throws IoError when it lists none, or is damaged
std::vector<VtkListStep> read_pvd(const std::string& path);
std::vector<VtkListStep> read_series(const std::string& path);

}  // namespace tetwarp
