/// @file meta_header.cpp
/// Lines "Key = Value" of MetaImage headers, in ITK's axes: LPS.
#include "io/image/meta_header.hpp"
#include "io/files/mean_interval.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <tetwarp/error.hpp>

#include "io/files/extension.hpp"

namespace tetwarp {
namespace {
struct MetaType {
  const char* name;
  PixelType type;
};
constexpr MetaType meta_types[] = {
    {"MET_UCHAR", PixelType::uint8},       {"MET_CHAR", PixelType::int8},
    {"MET_USHORT", PixelType::uint16},     {"MET_SHORT", PixelType::int16},
    {"MET_UINT", PixelType::uint32},       {"MET_INT", PixelType::int32},
    {"MET_ULONG_LONG", PixelType::uint64}, {"MET_LONG_LONG", PixelType::int64},
    {"MET_ULONG", PixelType::uint32},      {"MET_LONG", PixelType::int32},
    {"MET_FLOAT", PixelType::float32},     {"MET_DOUBLE", PixelType::float64}};

/// Keys that say nothing that is lost.
constexpr const char* ignored_keys[] = {
    "ObjectType", "BinaryData", "AnatomicalOrientation", "CenterOfRotation", "CompressedDataSize",
    "ElementMin", "ElementMax", "HeaderSizePerSlice",    "CompressionLevel"};

std::string without_blanks(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(" \t\r") + 1 - begin);
}

class MetaReader {
 public:
  explicit MetaReader(const std::string& path) : path_(path) {
    read_fields();
    if (const auto type = take("ObjectType"); type && *type != "Image") {
      fail("ObjectType", "is '" + *type + "', expected Image");
    }
    if (const auto binary = take("BinaryData"); binary && !is_true(*binary)) {
      fail("BinaryData", "is False: samples as text are not read");
    }
    read_layout();
    read_axes();
    read_data();
    for (const auto& [key, value] : fields_) {
      const auto* const known = std::find(std::begin(ignored_keys), std::end(ignored_keys), key);
      if (known == std::end(ignored_keys)) header_.left_out.push_back(key);
    }
  }

  const ImageHeader& header() const { return header_; }

 private:
  [[noreturn]] void fail(const std::string& key, const std::string& problem) const {
    throw IoError(path_, key, problem);
  }

  static bool is_true(const std::string& text) {
    return text == "True" || text == "true" || text == "1";
  }

  void read_fields() {
    std::ifstream file(path_, std::ios::binary);
    std::int64_t offset = 0;
    for (std::string line; std::getline(file, line);) {
      offset += std::ssize(line) + 1;
      const std::size_t equals = line.find('=');
      if (line.size() > 1 << 20 || (equals == std::string::npos && !without_blanks(line).empty())) {
        fail("", "is damaged: '" + line.substr(0, 40) + "' is no line of a header");
      }
      if (equals == std::string::npos) continue;
      const std::string key = without_blanks(line.substr(0, equals));
      fields_[key] = without_blanks(line.substr(equals + 1));
      if (key != "ElementDataFile") continue;
      header_end_ = offset;
      return;
    }
    fail("ElementDataFile", "is missing in its header");
  }

  std::optional<std::string> take(const std::string& key) {
    const auto found = fields_.find(key);
    if (found == fields_.end()) return std::nullopt;
    const std::string value = found->second;
    fields_.erase(found);
    return value;
  }
  /// The first of these keys that the header has.
  std::optional<std::string> take_any(std::initializer_list<const char*> keys) {
    std::optional<std::string> first;
    for (const char* const key : keys) {
      const auto value = take(key);
      if (!first) first = value;
    }
    return first;
  }

  std::vector<double> numbers(const std::string& text, const std::string& key) const {
    std::vector<double> all;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
      double number = 0;
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
      if (error != std::errc() || end != word.data() + word.size()) {
        fail(key, "'" + word + "' is no number");
      }
      all.push_back(number);
    }
    return all;
  }
  std::vector<double> numbers_of(const std::string& text,
                                 const std::string& key,
                                 std::size_t count) {
    const std::vector<double> all = numbers(text, key);
    if (all.size() != count) fail(key, "expected " + std::to_string(count) + " numbers");
    return all;
  }

  void read_layout() {
    const auto dimension = take("NDims");
    const std::vector<double> count = numbers_of(dimension.value_or(""), "NDims", 1);
    if (count[0] != 2 && count[0] != 3 && count[0] != 4) {
      fail("NDims", "is " + *dimension + ", expected 2, 3, or 4 of a series");
    }
    dims_ = static_cast<std::size_t>(count[0]);
    const std::vector<double> sizes = numbers_of(take("DimSize").value_or(""), "DimSize", dims_);
    if (dims_ == 4) steps_ = sizes[3];
    for (std::size_t axis = 0; axis < std::min<std::size_t>(3, dims_); ++axis) {
      if (!(sizes[axis] >= 1 && sizes[axis] <= 0x1p30)) fail("DimSize", "is not from 1 to 2^30");
      header_.grid.dims[axis] = static_cast<std::int64_t>(sizes[axis]);
    }
    if (dims_ == 2) header_.grid.dims[2] = 1;
    const std::string type = take("ElementType").value_or("");
    const auto* const known =
        std::find_if(std::begin(meta_types), std::end(meta_types),
                     [&](const MetaType& entry) { return type == entry.name; });
    if (known == std::end(meta_types)) fail("ElementType", "'" + type + "' is not read");
    header_.type = known->type;
    const auto channels = take("ElementNumberOfChannels");
    const double components = channels ? numbers_of(*channels, "ElementNumberOfChannels", 1)[0] : 1;
    if (!(components >= 1 && components <= 9)) {
      fail("ElementNumberOfChannels", "is " + *channels + ", expected 1 to 9");
    }
    header_.components = static_cast<int>(components);
  }

  void read_axes() {
    std::vector<double> axes(dims_ * dims_, 0.0), spacing(dims_, 1.0), place(dims_, 0.0);
    for (std::size_t axis = 0; axis < dims_; ++axis) axes[axis * dims_ + axis] = 1;
    if (const auto text = take_any({"TransformMatrix", "Rotation", "Orientation"})) {
      axes = numbers_of(*text, "TransformMatrix", dims_ * dims_);
    }
    if (const auto text = take_any({"ElementSpacing", "ElementSize"})) {
      spacing = numbers_of(*text, "ElementSpacing", dims_);
    }
    if (const auto text = take_any({"Offset", "Position", "Origin"})) {
      place = numbers_of(*text, "Offset", dims_);
    }
    std::array<Point3, 3> steps{{{0, 0, 0}, {0, 0, 0}, {0, 0, 1}}};
    Point3 origin{0, 0, 0};
    const std::size_t of_space = std::min<std::size_t>(3, dims_);
    for (std::size_t axis = 0; axis < of_space; ++axis) {
      if (dims_ == 4 && (axes[4 * axis + 3] != 0 || axes[12 + axis] != 0)) {
        fail("TransformMatrix", "mixes the fourth axis with those of space");
      }
      steps[axis] = {0, 0, 0};
      for (std::size_t row = 0; row < of_space; ++row) {
        steps[axis][row] = axes[axis * dims_ + row] * spacing[axis];
      }
      origin[axis] = place[axis];
    }
    try {
      set_image_axes(steps, origin, {true, true, false}, header_.grid);
      if (dims_ == 4) set_image_steps(steps_, place[3], spacing[3], header_);
    } catch (const std::invalid_argument& error) {
      fail("TransformMatrix", error.what());
    }
  }

  void read_data() {
    header_.is_packed = is_true(take("CompressedData").value_or("False"));
    header_.is_big_endian =
        is_true(take_any({"BinaryDataByteOrderMSB", "ElementByteOrderMSB"}).value_or("False"));
    const std::string file = *take("ElementDataFile");
    if (file == "LIST" || file.find('%') != std::string::npos) {
      fail("ElementDataFile", "samples in several files are not read");
    }
    const bool is_local = file == "LOCAL" || file == "Local" || file == "local";
    header_.data_file = is_local ? path_ : beside(path_, file);
    header_.data_offset = is_local ? header_end_ : 0;
    if (const auto size = take("HeaderSize"); size && !is_local) {
      header_.data_offset = static_cast<std::int64_t>(
          std::clamp(numbers_of(*size, "HeaderSize", 1)[0], -1.0, 0x1p50));
    }
  }

  std::string path_;
  std::map<std::string, std::string> fields_;
  std::size_t dims_ = 3;
  double steps_ = 1;
  std::int64_t header_end_ = 0;
  ImageHeader header_;
};
}  // namespace

bool is_meta_image(const std::string& path) {
  if (!has_extension(path, ".mha") && !has_extension(path, ".mhd")) return false;
  std::ifstream file(path, std::ios::binary);
  std::string line;
  std::getline(file, line);
  return line.size() < 1000 && line.find('=') != std::string::npos;
}

ImageHeader read_meta_header(const std::string& path) {
  return MetaReader(path).header();
}

std::string meta_header_text(const ImageHeader& header) {
  const auto* const known =
      std::find_if(std::begin(meta_types), std::end(meta_types),
                   [&](const MetaType& entry) { return header.type == entry.type; });
  const Grid& grid = header.grid;
  const bool has_steps = !header.times.empty();
  const auto lps = [](std::size_t row, double x) {
    return " " + shortest_text(row < 2 ? 0 - x : x);
  };
  const auto of_steps = [&](const std::string& part) { return has_steps ? part : std::string(); };
  std::string text = std::string("ObjectType = Image\nNDims = ") + (has_steps ? "4" : "3") +
                     "\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = " +
                     (header.is_packed ? "True" : "False") + "\nTransformMatrix =";
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t row = 0; row < 3; ++row) text += lps(row, grid.direction[3 * row + axis]);
    text += of_steps(" 0");
  }
  text += of_steps(" 0 0 0 1") + "\nOffset =";
  for (std::size_t row = 0; row < 3; ++row) text += lps(row, grid.origin[row]);
  if (has_steps) text += " " + shortest_text(header.times.front());
  text += "\nCenterOfRotation = 0 0 0" + of_steps(" 0") + "\nElementSpacing =";
  for (const double spacing : grid.spacing) text += " " + shortest_text(spacing);
  if (has_steps) text += " " + shortest_text(mean_interval(header.times));
  text += "\nDimSize =";
  for (const std::int64_t size : grid.dims) text += " " + std::to_string(size);
  if (has_steps) text += " " + std::to_string(header.times.size());
  if (header.components > 1) {
    text += "\nElementNumberOfChannels = " + std::to_string(header.components);
  }
  return text + "\nElementType = " + known->name +
         "\nElementDataFile = " + (header.data_file.empty() ? "LOCAL" : header.data_file) + "\n";
}

}  // namespace tetwarp
