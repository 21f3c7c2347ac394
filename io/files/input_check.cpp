/// @file input_check.cpp
/// By name, and by what names lead to.
#include "io/files/input_check.hpp"

#include <filesystem>
#include <system_error>
#include <tetwarp/error.hpp>

#include "io/files/finished_file.hpp"

namespace tetwarp {
namespace fs = std::filesystem;

std::string canonical_path(const std::string& path) {
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(fs::absolute(link_target(path)), error);
  return error ? path : canonical.string();
}

void check_no_input(const std::string& output, const std::vector<std::string>& inputs) {
  const std::string canonical = canonical_path(output);
  for (const std::string& input : inputs) {
    std::error_code error;
    if (canonical == canonical_path(input) || fs::equivalent(output, input, error)) {
      throw IoError(output, "", "is also an input; name another output");
    }
  }
}

}  // namespace tetwarp
