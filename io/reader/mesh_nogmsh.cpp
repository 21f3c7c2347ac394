/// @file mesh_nogmsh.cpp
/// In place of mesh_gmsh.cpp where Gmsh was missing when this was built.
#include <tetwarp/error.hpp>

#include "io/reader/mesh_readers.hpp"

namespace tetwarp {

ImportedMesh read_gmsh_mesh(const std::string& path, const MeshImportOptions&) {
  throw IoError(path, "",
                "this build cannot read Gmsh's meshes; install libgmsh-dev and build again, or "
                "convert to VTKHDF of type UnstructuredGrid");
}

}  // namespace tetwarp
