/// @file step_selection.cpp
/// Parses step numbers and slices, and applies them to a number of steps.
#include "host/cli/job/step_selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <set>
#include <stdexcept>
#include <tetwarp/error.hpp>
#include <utility>

namespace tetwarp::cli {

std::optional<std::int64_t> whole_number(const std::string& text) {
  std::int64_t number = 0;
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  if (text.empty() || error != std::errc() || stopped != end) return std::nullopt;
  return number;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char character : text) {
    if (character == separator) {
      parts.emplace_back();
    } else {
      parts.back() += character;
    }
  }
  return parts;
}

StepSelection::StepSelection(std::string text) : text_(std::move(text)) {
  for (const std::string& part : split(text_, ',')) items_.push_back(parse_item(part));
}

StepSelection::Item StepSelection::parse_item(const std::string& text) {
  const std::vector<std::string> parts = split(text, ':');
  const auto refuse = [&text]() {
    return std::invalid_argument("'" + text +
                                 "' is neither a step number nor a slice such as 0:10:2 or -3:");
  };
  if (parts.size() > 3) throw refuse();
  Item item;
  item.is_slice = parts.size() > 1;
  const auto part = [&](std::size_t position) -> std::optional<std::int64_t> {
    if (position >= parts.size() || (item.is_slice && parts[position].empty())) return {};
    const std::optional<std::int64_t> number = whole_number(parts[position]);
    if (!number) throw refuse();
    return number;
  };
  item.begin = part(0);
  item.end = part(1);
  item.stride = part(2).value_or(1);
  if (item.stride == 0) throw std::invalid_argument("'" + text + "': the stride must not be 0");
  return item;
}

std::vector<std::int64_t> StepSelection::steps_of(const Item& item, std::int64_t step_count) {
  const auto from_end = [&](std::int64_t number) {
    return number < 0 ? number + step_count : number;
  };
  if (!item.is_slice) {
    const std::int64_t step = from_end(*item.begin);
    if (step < 0 || step >= step_count) {
      throw std::invalid_argument(fmt::format("step {} does not exist, there are {} (0 to {})",
                                              *item.begin, step_count, step_count - 1));
    }
    return {step};
  }
  // Python's rule: ends are clamped to [0, count], or to [-1, count - 1] when counting down.
  const bool down = item.stride < 0;
  const std::int64_t low = down ? -1 : 0;
  const std::int64_t high = down ? step_count - 1 : step_count;
  const auto end_of = [&](const std::optional<std::int64_t>& number, std::int64_t open) {
    return number ? std::clamp(from_end(*number), low, high) : open;
  };
  const std::int64_t begin = end_of(item.begin, down ? high : low);
  const std::int64_t end = end_of(item.end, down ? low : high);
  // Larger strides select nothing more; clamped so that additions cannot overflow.
  const std::int64_t stride = std::clamp(item.stride, -step_count, step_count);
  std::vector<std::int64_t> steps;
  for (std::int64_t step = begin; down ? step > end : step < end; step += stride) {
    steps.push_back(step);
  }
  return steps;
}

std::vector<std::int64_t> StepSelection::of(std::int64_t step_count,
                                            const std::string& file) const {
  std::set<std::int64_t> steps;
  for (const Item& item : items_) {
    try {
      const std::vector<std::int64_t> some = steps_of(item, step_count);
      steps.insert(some.begin(), some.end());
    } catch (const std::invalid_argument& error) {
      throw IoError(file, "", error.what());
    }
  }
  if (steps.empty()) {
    throw IoError(file, "",
                  fmt::format("--steps {} selects none of its {} steps", text_, step_count));
  }
  return {steps.begin(), steps.end()};
}

}  // namespace tetwarp::cli
