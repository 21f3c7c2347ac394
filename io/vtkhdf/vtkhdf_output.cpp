/// @file vtkhdf_output.cpp
/// Creates the temporary file, and renames it at the end.
#include "io/vtkhdf/vtkhdf_output.hpp"

#include <array>

#include "io/h5/h5_write.hpp"

namespace tetwarp {

VtkhdfOutput::VtkhdfOutput(const std::string& path, const std::string& type, bool is_temporal)
    : finished_(path),
      file_(h5::create_file(path, finished_.temporary(), disk_)),
      root_(h5::create_group(file_, "VTKHDF")) {
  const std::array<std::int64_t, 2> version = {is_temporal ? 2 : 1, 0};
  h5::write_attribute(root_, "Version", std::span<const std::int64_t>(version));
  h5::write_text_attribute(root_, "Type", type);
}

std::int64_t VtkhdfOutput::finish() {
  if (!root_.handle.close() || !file_.handle.close()) file_.fail_with_reason("cannot be closed");
  disk_.check(file_);
  return finished_.finish();
}

}  // namespace tetwarp
