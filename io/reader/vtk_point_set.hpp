/// @file vtk_point_set.hpp
/// Files of points and cells that VTK reads.
#pragma once
#include <vtkPointSet.h>
#include <vtkSmartPointer.h>

#include <string>

namespace tetwarp {

/// Reads .stl, .ply, .obj, .vtp, .vtu or .vtk, without joining points.
/// @throws IoError when it holds no point that VTK can read
vtkSmartPointer<vtkPointSet> read_vtk_point_set(const std::string& path);

}  // namespace tetwarp
