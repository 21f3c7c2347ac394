/// @file series_reader.cpp
/// Opens datasets by their paths.
#include "io/vtkhdf/series_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tetwarp/error.hpp>

#include "io/h5/h5_attribute.hpp"
#include "io/h5/h5_read.hpp"

namespace tetwarp {

struct SeriesReader::State {
  h5::Object file;
  std::int64_t first_step = 0;
};

SeriesReader::SeriesReader(const std::string& path) {
  const h5::Silence silence;
  h5::Object file = h5::open_file(path);
  if (!h5::has_attribute(file, "first_step") || !h5::has_child(file, "time")) {
    throw IoError(path, "", "is no series of a simulation, expected a series.h5");
  }
  const std::int64_t first_step = h5::read_integer_attribute(file, "first_step", 1).front();
  state_ = std::make_unique<State>(State{std::move(file), first_step});
}

SeriesReader::SeriesReader(SeriesReader&&) noexcept = default;
SeriesReader::~SeriesReader() = default;

std::int64_t SeriesReader::first_step() const {
  return state_->first_step;
}

std::vector<std::string> SeriesReader::paths_of(const std::string& name) const {
  const h5::Silence silence;
  if (!h5::is_group(state_->file, name)) {
    h5::open_dataset(state_->file, name);  // its errors
    return {name};
  }
  const h5::Object group = h5::open_group(state_->file, name);
  std::vector<std::string> paths;
  for (const std::string& child : h5::child_names(group)) {
    if (!h5::is_group(group, child)) paths.push_back(name + "/" + child);
  }
  if (paths.empty()) {
    std::string there;
    for (const std::string& child : h5::child_names(group)) there += " " + name + "/" + child;
    throw IoError(state_->file.file, name, "is a group of groups; name one of" + there);
  }
  return paths;
}

std::vector<double> SeriesReader::read(const std::string& path) const {
  const h5::Silence silence;
  const h5::Dataset dataset = h5::open_dataset(state_->file, path);
  if (!h5::is_numeric(dataset) || dataset.dims.empty() || dataset.dims.size() > 2) {
    dataset.fail("expected numbers of shape [row] or [row][component]");
  }
  const std::size_t rows = static_cast<std::size_t>(dataset.rows());
  const std::size_t width =
      dataset.dims.size() == 1 ? 1 : static_cast<std::size_t>(dataset.dims[1]);
  // As doubles, since products of integers may overflow.
  h5::check_memory(dataset.file, dataset.name,
                   8.0 * static_cast<double>(rows) * (static_cast<double>(width) + 1));
  std::vector<double> numbers(rows * width);
  const std::array<std::int64_t, 2> start{0, 0};
  if (!numbers.empty()) {
    h5::read_block(dataset, H5T_NATIVE_DOUBLE, {start.data(), dataset.dims.size()}, dataset.dims,
                   numbers.data());
  }
  if (dataset.dims.size() == 1) return numbers;
  std::vector<double> lengths(rows, 0.0);
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    lengths[n / width] = std::hypot(lengths[n / width], numbers[n]);
  }
  return lengths;
}

}  // namespace tetwarp
