/// @file number_line.hpp
/// Lines of numbers, in files and of the standard input.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace tetwarp::view {

/// The finite numbers of a line with blanks between them; nothing: it has something else as well.
std::optional<std::vector<double>> numbers_of(const std::string& line);

}  // namespace tetwarp::view
