/// @file step_selection.hpp
/// Which steps of a mesh to warp.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tetwarp::cli {

/// A comma list of step numbers and of half-open slices as in Python: "0:10:2", "-1", "0,3,8:".
/// Order and repetition have no effect.
class StepSelection {
 public:
  /// Every step.
  StepSelection() : StepSelection(":") {}

  /// Throws std::invalid_argument on anything else.
  explicit StepSelection(std::string text);

  /// The selected steps of the `step_count` of a file, ascending. Throws IoError when a single
  /// number names no step or nothing is selected.
  std::vector<std::int64_t> of(std::int64_t step_count, const std::string& file) const;

 private:
  struct Item {
    bool is_slice = false;
    std::optional<std::int64_t> begin;  ///< the number itself when not a slice
    std::optional<std::int64_t> end;
    std::int64_t stride = 1;
  };

  static Item parse_item(const std::string& text);
  static std::vector<std::int64_t> steps_of(const Item& item, std::int64_t step_count);

  std::string text_;
  std::vector<Item> items_;
};

/// The whole number that `text` consists of; nothing when it is anything else.
std::optional<std::int64_t> whole_number(const std::string& text);

/// The parts of `text` between separators; at least one.
std::vector<std::string> split(const std::string& text, char separator);

}  // namespace tetwarp::cli
