/// @file window_picture.cpp
/// Pixels of a window.
#include "host/view/window/window_picture.hpp"

#include <fmt/format.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkWindowToImageFilter.h>

#include <cstring>
#include <filesystem>
#include <string_view>

namespace tetwarp::view {

bool is_software(vtkRenderWindow* window) {
  const std::string_view renderer = window->ReportCapabilities();
  return renderer.find("llvmpipe") != std::string_view::npos ||
         renderer.find("softpipe") != std::string_view::npos;
}

std::string free_name(const std::string& ending) {
  std::string path;
  int number = 0;
  do {
    path = fmt::format("view_{:04}{}", number++, ending);
  } while (std::filesystem::exists(path));
  return path;
}

Image drawn_picture_of(vtkRenderWindow* window) {
  vtkNew<vtkWindowToImageFilter> reader;
  reader->SetInput(window);
  reader->ReadFrontBufferOff();
  reader->ShouldRerenderOff();
  reader->Update();
  vtkImageData* const picture = reader->GetOutput();
  int size[3];
  picture->GetDimensions(size);
  Image image{size[0], size[1], {}};
  const auto row_bytes = static_cast<std::size_t>(3 * size[0]);
  image.rgb.resize(row_bytes * static_cast<std::size_t>(size[1]));
  for (int row = 0; row < size[1]; ++row) {  // VTK's first row is the lowest
    std::memcpy(image.rgb.data() + row_bytes * static_cast<std::size_t>(size[1] - 1 - row),
                picture->GetScalarPointer(0, row, 0), row_bytes);
  }
  return image;
}

Image picture_of(vtkRenderWindow* window) {
  const bool swaps = window->GetSwapBuffers() != 0;
  window->SwapBuffersOff();
  window->Render();
  Image image = drawn_picture_of(window);
  window->SetSwapBuffers(swaps);
  return image;
}

}  // namespace tetwarp::view
