/// @file text_points.cpp
/// Finds columns and axes, and copies lines with other positions.
#include "io/points/text_points.hpp"

#include <algorithm>
#include <charconv>
#include <tetwarp/error.hpp>

#include "io/files/extension.hpp"
#include "io/files/finished_file.hpp"
#include "io/files/text_file.hpp"

namespace tetwarp {
namespace {
std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  return result;
}

std::string_view trimmed(std::string_view text) {
  const auto is_outer = [](char c) { return c == ' ' || c == '\t' || c == '"'; };
  while (!text.empty() && is_outer(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_outer(text.back())) text.remove_suffix(1);
  return text;
}

void append_number(std::string& text, double value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  text.append(digits, end);
}

/// The value of "# NAME = VALUE".
std::optional<std::string> value_of(std::string_view comment, std::string_view name) {
  const std::size_t equals = comment.find('=');
  if (equals == std::string_view::npos || trimmed(comment.substr(1, equals - 1)) != name) return {};
  return std::string(trimmed(comment.substr(equals + 1)));
}
}  // namespace

TextPoints::TextPoints(const std::string& path, Axes axes)
    : path_(path), text_(read_text(path)), is_slicer_(has_extension(path, ".fcsv")), axes_(axes) {
  if (is_slicer_) columns_ = {1, 2, 3};
  if (has_extension(path, ".tsv")) separator_ = '\t';
  split_lines();
  names_line_ = lines_.size();
  bool has_begun = false;
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    Line& line = lines_[n];
    if (line.begin == line.end) continue;
    if (text_[line.begin] == '#') {
      read_comment(line);
      if (is_slicer_ && value_of({&text_[line.begin], line.end - line.begin}, "columns")) {
        names_line_ = n;
      }
      continue;
    }
    if (!has_begun && !is_slicer_) {
      read_first(line);
      if (!line.is_point) names_line_ = n;
    } else {
      line.is_point = true;
    }
    has_begun = true;
    if (line.is_point) read_point(line);
  }
  if (points_.empty()) throw IoError(path, "", "holds no point");
}

std::vector<std::string> TextPoints::output_extensions() const {
  if (is_slicer_) return {".fcsv"};
  return {".csv", ".tsv", ".txt"};
}

void TextPoints::split_lines() {
  for (std::size_t begin = 0; begin < text_.size();) {
    const std::size_t found = text_.find('\n', begin);
    std::size_t end = found == std::string::npos ? text_.size() : found;
    const std::size_t next = end + 1;
    if (end > begin && text_[end - 1] == '\r') --end;
    lines_.push_back({begin, end, false});
    begin = next;
  }
}

void TextPoints::fail(const Line& line, const std::string& problem) const {
  const std::ptrdiff_t number = &line - lines_.data();
  throw IoError(path_, "line " + std::to_string(number + 1), problem);
}

std::vector<TextPoints::Field> TextPoints::fields_of(const Line& line) const {
  std::vector<Field> fields{{line.begin, line.end}};
  bool is_quoted = false;
  for (std::size_t c = line.begin; c < line.end; ++c) {
    if (text_[c] == '"') is_quoted = !is_quoted;
    if (text_[c] != separator_ || is_quoted) continue;
    fields.back().end = c;
    fields.push_back({c + 1, line.end});
  }
  return fields;
}

std::string TextPoints::name_in(const Field& field) const {
  return lower(trimmed({&text_[0] + field.begin, field.end - field.begin}));
}

std::optional<double> TextPoints::number_in(const Field& field) const {
  std::string_view text = trimmed({&text_[0] + field.begin, field.end - field.begin});
  if (text.starts_with('+')) text.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

/// Names of axes and columns that 3D Slicer writes as comments.
void TextPoints::read_comment(const Line& line) {
  if (!is_slicer_) return;
  const std::string_view comment{&text_[line.begin], line.end - line.begin};
  if (const auto system = value_of(comment, "CoordinateSystem")) {
    const bool is_lps = *system == "LPS" || *system == "1";
    if (!is_lps && *system != "RAS" && *system != "0") {
      fail(line, "names axes '" + *system + "', expected RAS or LPS; save it in one of these");
    }
    axes_ = is_lps ? Axes::lps : Axes::ras;
    names_axes_ = true;
  }
  if (const auto columns = value_of(comment, "columns")) {
    const std::size_t equals = text_.find('=', line.begin);
    std::vector<std::string> names;
    for (const Field& field : fields_of({equals + 1, line.end, false})) {
      names.push_back(name_in(field));
    }
    if (!set_columns(names)) fail(line, "names no columns x, y and z");
  }
}

void TextPoints::choose_separator(const Line& line) {
  if (separator_ == '\t') return;
  std::ptrdiff_t most = 0;
  for (const char candidate : {',', ';', '\t'}) {
    const auto count = std::count(text_.begin() + static_cast<std::ptrdiff_t>(line.begin),
                                  text_.begin() + static_cast<std::ptrdiff_t>(line.end), candidate);
    if (count > most) separator_ = candidate;
    most = std::max(most, count);
  }
}

/// @returns false when there are none of a position
bool TextPoints::set_columns(const std::vector<std::string>& names) {
  const auto place_of = [&](const char* name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  if (place_of("inside") < names.size()) inside_column_ = place_of("inside");
  struct Names {
    std::array<const char*, 3> of;
    std::optional<Axes> axes;
  };
  for (const Names& known : {Names{{"x", "y", "z"}, {}}, Names{{"r", "a", "s"}, Axes::ras},
                             Names{{"l", "p", "s"}, Axes::lps}}) {
    for (std::size_t axis = 0; axis < 3; ++axis) columns_[axis] = place_of(known.of[axis]);
    if (*std::max_element(columns_.begin(), columns_.end()) == names.size()) continue;
    if (known.axes) axes_ = *known.axes;
    names_axes_ = names_axes_ || known.axes;
    return true;
  }
  return false;
}

/// The first line holds names of columns or numbers.
void TextPoints::read_first(Line& line) {
  choose_separator(line);
  const std::vector<Field> fields = fields_of(line);
  column_count_ = fields.size();
  std::vector<std::string> names;
  for (const Field& field : fields) names.push_back(name_in(field));
  if (set_columns(names)) return;
  columns_ = {0, 1, 2};
  line.is_point = fields.size() >= 3 &&
                  std::all_of(fields.begin(), fields.begin() + 3,
                              [&](const Field& field) { return number_in(field).has_value(); });
  if (!line.is_point) {
    fail(line, "has neither columns named x, y, z (or r, a, s, or l, p, s) nor three numbers");
  }
}

void TextPoints::read_point(const Line& line) {
  const std::vector<Field> fields = fields_of(line);
  if (column_count_ > 0 && fields.size() != column_count_) {
    fail(line, "has " + std::to_string(fields.size()) + " columns, the first line has " +
                   std::to_string(column_count_));
  }
  Point3 point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (columns_[axis] >= fields.size()) fail(line, "lacks columns of the position");
    const Field& field = fields[columns_[axis]];
    const std::optional<double> number = number_in(field);
    if (!number) {
      fail(line, "'" + std::string(trimmed({&text_[field.begin], field.end - field.begin})) +
                     "' is no number with a decimal point");
    }
    point[axis] = *number;
  }
  points_.push_back(between(axes_, point));
}

std::string TextPoints::write(const std::string& path, const PlacedPoints& placed) const {
  std::string copy;
  copy.reserve(text_.size() + 8 * lines_.size());
  std::size_t widest = 0;  // columns of a line; in .fcsv some have no name
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    if (lines_[n].is_point || n == names_line_) {
      widest = std::max(widest, fields_of(lines_[n]).size());
    }
    if (column_count_ > 0 && widest > 0) break;
  }
  std::size_t p = 0;
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    const Line& line = lines_[n];
    const std::vector<Field> fields =
        line.is_point || n == names_line_ ? fields_of(line) : std::vector<Field>{};
    const auto append = [&](const Field& field) {
      copy.append(text_, field.begin, field.end - field.begin);
    };
    if (fields.empty()) append({line.begin, line.end});
    const Point3 place = line.is_point ? between(axes_, placed.points[p]) : Point3{};
    const std::string inside = !line.is_point ? "inside" : placed.inside[p] != 0 ? "1" : "0";
    for (std::size_t f = 0; f < fields.size(); ++f) {
      if (f > 0) copy += separator_;
      const auto axis = std::find(columns_.begin(), columns_.end(), f) - columns_.begin();
      if (f == inside_column_ && line.is_point) {
        copy += inside;
      } else if (axis < 3 && line.is_point && placed.inside[p] != 0) {
        append_number(copy, place[static_cast<std::size_t>(axis)]);
      } else {
        append(fields[f]);
      }
    }
    if (!fields.empty() && !inside_column_) {
      copy.append(widest - fields.size() + 1, separator_);
      copy += inside;
    }
    p += line.is_point;
    const std::size_t next = n + 1 < lines_.size() ? lines_[n + 1].begin : text_.size();
    append({line.end, next});
  }
  write_finished_file(path, copy);
  return {};
}

}  // namespace tetwarp
