/// @file itk_transform_files.cpp
/// Parses the three formats.
#include "io/transforms/itk_transform_files.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <sstream>
#include <tetwarp/error.hpp>
#include <utility>

#include "io/files/text_file.hpp"
#include "io/h5/h5.hpp"
#include "io/h5/h5_read.hpp"

namespace tetwarp {
namespace {
/// Throws IoError about the first number that is not finite.
/// @param key    of the list in the file
/// @param first  index of the first number in that list
void check_finite(const std::string& path,
                  const std::string& key,
                  const std::vector<double>& numbers,
                  std::int64_t first = 0) {
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    if (std::isfinite(numbers[n])) continue;
    const std::int64_t index = first + static_cast<std::int64_t>(n);
    throw IoError(path, key + "[" + std::to_string(index) + "]",
                  std::string("is ") + (std::isnan(numbers[n]) ? "not a number" : "infinite") +
                      ", expected a finite number; write the transform again");
  }
}

/// @param key  of the list in the file
std::vector<double> numbers_in(const std::string& path,
                               const std::string& key,
                               const std::string& text) {
  std::vector<double> numbers;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    double number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size()) {
      throw IoError(path, key + "[" + std::to_string(numbers.size()) + "]",
                    "'" + word + "' is no number");
    }
    numbers.push_back(number);
  }
  check_finite(path, key, numbers);
  return numbers;
}

/// The dataset of a transform under the name of ITK 5 or the misspelled one of ITK 4, if it has
/// one.
std::optional<h5::Dataset> hdf5_dataset(const h5::Object& group,
                                        const char* name,
                                        const char* old_name) {
  for (const char* const known : {name, old_name}) {
    if (h5::has_child(group, known)) return h5::open_dataset(group, known);
  }
  return std::nullopt;
}

/// Leaves parameters in the file, for the transform to read them.
void set_stored(h5::Dataset dataset, ItkTransform& transform) {
  if (!h5::is_numeric(dataset) || dataset.dims.size() != 1) {
    dataset.fail("is no list of numbers");
  }
  transform.stored = dataset.rows();
  transform.chunk_bytes = 2 * h5::chunk_bytes(dataset);
  transform.read = [kept = std::make_shared<const h5::Dataset>(std::move(dataset))](
                       std::int64_t first, std::int64_t count) {
    const h5::Silence silence;
    std::vector<double> numbers(static_cast<std::size_t>(count));
    h5::read_block(*kept, H5T_NATIVE_DOUBLE, {&first, 1}, {&count, 1}, numbers.data());
    check_finite(kept->file, kept->name, numbers, first);
    return numbers;
  };
}

/// Numbers of a dataset, which are finite.
std::vector<double> finite_reals(const h5::Dataset& dataset) {
  std::vector<double> numbers = h5::read_reals(dataset);
  check_finite(dataset.file, dataset.name, numbers);
  return numbers;
}
}  // namespace

std::vector<ItkTransform> read_itk_text(const std::string& path) {
  const std::string text = read_text(path);
  if (!text.starts_with("#Insight Transform File")) {
    throw IoError(path, "",
                  "is no transform file of ITK, which begins with '#Insight Transform File'; a "
                  "matrix alone does not tell its axes and direction");
  }
  std::vector<ItkTransform> transforms;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(':');
    if (line.empty() || line[0] == '#' || colon == std::string::npos) continue;
    const std::string key = line.substr(0, colon), value = line.substr(colon + 1);
    if (key == "Transform") {
      const std::size_t begin = value.find_first_not_of(' ');
      const std::size_t end = value.find_last_not_of(" \r") + 1;
      if (begin == std::string::npos) throw IoError(path, "", "names no type of a transform");
      transforms.push_back({value.substr(begin, end - begin), {}, {}});
    } else if (!transforms.empty() && (key == "Parameters" || key == "FixedParameters")) {
      ItkTransform& last = transforms.back();
      const std::string place = "Transform " + std::to_string(transforms.size() - 1) + ": " + key;
      (key == "Parameters" ? last.parameters : last.fixed) = numbers_in(path, place, value);
    }
  }
  return transforms;
}

/// Level 4 files: for each matrix a head of five numbers, a name, and its entries.
std::vector<ItkTransform> read_itk_matlab(const std::string& path) {
  const std::string bytes = read_text(path);
  std::vector<ItkTransform> transforms;
  const auto damaged = [&] {
    return IoError(path, "",
                   "is no MATLAB file (level 4) that ITK or ANTs wrote; a matrix alone does not "
                   "tell its axes and direction");
  };
  for (std::size_t at = 0; at < bytes.size();) {
    std::array<std::int32_t, 5> head;  // type, rows, columns, imaginary, bytes of the name
    if (bytes.size() - at < sizeof head) throw damaged();
    std::memcpy(head.data(), bytes.data() + at, sizeof head);
    at += sizeof head;
    const bool is_single = head[0] % 100 == 10;
    const bool is_sound = (head[0] % 100 == 0 || is_single) && head[0] >= 0 && head[0] < 200 &&
                          head[1] >= 0 && head[2] >= 0 && head[1] < 1000 && head[2] < 1000 &&
                          head[3] == 0 && head[4] > 0 && head[4] < 256;
    const std::size_t count = is_sound ? static_cast<std::size_t>(head[1] * head[2]) : 0;
    const std::size_t size = is_single ? 4 : 8, name_size = static_cast<std::size_t>(head[4]);
    if (!is_sound || bytes.size() - at < name_size + count * size) throw damaged();
    const std::string name(bytes.data() + at, strnlen(bytes.data() + at, name_size));
    at += name_size;
    std::vector<double> numbers(count);
    for (double& number : numbers) {
      float narrow = 0;
      std::memcpy(is_single ? static_cast<void*>(&narrow) : &number, bytes.data() + at, size);
      if (is_single) number = static_cast<double>(narrow);
      at += size;
    }
    check_finite(path, name, numbers);
    if (name != "fixed") {
      transforms.push_back({name, numbers, {}});
    } else if (!transforms.empty()) {
      transforms.back().fixed = numbers;
    }
  }
  return transforms;
}

bool is_itk_hdf5(const std::string& path) {
  const h5::Silence silence;
  try {
    return h5::is_group(h5::open_file(path), "TransformGroup");
  } catch (const IoError&) {
    return false;
  }
}

std::vector<ItkTransform> read_itk_hdf5(const std::string& path) {
  const h5::Silence silence;
  const h5::Object all = h5::open_group(h5::open_file(path), "TransformGroup");
  std::vector<ItkTransform> transforms;
  for (std::size_t n = 0; h5::has_child(all, std::to_string(n)); ++n) {
    const h5::Object group = h5::open_group(all, std::to_string(n));
    ItkTransform transform;
    transform.type = h5::read_text(h5::open_dataset(group, "TransformType"));
    auto parameters = hdf5_dataset(group, "TransformParameters", "TranformParameters");
    const auto fixed = hdf5_dataset(group, "TransformFixedParameters", "TranformFixedParameters");
    if (fixed) transform.fixed = finite_reals(*fixed);
    if (parameters && is_itk_field(transform.type)) {
      set_stored(std::move(*parameters), transform);
    } else if (parameters) {
      transform.parameters = finite_reals(*parameters);
    }
    transforms.push_back(std::move(transform));
  }
  return transforms;
}

}  // namespace tetwarp
