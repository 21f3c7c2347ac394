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

}  // namespace tetwarp
