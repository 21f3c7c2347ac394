/// @file mesh_novtk.cpp
/// In place of mesh_vtk.cpp where VTK was missing when this was built.
#include <tetwarp/missing_library.hpp>

#include "io/reader/image_readers.hpp"
#include "io/reader/mesh_readers.hpp"

namespace tetwarp {

ImportedMesh read_vtk_mesh(const std::string& path, const MeshImportOptions&) {
  throw MissingLibrary(path, "VTK",
                       "this build cannot read VTK's meshes; install libvtk9-dev and build "
                       "again, or convert to VTKHDF of type UnstructuredGrid");
}

std::vector<Point3> read_vtk_points(const std::string& path) {
  return read_vtk_mesh(path, {}).mesh.rest_positions;
}

void place_vtk_points(const std::string& path, const std::string&, const std::string&) {
  read_vtk_mesh(path, {});
}

ImportedMesh read_vtk_surface(const std::string& path, const MeshImportOptions& options) {
  return read_vtk_mesh(path, options);
}

CoarseMesh coarsen_by_vtk(const std::string& path, double) {
  throw MissingLibrary(path, "VTK",
                       "this build cannot make coarser surfaces; install libvtk9-dev and build "
                       "again, or name a coarser surface by \"mesh\"");
}

ForeignImage read_vtk_image(const std::string& path) {
  throw MissingLibrary(path, "VTK",
                       "this build cannot read .vti; install libvtk9-dev and build again, or "
                       "convert to VTKHDF of type ImageData");
}

void read_vtk_samples(const std::string& path,
                      const std::string&,
                      const TakeImage&,
                      const TakeSlice&) {
  read_vtk_image(path);
}

}  // namespace tetwarp
