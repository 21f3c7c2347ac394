/// @file surface_reader.hpp
/// Triangle meshes of files, step by step, exactly as the files have them.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <tetwarp/error.hpp>
#include <tetwarp/io_export.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// True for surfaces by their name (has_surface_extension()) and for a VTKHDF UnstructuredGrid
/// without cells of three dimensions. @throws IoError  as kind_of(); when such a grid is damaged
TETWARP_IO_EXPORT bool is_surface_file(const std::string& path);

/// The triangles of a file and their points at each step: a VTKHDF UnstructuredGrid, or a file of
/// one state, .stl, .ply, .obj, .vtp, .vtu or .vtk, or Gmsh's .msh. Unlike read_surface() it keeps
/// triangles that are there twice and points of no triangle: a proof must see them, and numbers of
/// triangles are those of the file.
class TETWARP_IO_EXPORT SurfaceReader {
 public:
  /// @throws IoError  the file is missing, damaged or of another format, has no triangle, or a
  ///                  motion that is not read: of VTK's formats, steps or an array `displacement`
  explicit SurfaceReader(const std::string& path);
  SurfaceReader(SurfaceReader&&) noexcept;
  ~SurfaceReader();

  const std::string& path() const;
  /// 1 for files without steps.
  std::int64_t step_count() const;
  /// Indices of points, those of step 0.
  const std::vector<std::array<std::int32_t, 3>>& triangles() const;

  /// Positions of all points of the file at a step, with its array `displacement`, if it has one
  /// [world].
  /// @throws IoError  there is no such step, a position is not finite, or the step has other
  ///                  triangles than step 0
  std::vector<Point3> points(std::int64_t step) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tetwarp
