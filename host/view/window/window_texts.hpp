/// @file window_texts.hpp
/// WindowTexts: the texts in the corners of the window.
#pragma once
#include <string>

#include <vtkNew.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>

namespace tetwarp::view {

class WindowTexts {
 public:
  explicit WindowTexts(vtkRenderer* renderer);

  /// Of the upper left corner.
  void set(const std::string& text) { text_->SetInput(text.c_str()); }
  /// What mouse and keys do, on and off.
  void turn_help() { help_->SetVisibility(help_->GetVisibility() == 0); }

 private:
  vtkNew<vtkTextActor> text_, help_;
};

}  // namespace tetwarp::view
