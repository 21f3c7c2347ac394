/// @file curve_panel.hpp
/// CurvePanel: the curve of color and opacity of volumes, to be changed by the mouse.
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include <vtkActor2D.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>

#include "host/view/curve_editor.hpp"

namespace tetwarp::view {

/// In the lower right corner of the window: samples to the right, opacity upwards.
class CurvePanel {
 public:
  /// @param renderer  kept by the caller
  explicit CurvePanel(vtkRenderer* renderer);

  void set_curve(std::vector<ColorPoint> curve);
  std::optional<CurveEditor>& editor() { return editor_; }
  void turn() { is_shown_ = !is_shown_; }
  /// Draws the panel with the window's size, if it is shown.
  void update();

  /// A button is pressed. @param tints  changes the color of a point, else its place
  /// @returns whether it is on the panel
  bool press(int x, int y, bool tints);
  /// The pointer moves with the button. @returns whether the curve has changed
  bool move(int x, int y);

 private:
  std::array<double, 2> share_of(int x, int y) const;
  std::array<double, 2> corner() const;

  vtkRenderer* renderer_;
  std::optional<CurveEditor> editor_;
  bool is_shown_ = false, tints_ = false;
  std::optional<std::size_t> held_;  ///< the point in the hand
  std::array<int, 2> last_{};        ///< of the pointer
  vtkNew<vtkPoints> frame_places_, line_places_, point_places_;
  vtkNew<vtkPolyData> frame_, line_, points_;
  vtkNew<vtkUnsignedCharArray> point_colors_;
  vtkNew<vtkActor2D> frame_actor_, line_actor_, points_actor_;
};

}  // namespace tetwarp::view
