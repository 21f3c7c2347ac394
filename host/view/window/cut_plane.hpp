/// @file cut_plane.hpp
/// CutPlane: hides what is before a plane.
#pragma once
#include <optional>

#include <vtkNew.h>
#include <vtkPlane.h>
#include <vtkRenderer.h>

#include "host/view/pick.hpp"

namespace tetwarp::view {

class CutPlane {
 public:
  /// Cuts everything that a renderer has now; nothing: no longer.
  void set(const std::optional<Cut>& cut, vtkRenderer* renderer);

 private:
  vtkNew<vtkPlane> plane_;
};

}  // namespace tetwarp::view
