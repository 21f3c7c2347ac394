#include "io/vtkhdf/simulation_series.hpp"

#include <cmath>
#include <map>
#include <tetwarp/error.hpp>

#include "io/h5/h5_disk.hpp"
#include "io/h5/h5_rows.hpp"

namespace tetwarp {
namespace {

hsize_t width_of(const SeriesColumn& column) {
  return column.components > 1 ? static_cast<hsize_t>(column.components) : 0;
}

/// The group that holds a column, and the name of the column in it.
struct Place {
  std::string group;  ///< empty: the root
  std::string name;
};
Place place_of(const SeriesColumn& column) {
  const std::size_t slash = column.path.rfind('/');
  if (slash == std::string::npos) return {"", column.path};
  return {column.path.substr(0, slash), column.path.substr(slash + 1)};
}

/// Groups by path, opened or created when first asked for.
class Groups {
 public:
  Groups(const h5::Object& file, bool creates) : file_(file), creates_(creates) {}

  const h5::Object& at(const std::string& path) {
    if (path.empty()) return file_;
    const auto found = groups_.find(path);
    if (found != groups_.end()) return found->second;
    const std::size_t slash = path.rfind('/');
    const bool is_top = slash == std::string::npos;
    const h5::Object& parent = at(is_top ? "" : path.substr(0, slash));
    const std::string name = is_top ? path : path.substr(slash + 1);
    return groups_
        .emplace(path, creates_ ? h5::create_group(parent, name) : h5::open_group(parent, name))
        .first->second;
  }

 private:
  const h5::Object& file_;
  bool creates_;
  std::map<std::string, h5::Object> groups_;
};
}  // namespace

struct SeriesWriter::State {
  std::string path;
  std::vector<SeriesColumn> columns;
  h5::Disk disk = {};
  std::vector<std::vector<double>> kept = {};  // values of each column that are not written yet
  std::size_t row_size = 0;
  std::int64_t first_step = 0;
  std::int64_t kept_rows = 0;  // of a file that was opened

  /// Changes all datasets. The file is closed before and after: HDF5 1.10 passes over the datasets
  /// of all open files whenever it flushes one.
  /// @param change  (dataset, number of the column)
  template <class Change>
  void change_datasets(const Change& change) {
    h5::Object file = h5::reopen_growing_file(path, disk);
    {
      Groups groups(file, false);
      for (std::size_t c = 0; c < columns.size(); ++c) {
        const Place place = place_of(columns[c]);
        h5::GrowingDataset dataset =
            h5::GrowingDataset::open(groups.at(place.group), place.name, width_of(columns[c]));
        change(dataset, c);
      }
    }
    h5::close_written(file, disk);
  }
};

SeriesWriter::SeriesWriter(std::unique_ptr<State> state) : state_(std::move(state)) {
  state_->kept.resize(state_->columns.size());
  for (const SeriesColumn& column : state_->columns) {
    state_->row_size += static_cast<std::size_t>(column.components);
  }
}

SeriesWriter::SeriesWriter(const std::string& path,
                           const std::vector<SeriesColumn>& columns,
                           std::int64_t first_step)
    : SeriesWriter([&] {
        const h5::Silence silence;
        auto state = std::make_unique<State>(State{path, columns});
        state->first_step = first_step;
        h5::Object file = h5::create_growing_file(path, state->disk);
        h5::write_scalar_attribute(file, "first_step", first_step);
        {
          Groups groups(file, true);
          for (const SeriesColumn& column : columns) {
            const Place place = place_of(column);
            h5::GrowingDataset::create(groups.at(place.group), place.name,
                                       column.is_integer ? H5T_STD_I64LE : H5T_IEEE_F64LE,
                                       width_of(column), h5::step_chunk);
          }
        }
        h5::close_written(file, state->disk);
        return state;
      }()) {}

SeriesWriter SeriesWriter::reopen(const std::string& path,
                                  const std::vector<SeriesColumn>& columns,
                                  std::int64_t step) {
  const h5::Silence silence;
  auto state = std::make_unique<State>(State{path, columns});
  const h5::Object file = h5::open_growing_file(path, state->disk);
  state->first_step = h5::read_integer_attribute(file, "first_step", 1).front();
  const std::int64_t rows = step - state->first_step + 1;
  Groups groups(file, false);
  for (const SeriesColumn& column : columns) {
    const Place place = place_of(column);
    const auto dataset =
        h5::GrowingDataset::open(groups.at(place.group), place.name, width_of(column));
    if (rows < 1 || dataset.rows() < static_cast<hsize_t>(rows)) {
      throw IoError(path, column.path,
                    "has no row of step " + std::to_string(step) +
                        ", where the checkpoint was written; name the folder of that run, or a "
                        "new one");
    }
  }
  state->kept_rows = rows;
  return SeriesWriter(std::move(state));
}

SeriesWriter::SeriesWriter(SeriesWriter&&) noexcept = default;

SeriesWriter::~SeriesWriter() {
  if (!state_) return;
  const h5::Silence silence;
  try {
    flush();
  } catch (const IoError&) {
    // The same error was thrown to a caller that flushed, or no caller is left.
  }
  state_.reset();
}

void SeriesWriter::drop_later() {
  const h5::Silence silence;
  const auto kept = static_cast<hsize_t>(state_->kept_rows);
  state_->change_datasets(
      [&](h5::GrowingDataset& dataset, std::size_t) { dataset.truncate(kept); });
}

std::int64_t SeriesWriter::first_step() const {
  return state_->first_step;
}

void SeriesWriter::append(std::span<const double> values) {
  if (values.size() != state_->row_size) {
    throw IoError(state_->path, "", "a row has another number of values than the columns");
  }
  const double* value = values.data();
  for (std::size_t v = 0; v < values.size(); ++v) {
    if (!std::isfinite(values[v])) {
      throw IoError(state_->path, "",
                    "a number of a step is not finite: the scene is unstable; choose a smaller "
                    "time_step");
    }
  }
  for (std::size_t c = 0; c < state_->columns.size(); ++c) {
    const auto count = state_->columns[c].components;
    state_->kept[c].insert(state_->kept[c].end(), value, value + count);
    value += count;
  }
}

void SeriesWriter::flush() {
  const h5::Silence silence;
  if (state_->kept.empty() || state_->kept.front().empty()) return;
  state_->change_datasets([&](h5::GrowingDataset& dataset, std::size_t c) {
    std::vector<double>& kept = state_->kept[c];
    const auto width = static_cast<std::size_t>(state_->columns[c].components);
    dataset.append(H5T_NATIVE_DOUBLE, kept.size() / width, kept.data());
    kept.clear();
  });
}

}  // namespace tetwarp
