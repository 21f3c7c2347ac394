/// @file mesh_sender.hpp
/// What tetwarp-read does around the reading: it limits itself, and sends the mesh or the error.
#pragma once
#include <functional>
#include <string>

#include <tetwarp/mesh_import.hpp>

namespace tetwarp {

/// Reads the mesh that the arguments PATH MEMORY solids|triangles [DISPLACEMENT] tell, as
/// read_mesh_in_child() gives them, and sends it to the standard output, where nothing else
/// arrives. Limits the memory, leaves no core file, and is killed with the thread that started it.
/// @returns the exit code
int send_mesh(
    int argc,
    char** argv,
    const std::function<ImportedMesh(const std::string&, const MeshImportOptions&)>& read);

}  // namespace tetwarp
