/// @file window_texts.cpp
/// Places and looks of texts, and the help.
#include "host/view/window/window_texts.hpp"

#include <vtkTextProperty.h>

namespace tetwarp::view {
namespace {
constexpr const char* help_text =
    "left: pull the body, else turn   g: turn only   Shift+left: pan\n"
    "wheel: zoom   Shift+wheel: move a slice   right: window of volumes\n"
    "r view of the start   arrows turn   Shift+arrows pan   + - zoom\n"
    "keypad 1 3 7 anterior, left, superior   0 the nearest\n"
    "space pause   . step   Backspace restart   c contacts\n"
    "v volume, slices, surfaces   n one slice alone   o curve of volumes\n"
    "x cut plane   Page Up, Page Down move it   i probe   k colors\n"
    "F11 full screen   F12 picture   m film   h help   Escape let go, quit";

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
