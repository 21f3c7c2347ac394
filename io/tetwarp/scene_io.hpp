/// @file scene_io.hpp
/// Scene files: JSON that describes bodies, what couples, pulls and loads them, and the time to
/// simulate. docs/scenes.md explains all keys. Surfaces of bodies as files of triangles.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/error.hpp>
#include <tetwarp/io_export.hpp>
#include <tetwarp/mesh_array.hpp>
#include <tetwarp/scene.hpp>

namespace tetwarp {

/// Reads a scene file with the volumes and meshes that it names, and checks it by check_scene().
/// Names of files are relative to the folder of the scene file.
/// @throws IoError  in one line: the file, the key ("bodies[2].lattice.cells", also in dataset()),
///         the problem and the remedy; also for files that the scene names
/// @param files  out, may be null: the files that the scene names
TETWARP_IO_EXPORT Scene read_scene(const std::string& file,
                                   std::vector<std::string>* files = nullptr);

/// The same for a text.
/// @param name    in messages in place of the file
/// @param folder  that names of files in the text are relative to; empty: the current folder
TETWARP_IO_EXPORT Scene parse_scene(const std::string& text,
                                    const std::string& name,
                                    const std::string& folder = {},
                                    std::vector<std::string>* files = nullptr);

/// Names of the scenes that ship with the library.
TETWARP_IO_EXPORT std::vector<std::string> scene_names();

/// The text of a scene that ships with the library, for parse_scene(). It names no files.
/// @throws std::invalid_argument  there is no such scene; the text lists the names
TETWARP_IO_EXPORT std::string scene_text(const std::string& name);

/// Reads triangles: a VTKHDF UnstructuredGrid of triangles at its first step, or the triangles of a
/// file that import_mesh() reads, whose other cells of fewer than three dimensions are left out.
/// Points that no triangle has are left out, and triangles that are there twice: with the same
/// places of their points in the same orientation. Files whose names has_surface_extension() knows
/// are read, too.
/// @param left_out  out, may be null: other content of the file, by kind and name
/// @param merged    out, may be null: how many triangles are there twice, as a text; empty: none
TETWARP_IO_EXPORT Surface read_surface(const std::string& path,
                                       std::vector<std::string>* left_out = nullptr,
                                       std::string* merged = nullptr);

/// Writes triangles as a VTKHDF UnstructuredGrid without steps, which read_surface() reads.
/// @param arrays  of points and cells; see MeshArray
TETWARP_IO_EXPORT void write_surface(const std::string& path,
                                     const Surface& surface,
                                     const std::vector<MeshArray>& arrays = {});

}  // namespace tetwarp
