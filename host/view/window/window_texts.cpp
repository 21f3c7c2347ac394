/// @file window_texts.cpp
/// Places and looks of texts, and the help.
#include "host/view/window/window_texts.hpp"

#include <vtkTextProperty.h>

namespace tetwarp::view {
namespace {
constexpr const char* help_text =
    "left: pull the body, else turn   Shift+left: pan\nwheel: zoom   right: window of volumes\n"
    "space pause   s step   r restart   c contacts   p picture   m film\n"
    "v volume, slices, surfaces   i probe   x cut plane   , . move it\n"
    "k colors of stress, gap, adhesion   o curve of volumes\nh help   q quit";

void style_text(vtkTextActor* text, int size) {
  text->GetTextProperty()->SetFontSize(size);
  text->GetTextProperty()->SetFontFamilyToCourier();
  text->GetTextProperty()->SetColor(0.1, 0.1, 0.15);
}
}  // namespace

WindowTexts::WindowTexts(vtkRenderer* renderer) {
  style_text(text_, 15);
  style_text(help_, 13);
  text_->GetTextProperty()->SetVerticalJustificationToTop();
  text_->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  text_->GetPositionCoordinate()->SetValue(0.01, 0.99);
  help_->SetInput(help_text);
  help_->SetPosition(10, 8);
  help_->VisibilityOff();
  renderer->AddViewProp(text_);
  renderer->AddViewProp(help_);
}

}  // namespace tetwarp::view
