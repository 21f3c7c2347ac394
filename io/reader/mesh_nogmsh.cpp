/// @file mesh_nogmsh.cpp
/// In place of mesh_gmsh.cpp where Gmsh was missing when this was built.
#include <tetwarp/missing_library.hpp>

#include "io/reader/mesh_readers.hpp"

namespace tetwarp {

ImportedMesh read_gmsh_mesh(const std::string& path, const MeshImportOptions&) {
  throw MissingLibrary(path, "Gmsh",
                       "this build cannot read Gmsh's meshes; install libgmsh-dev and build "
                       "again, or convert to VTKHDF of type UnstructuredGrid");
}

}  // namespace tetwarp
