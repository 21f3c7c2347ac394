/// @file camera_option.cpp
/// Numbers and names of cameras.
#include "host/cli/common/camera_option.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace tetwarp::cli {
namespace {

bool is_name(const std::string& words) {
  return !words.empty() && std::ranges::all_of(words, [](unsigned char letter) {
    return std::isalnum(letter) != 0 || letter == '_' || letter == '-';
  });
}

/// Six finite numbers with commas between them.
std::optional<std::array<double, 6>> numbers_of(const std::string& words) {
  const std::vector<std::string> parts = CLI::detail::split(words, ',');
  std::array<double, 6> numbers{};
  if (parts.size() != numbers.size()) return std::nullopt;
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    if (!CLI::detail::lexical_cast(parts[n], numbers[n]) || !std::isfinite(numbers[n])) {
      return std::nullopt;
    }
  }
  return numbers;
}

CameraOption camera_of(const std::string& words) {
  if (is_name(words)) return {{}, words};
  const auto numbers = numbers_of(words);
  if (!numbers) {
    throw CLI::ValidationError("--camera",
                               "'" + words + "' is neither six numbers X,Y,Z,TX,TY,TZ nor a name");
  }
  if (std::equal(numbers->begin(), numbers->begin() + 3, numbers->begin() + 3)) {
    throw CLI::ValidationError("--camera", "the eye and what it looks at are the same point");
  }
  return {numbers, {}};
}

}  // namespace

CLI::Option* add_camera(CLI::App& app, CameraOption& camera, const std::string& usual) {
  return app
      .add_option_function<std::string>(
          "--camera", [&camera](const std::string& words) { camera = camera_of(words); },
          "eye and target, or a camera of the scene [" + usual + "]")
      ->type_name("X,Y,Z,TX,TY,TZ|NAME");
}

}  // namespace tetwarp::cli
