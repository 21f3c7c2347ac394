#include "bench/warp/step_cases.hpp"

#include <algorithm>
#include <tuple>

#include "bench/warp/figure_cases.hpp"

namespace tetwarp::bench {
namespace {
constexpr Filter filters[] = {Filter::nearest, Filter::linear};
constexpr PixelType types[] = {PixelType::uint8, PixelType::int16, PixelType::float32,
                               PixelType::float64};

/// 1, 2, 4, ... up to all threads.
std::vector<int> thread_counts(int threads) {
  std::vector<int> counts;
  for (int count = 1; count < threads; count *= 2) counts.push_back(count);
  counts.push_back(threads);
  return counts;
}

/// Rows without duplicates: several plots use the same row.
class Rows {
 public:
  void add(const StepCase& row) {
    const auto same = [&](const StepCase& other) { return name_of(other) == name_of(row); };
    if (std::none_of(rows_.begin(), rows_.end(), same)) rows_.push_back(row);
  }
  void add_without(StepCase row, const SkipVariant& variant) {
    row.without = variant.name;
    row.skip = variant.skip;
    add(row);
  }
  /// Rows of one input follow each other, so that it is made once.
  std::vector<StepCase> sorted() && {
    std::stable_sort(rows_.begin(), rows_.end(), [](const StepCase& a, const StepCase& b) {
      const auto input = [](const StepCase& row) {
        return std::tie(row.workload.name, row.image, row.type, row.components);
      };
      return input(a) < input(b);
    });
    return std::move(rows_);
  }

 private:
  std::vector<StepCase> rows_;
};

/// One step of every workload; time against volume size and against tetrahedra, with and without
/// culling.
void add_workloads(Rows& rows, StepCase row, bool full) {
  for (const Workload& workload : {ties_128(), torso_700(), fish_35(), orange_160()}) {
    row.workload = workload;
    rows.add(row);
  }
  const SkipVariant no_culling = skip_variants().front();
  for (const Workload& workload : figure_workloads()) {
    row.workload = workload;
    const bool is_small = workload.dims[0] <= 256;
    const bool is_middle = workload.dims[0] == 384 && workload.tet_count() == 1080;
    if (full || is_small || is_middle) rows.add(row);
    if (full || is_small) rows.add_without(row, no_culling);
  }
  for (const int tets : waved_tet_counts) {
    row.workload = waved(256, tets);
    rows.add(row);
    rows.add_without(row, no_culling);
  }
}

/// The paper's culling by masks of grid points, in place of two corners per face.
void add_masks(Rows& rows, StepCase row) {
  for (const Workload& workload : {torso_700(), fish_35(), rotated(256), waved(256, 5000),
                                   waved(256, 50000), waved(256, 500000)}) {
    row.workload = workload;
    rows.add_without(row, {"two_corners", {.grid_point_masks = true}});
  }
}

/// Filters, pixel types, components.
void add_types(Rows& rows, StepCase row, bool full) {
  for (const Workload& workload : {torso_700(), rotated(256), waved(256, 5000)}) {
    const bool is_small = workload.name == torso_700().name;
    const bool is_large = workload.name == rotated(256).name;
    row.workload = workload;
    for (const PixelType type : types) {
      row.type = type;
      for (const Filter filter : filters) {
        row.filter = filter;
        const bool is_shown = filter == Filter::linear && is_integer(type) && is_large;
        if (full || is_small || is_shown) rows.add(row);
      }
      row.filter = Filter::linear;
      row.components = 3;
      if (full || (is_small && size_of(type) != 2)) rows.add(row);
      row.components = 1;
    }
  }
}

/// The input has work that the switch leaves out; culling as a whole is measured by
/// add_workloads().
bool has_work_for(const StepCase& row, const SkipVariant& variant) {
  const bool is_shifted = row.workload.deformation == Deformation::shift;
  const bool has_large_tets = row.workload.tet_count() < 100;
  if (has_large_tets != (variant.name == "accepted_cells")) return false;
  if (variant.name == "constant_cells") return row.image == Image::in_air && !is_shifted;
  if (row.image == Image::in_air || variant.name == "culling") return false;
  return (variant.name == "copied_voxels") == is_shifted;
}

/// What each switch saves: in the brief list where the input has work that it leaves out, in the
/// full list everywhere.
void add_skips(Rows& rows, StepCase row, bool full) {
  for (const Workload& workload : {shifted_256(), rotated(256), waved(256, 50000), fish_35()}) {
    for (const Image image : {Image::textured, Image::in_air}) {
      row.workload = workload;
      row.image = image;
      for (const SkipVariant& variant : skip_variants()) {
        if (full || has_work_for(row, variant)) rows.add_without(row, variant);
      }
    }
  }
}
}  // namespace

std::vector<SkipVariant> skip_variants() {
  return {{"culling", {.rejected_cells = false, .accepted_cells = false}},
          {"rejected_cells", {.rejected_cells = false}},
          {"accepted_cells", {.accepted_cells = false}},
          {"copied_voxels", {.copied_voxels = false}},
          {"constant_cells", {.constant_cells = false}}};
}

std::string name_of(const StepCase& row) {
  std::string name = row.workload.name + (row.image == Image::in_air ? "_in_air" : "") + "/" +
                     name_of(row.filter) + "/" + name_of(row.type);
  if (row.components > 1) name += "x" + std::to_string(row.components);
  name += "/" + place_of(row.backend, row.threads);
  if (!row.without.empty()) name += "/without:" + row.without;
  return name;
}

std::vector<Backend> Selection::backends() const {
  if (with_cuda) return {Backend::cpu, Backend::cuda};
  return {Backend::cpu};
}

std::string place_of(Backend backend, int threads) {
  const std::string name = name_of(backend);
  return backend == Backend::cpu ? name + "/threads:" + std::to_string(threads) : name;
}

Protocol protocol_for(Backend backend, int threads, double seconds) {
  Protocol protocol{.busy_threads = backend == Backend::cpu ? static_cast<double>(threads) : 0.0};
  if (seconds > 1) protocol.repetitions = protocol.attempts = seconds > 10 ? 1 : 3;
  return protocol;
}

std::vector<StepCase> step_cases(const Selection& selection) {
  const bool full = selection.is_full();
  Rows rows;
  for (const Backend backend : selection.backends()) {
    const StepCase row{.workload = torso_700(), .backend = backend, .threads = selection.threads};
    add_workloads(rows, row, full);
    add_masks(rows, row);
    add_types(rows, row, full);
    add_skips(rows, row, full);
  }
  for (const int count : thread_counts(selection.threads)) {
    for (const Workload& workload :
         {torso_700(), waved(256, 5000), rotated(256), waved(256, 500000)}) {
      const bool is_short = workload.name != rotated(256).name && workload.tet_count() <= 5000;
      if (full || is_short) rows.add({.workload = workload, .threads = count});
    }
  }
  if (full) rows.add({.workload = rotated(128), .backend = Backend::reference});
  return std::move(rows).sorted();
}

}  // namespace tetwarp::bench
