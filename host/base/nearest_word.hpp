/// @file nearest_word.hpp
/// Suggestions for words that are not known.
#pragma once
#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace tetwarp {

/// Number of letters to insert, remove or replace to make `b` of `a`.
inline std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row.back();
}

/// "did you mean 'sphere'?" for a word of at most two wrong letters, fewer than its letters; else
/// empty.
inline std::string did_you_mean(const std::string& word, const std::vector<std::string>& words) {
  const std::string shown = word.substr(0, 40);
  std::size_t least = std::min<std::size_t>(3, shown.size());
  std::string nearest;
  for (const std::string& known : words) {
    const std::size_t distance = edit_distance(shown, known);
    if (distance >= least) continue;
    least = distance;
    nearest = known;
  }
  return nearest.empty() ? "" : "did you mean '" + nearest + "'?";
}

}  // namespace tetwarp
