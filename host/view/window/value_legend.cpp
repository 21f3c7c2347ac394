/// @file value_legend.cpp
/// A bar of VTK with the colors of values.
#include "host/view/window/value_legend.hpp"

#include <vtkTextProperty.h>

namespace tetwarp::view {
namespace {
constexpr int levels = 64;
}  // namespace

ValueLegend::ValueLegend(vtkRenderer* renderer) {
  colors_->SetNumberOfTableValues(levels);
  for (int level = 0; level < levels; ++level) {
    const Rgb color = value_color(static_cast<double>(level) / (levels - 1));
    colors_->SetTableValue(level, color[0], color[1], color[2]);
  }
  bar_->SetLookupTable(colors_);
  bar_->SetNumberOfLabels(5);
  bar_->SetLabelFormat("%.3g");
  bar_->SetPosition(0.83, 0.35);
  bar_->SetWidth(0.12);
  bar_->SetHeight(0.5);
  bar_->UnconstrainedFontSizeOn();
  for (vtkTextProperty* const text : {bar_->GetTitleTextProperty(), bar_->GetLabelTextProperty()}) {
    text->SetFontSize(13);
    text->SetFontFamilyToCourier();
    text->SetColor(0.1, 0.1, 0.15);
    text->ItalicOff();
    text->ShadowOff();
    text->BoldOff();
  }
  bar_->VisibilityOff();
  renderer->AddViewProp(bar_);
}

void ValueLegend::show(SurfaceQuantity quantity, const ValueRange& range) {
  bar_->SetVisibility(quantity != SurfaceQuantity::none);
  bar_->SetTitle(title_of(quantity).c_str());
  colors_->SetTableRange(range.low(), range.high());
}

}  // namespace tetwarp::view
