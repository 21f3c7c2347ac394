/// @file extension.cpp
/// Compares ends of names; only ASCII letters have two forms.
#include "io/files/extension.hpp"

#include <algorithm>
#include <cstddef>

namespace tetwarp {

bool has_extension(const std::string& path, std::string_view end) {
  if (path.size() < end.size()) return false;
  const auto is_same = [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; };
  return std::equal(end.begin(), end.end(), path.end() - static_cast<std::ptrdiff_t>(end.size()),
                    [&](char b, char a) { return is_same(a, b); });
}

bool has_one_of(const std::string& path, std::span<const std::string_view> ends) {
  return std::ranges::any_of(ends,
                             [&](const std::string_view end) { return has_extension(path, end); });
}

std::string listed_endings(std::span<const std::string_view> ends) {
  std::string text(ends.front());
  for (std::size_t n = 1; n < ends.size(); ++n) {
    text.append(n + 1 < ends.size() ? ", " : " or ").append(ends[n]);
  }
  return text;
}

}  // namespace tetwarp
