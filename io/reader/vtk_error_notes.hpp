/// @file vtk_error_notes.hpp
/// Errors of VTK's readers.
#pragma once
#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkNew.h>
#include <vtkObject.h>

namespace tetwarp {

/// Notes the errors that a reader reports, by which it may drop arrays without failing.
class VtkErrorNotes {
 public:
  explicit VtkErrorNotes(vtkObject& reader) {
    vtkObject::GlobalWarningDisplayOn();  // else errors are not reported
    callback_->SetClientData(&has_error_);
    callback_->SetCallback([](vtkObject*, unsigned long, void* has_error, void*) {
      *static_cast<bool*>(has_error) = true;
    });
    reader.AddObserver(vtkCommand::ErrorEvent, callback_);
    reader.AddObserver(vtkCommand::WarningEvent, silence_);
  }
  VtkErrorNotes(const VtkErrorNotes&) = delete;
  VtkErrorNotes& operator=(const VtkErrorNotes&) = delete;

  bool has_error() const { return has_error_; }

 private:
  vtkNew<vtkCallbackCommand> callback_, silence_;
  bool has_error_ = false;
};

}  // namespace tetwarp
