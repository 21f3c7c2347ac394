/// @file mesh_sender.hpp
/// What tetwarp-read does around the reading: it limits itself, and sends the result or the error.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include <tetwarp/mesh_import.hpp>

#include "io/child/foreign_image.hpp"
#include "io/reader/mesh_readers.hpp"

namespace tetwarp {

/// What the program does, each by the library of the file's format.
struct ReaderCalls {
  std::function<ImportedMesh(const std::string& path, const MeshImportOptions& options)> mesh;
  std::function<std::vector<Point3>(const std::string& path)> points = {};
  /// As of place_points_in_child().
  std::function<void(
      const std::string& path, const std::string& numbers, const std::string& output)>
      place = {};
  /// As of image_readers.hpp.
  std::function<ForeignImage(const std::string& path, const std::string& series)> image = {};
  std::function<void(const std::string& path,
                     const std::string& array,
                     const std::string& series,
                     const TakeImage& take_image,
                     const TakeSlice& take)>
      samples = {};
  /// Gives a surface of fewer triangles, see coarse_surface().
  std::function<CoarseMesh(const std::string& path, double distance)> coarsen = {};
};

/// Does what the arguments tell, and sends the result to the standard output, where nothing else
/// arrives: PATH MEMORY solids|triangles [DISPLACEMENT], PATH MEMORY points,
/// PATH MEMORY place NUMBERS OUTPUT, PATH MEMORY coarsen DISTANCE, PATH MEMORY image SERIES, or
/// PATH MEMORY samples ARRAY SERIES, as the functions of mesh_child.hpp and foreign_image.hpp give
/// them. Limits the memory, leaves no core file, and is killed with the thread that started it.
/// @returns the exit code
int send_result(int argc, char** argv, const ReaderCalls& calls);

}  // namespace tetwarp
