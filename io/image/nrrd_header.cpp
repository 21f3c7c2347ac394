/// @file nrrd_header.cpp
/// Fields of NRRD headers; https://teem.sourceforge.net/nrrd/format.html
#include "io/image/nrrd_header.hpp"
#include "io/files/mean_interval.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <tetwarp/error.hpp>

#include "host/base/point3.hpp"
#include "io/files/component_facts.hpp"
#include "io/image/nrrd_words.hpp"

namespace tetwarp {
namespace {
std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(" \t\r") + 1 - begin);
}

std::vector<std::string> words_in(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

class NrrdReader {
 public:
  explicit NrrdReader(const std::string& path) : path_(path) {
    read_fields();
    const auto size_words = words_in(required("sizes"));
    for (const std::string& word : size_words) sizes_.push_back(whole(word, "sizes"));
    read_layout();
    read_axes();
    read_data();
    for (const auto& [name, value] : fields_) header_.left_out.push_back(name);
  }

  const ImageHeader& header() const { return header_; }

 private:
  [[noreturn]] void fail(const std::string& field, const std::string& problem) const {
    throw IoError(path_, field, problem);
  }

  void read_fields() {
    std::ifstream file(path_, std::ios::binary);
    std::string line;
    std::getline(file, line);
    std::int64_t offset = std::ssize(line) + 1;
    while (std::getline(file, line)) {
      offset += std::ssize(line) + 1;
      if (line.size() > 1 << 20) fail("", "is damaged: a line of its header has no end");
      if (trimmed(line).empty()) {
        has_blank_ = true;
        break;
      }
      if (line[0] == '#') continue;
      const std::size_t pair = line.find(":="), colon = line.find(": ");
      if (pair != std::string::npos && (colon == std::string::npos || pair < colon)) {
        read_pair(line.substr(0, pair), trimmed(line.substr(pair + 2)));
      } else if (colon != std::string::npos) {
        const std::string written = line.substr(0, colon);
        if (!fields_.emplace(nrrd_field(written), trimmed(line.substr(colon + 2))).second) {
          fail(written, "is there twice in its header");
        }
      } else {
        fail("", "is damaged: '" + line.substr(0, 40) + "' is no line of a header");
      }
    }
    header_end_ = offset;
  }

  /// A key of 3D Slicer; others are left out.
  void read_pair(const std::string& key, const std::string& value) {
    if (lower_case(key) != nrrd_field_type) return header_.left_out.push_back(key);
    if (header_.field_type) fail(key, "is there twice in its header");
    header_.field_type = lower_case(value);
    // Resampling is what is taken without the key.
    if (header_.field_type != "resampling") header_.left_out.push_back(key);
  }

  std::optional<std::string> take(const std::string& name) {
    const auto found = fields_.find(name);
    if (found == fields_.end()) return std::nullopt;
    const std::string value = found->second;
    fields_.erase(found);
    return value;
  }
  std::string required(const std::string& name) {
    const auto value = take(name);
    if (!value) fail(name, "is missing in its header");
    return *value;
  }

  std::int64_t whole(const std::string& word, const std::string& field) const {
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size()) {
      fail(field, "'" + word + "' is no whole number");
    }
    return number;
  }

  /// "(1,0,0)" or numbers by themselves.
  Point3 vector(std::string text, const std::string& field) const {
    for (char& c : text) c = c == '(' || c == ')' || c == ',' ? ' ' : c;
    const std::vector<std::string> words = words_in(text);
    if (words.empty() || words.size() > 3) fail(field, "'" + text + "' is no vector");
    Point3 x{0, 0, 0};
    for (std::size_t n = 0; n < words.size(); ++n) x[n] = real(words[n], field);
    return x;
  }
  double real(const std::string& word, const std::string& field) const {
    double number = 0;
    const char* const last = word.data() + word.size();
    const bool has_plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
    const auto [end, error] = std::from_chars(word.data() + (has_plus ? 1 : 0), last, number);
    if (error != std::errc() || end != last) {
      fail(field, "'" + word + "' is no number");
    }
    return number;
  }

  /// Type, and which axes are of space: all, or all but the first.
  void read_layout() {
    const std::string type = required("type");
    const std::optional<PixelType> known = nrrd_type(type);
    if (!known) fail("type", "'" + type + "' is not read");
    header_.type = *known;
    const std::int64_t dimension = whole(required("dimension"), "dimension");
    if (dimension != std::ssize(sizes_) || dimension < 2 || dimension > 5) {
      fail("dimension", "expected 2 to 5 axes, each with a size");
    }
    const auto kinds = words_in(lower_case(take("kinds").value_or("")));
    const bool has_kinds = kinds.size() == sizes_.size();
    const auto is_space = [&](std::size_t axis) {
      return has_kinds ? kinds[axis] == "domain" || kinds[axis] == "space" : true;
    };
    const std::string directions =
        fields_.contains("space directions") ? fields_["space directions"] : "";
    const bool is_last_step =
        sizes_.size() > 2 &&
        (has_kinds ? !is_space(sizes_.size() - 1) : lower_case(directions).ends_with("none"));
    const std::size_t with_steps = sizes_.size() - (is_last_step ? 1 : 0);
    const bool is_first_none = lower_case(directions).starts_with("none");
    first_ = with_steps == 4 || is_first_none || (has_kinds && !is_space(0)) ? 1 : 0;
    if (has_kinds && first_ == 1 && is_space(0)) {
      fail("kinds",
           "its four axes are all of space; name the kind of that of time, which is the last one");
    }
    for (std::size_t axis = first_; has_kinds && axis < with_steps; ++axis) {
      if (!is_space(axis)) {
        fail("kinds", "components are read on the first axis only, and steps on the last one");
      }
    }
    of_space_ = with_steps - first_;
    if (of_space_ < 2 || of_space_ > 3) fail("dimension", "expected two or three axes of space");
    if (first_ == 1) {
      if (sizes_[0] < 1 || sizes_[0] > 9) {
        fail("sizes", "has " + std::to_string(sizes_[0]) +
                          " components, expected 1 to 9; move the axis of a series to the end");
      }
      header_.components = static_cast<int>(sizes_[0]);
      if (has_kinds) header_.component_kind = kinds[0];
      if (header_.component_kind.ends_with("symmetric-matrix")) {
        header_.left_out.emplace_back(order_fact);
      }
    }
    if (is_last_step) read_steps();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      header_.grid.dims[axis] = axis < of_space_ ? sizes_[first_ + axis] : 1;
    }
  }

  /// The number of an axis in a field of one number per axis; NaN: none.
  double of_axis(const std::string& field, std::size_t axis) {
    if (!fields_.contains(field)) return std::numeric_limits<double>::quiet_NaN();
    const auto words = words_in(fields_[field]);
    if (words.size() != sizes_.size()) fail(field, "expected one for every axis");
    return real(words[axis], field);
  }

  /// Times of the steps, whose axis is the last one.
  void read_steps() {
    const std::string units = take("units").value_or("");
    const double unit = units.ends_with("\"ms\"") ? 1e-3 : units.ends_with("\"us\"") ? 1e-6 : 1;
    const std::size_t last = sizes_.size() - 1;
    const double first = unit * of_axis("axis mins", last);
    try {
      set_image_steps(static_cast<double>(sizes_.back()), first, unit * of_axis("spacings", last),
                      header_);
    } catch (const std::invalid_argument& error) {
      fail("sizes", error.what());
    }
  }

  /// Whether samples of an axis of space are at the ends of its extent, not in the middle of cells.
  bool is_of_nodes(std::size_t axis) {
    const auto words = words_in(lower_case(fields_.contains("centers") ? fields_["centers"] : ""));
    return words.size() == sizes_.size() && words[first_ + axis] == "node";
  }

  /// Distance of samples along an axis of space: as given, by the ends of its extent, or 1.
  double spacing_of(std::size_t axis) {
    const double spacing = of_axis("spacings", first_ + axis);
    if (std::isfinite(spacing)) return spacing;
    const auto count = static_cast<double>(sizes_[first_ + axis] - (is_of_nodes(axis) ? 1 : 0));
    const double length = of_axis("axis maxs", first_ + axis) - of_axis("axis mins", first_ + axis);
    return std::isfinite(length) && length != 0 && count > 0 ? length / count : 1;
  }

  /// Of the first sample, where the extents of all axes of space have a beginning and samples a
  /// distance; else the origin.
  Point3 first_centers() {
    Point3 centers{0, 0, 0};
    for (std::size_t axis = 0; axis < of_space_; ++axis) {
      const double low = of_axis("axis mins", first_ + axis);
      const bool has_spacing = std::isfinite(of_axis("spacings", first_ + axis)) ||
                               std::isfinite(of_axis("axis maxs", first_ + axis));
      if (!std::isfinite(low) || !has_spacing) return {0, 0, 0};
      centers[axis] = low + (is_of_nodes(axis) ? 0 : spacing_of(axis) / 2);
    }
    return centers;
  }

  void read_axes() {
    std::array<bool, 3> is_negated{false, false, false};
    const auto space = take("space");
    if (space) {
      const auto known = nrrd_space(*space);
      if (!known) fail("space", "'" + *space + "' is not read, expected one of RAS, LAS and LPS");
      is_negated = *known;
    }
    // ITK's images of two axes name no space.
    const bool is_flat = take("space dimension") == "2" && !space && of_space_ == 2;
    if (is_flat) is_negated = {true, true, false};
    std::array<Point3, 3> steps{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    Point3 origin{0, 0, 0};
    const bool has_directions = fields_.contains("space directions");
    if (const auto directions = take("space directions")) {
      std::vector<std::string> parts;
      std::string joined;  // "(1, 0, 0)" may have blanks
      for (const std::string& word : words_in(*directions)) {
        joined += word;
        if (lower_case(joined) != "none" && joined.back() != ')') continue;
        parts.push_back(joined);
        joined.clear();
      }
      if (parts.size() != sizes_.size()) fail("space directions", "expected one for every axis");
      for (std::size_t axis = 0; axis < of_space_; ++axis) {
        steps[axis] = vector(parts[first_ + axis], "space directions");
      }
      take("spacings");
    } else {
      for (std::size_t axis = 0; axis < of_space_; ++axis) steps[axis][axis] = spacing_of(axis);
      origin = first_centers();
    }
    for (const char* const used : {"spacings", "axis mins", "axis maxs", "centers"}) take(used);
    if (of_space_ == 2 && !is_flat) steps[2] = unit(cross(steps[0], steps[1]));
    if (const auto given = take("space origin")) origin = vector(*given, "space origin");
    const std::string frame = fields_.contains(frame_fact) ? fields_[frame_fact] : "";
    // Those of LPS are the axes that components have without a frame.
    const bool is_lps = is_negated == std::array<bool, 3>{true, true, false};
    if (is_lps && is_unit_frame(frame)) take(frame_fact);
    try {
      set_image_axes(steps, origin, is_negated, header_.grid);
    } catch (const std::invalid_argument& error) {
      fail(has_directions ? "space directions" : "spacings", error.what());
    }
  }

  void read_data() {
    const std::string encoding = lower_case(required("encoding"));
    header_.is_packed = encoding == "gzip" || encoding == "gz";
    if (!header_.is_packed && encoding != "raw") {
      fail("encoding", "'" + encoding + "' is not read, expected raw or gzip");
    }
    const auto endian = take("endian");
    if (!endian && size_of(header_.type) > 1) fail("endian", "is missing in its header");
    header_.is_big_endian = endian && lower_case(*endian) == "big";
    if (const auto skipped = take("line skip"); skipped && *skipped != "0") {
      fail("line skip", "is not read, expected 0");
    }
    const auto skip = take("byte skip");
    const auto file = take("data file");
    if (file && (file->starts_with("LIST") || file->find('%') != std::string::npos)) {
      fail("data file", "samples in several files are not read");
    }
    if (!file && !has_blank_) fail("", "is damaged: its header has no end");
    header_.data_file = file ? beside(path_, *file) : path_;
    header_.data_offset = file ? 0 : header_end_;
    if (skip) {
      const std::int64_t bytes = whole(*skip, "byte skip");
      header_.data_offset = bytes < 0 ? -1 : header_.data_offset + bytes;
    }
  }

  std::string path_;
  std::map<std::string, std::string> fields_;
  std::vector<std::int64_t> sizes_;
  std::size_t first_ = 0;     // axis of space
  std::size_t of_space_ = 3;  // number of these
  std::int64_t header_end_ = 0;
  bool has_blank_ = false;
  ImageHeader header_;
};
}  // namespace

bool is_nrrd(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  char magic[7] = {};
  return file.read(magic, sizeof magic) && std::string(magic, 7) == "NRRD000";
}

ImageHeader read_nrrd_header(const std::string& path) {
  return NrrdReader(path).header();
}

std::string nrrd_header_text(const ImageHeader& header) {
  const Grid& grid = header.grid;
  const bool has_components = header.components > 1, has_steps = !header.times.empty();
  const int dimension = 3 + (has_components ? 1 : 0) + (has_steps ? 1 : 0);
  std::string text =
      "NRRD0004\n# written by tetwarp\ntype: " + std::string(nrrd_type_name(header.type)) +
      "\ndimension: " + std::to_string(dimension) + "\nspace: left-posterior-superior\nsizes:";
  if (has_components) text += " " + std::to_string(header.components);
  for (const std::int64_t size : grid.dims) text += " " + std::to_string(size);
  if (has_steps) text += " " + std::to_string(header.times.size());
  text += "\nspace directions:";
  if (has_components) text += " none";
  const auto lps = [](std::size_t row, double x) { return shortest_text(row < 2 ? 0 - x : x); };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t row = 0; row < 3; ++row) {
      text +=
          (row == 0 ? " (" : ",") + lps(row, grid.direction[3 * row + axis] * grid.spacing[axis]);
    }
    text += ")";
  }
  if (has_steps) {
    std::string none;
    for (int axis = 1; axis < dimension; ++axis) none += " NaN";
    text += " none\nspacings:" + none + " " + shortest_text(mean_interval(header.times)) +
            "\naxis mins:" + none + " " + shortest_text(header.times.front()) + "\nunits:";
    for (int axis = 1; axis < dimension; ++axis) text += " \"\"";
    text += " \"s\"";
  }
  const char* const first = !has_components ? "" : header.components == 3 ? "vector " : "list ";
  return text + "\nkinds: " + first + "domain domain domain" + (has_steps ? " list" : "") +
         "\nendian: little\nencoding: " + (header.is_packed ? "gzip" : "raw") +
         "\nspace origin: (" + lps(0, grid.origin[0]) + "," + lps(1, grid.origin[1]) + "," +
         lps(2, grid.origin[2]) + ")\n" +
         (header.field_type ? std::string(nrrd_field_type) + ":=" + *header.field_type + "\n"
                            : "") +
         "\n";
}

}  // namespace tetwarp
