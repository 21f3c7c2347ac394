/// @file value_legend.hpp
/// ValueLegend: which color stands for which value.
#pragma once
#include <vtkLookupTable.h>
#include <vtkNew.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>

#include "host/view/look/value_colors.hpp"

namespace tetwarp::view {

/// A bar at the right edge of the window.
class ValueLegend {
 public:
  explicit ValueLegend(vtkRenderer* renderer);

  /// Of none: hides it.
  void show(SurfaceQuantity quantity, const ValueRange& range);

 private:
  vtkNew<vtkLookupTable> colors_;
  vtkNew<vtkScalarBarActor> bar_;
};

}  // namespace tetwarp::view
