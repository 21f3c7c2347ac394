/// @file warp_cases.cpp
#include "bench/warp_cases.hpp"

#include <algorithm>
#include <tuple>

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

/// Rows without duplicates: the same row serves several plots.
class Rows {
 public:
  void add(const WarpCase& row) {
    const auto same = [&](const WarpCase& other) { return name_of(other) == name_of(row); };
    if (std::none_of(rows_.begin(), rows_.end(), same)) rows_.push_back(row);
  }
  void add_without(WarpCase row, const SkipVariant& variant) {
    row.without = variant.name;
    row.skip = variant.skip;
    add(row);
  }
  /// Rows of one input stand together, so that it is made once.
  std::vector<WarpCase> sorted() && {
    std::stable_sort(rows_.begin(), rows_.end(), [](const WarpCase& a, const WarpCase& b) {
      const auto input = [](const WarpCase& row) {
        return std::tie(row.workload.name, row.image, row.type, row.components);
      };
      return input(a) < input(b);
    });
    return std::move(rows_);
  }

 private:
  std::vector<WarpCase> rows_;
};

/// One step of every workload; time against volume size and against tetrahedra, with and without
/// culling.
void add_workloads(Rows& rows, WarpCase row, bool full) {
  for (const Workload& workload : {ties_128(), torso_700(), fish_35()}) {
    row.workload = workload;
    rows.add(row);
  }
  const SkipVariant no_culling = skip_variants().front();
  for (const std::int64_t n : {128, 256, 384, 512}) {
    row.workload = rotated(n);
    if (full || n <= 384) rows.add(row);
    if (full || n <= 256) rows.add_without(row, no_culling);
  }
  for (const int tets : waved_tet_counts) {
    row.workload = waved(256, tets);
    rows.add(row);
    rows.add_without(row, no_culling);
  }
}

/// Filters, pixel types, components.
void add_types(Rows& rows, WarpCase row, bool full) {
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

/// A switch is on for work of this kind; culling as a whole is among the workloads' rows.
bool is_telling(const WarpCase& row, const SkipVariant& variant) {
  const bool is_shifted = row.workload.deformation == Deformation::shift;
  const bool has_large_tets = row.workload.tet_count() < 100;
  if (has_large_tets != (variant.name == "accepted_cells")) return false;
  if (variant.name == "constant_cells") return row.image == Image::in_air && !is_shifted;
  if (row.image == Image::in_air || variant.name == "culling") return false;
  return (variant.name == "copied_voxels") == is_shifted;
}

/// What each switch saves: in the short list where it has work to leave out, in the long one also
/// where it has none.
void add_skips(Rows& rows, WarpCase row, bool full) {
  for (const Workload& workload : {shifted_256(), rotated(256), waved(256, 50000), fish_35()}) {
    for (const Image image : {Image::textured, Image::in_air}) {
      row.workload = workload;
      row.image = image;
      for (const SkipVariant& variant : skip_variants()) {
        if (full || is_telling(row, variant)) rows.add_without(row, variant);
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

const char* name_of(Filter filter) {
  static constexpr const char* names[] = {"nearest", "linear",  "cubic",
                                          "bspline", "lanczos", "labels"};
  return names[static_cast<int>(filter)];
}

std::string name_of(const WarpCase& row) {
  std::string name = row.workload.name + (row.image == Image::in_air ? "_in_air" : "") + "/" +
                     name_of(row.filter) + "/" + name_of(row.type);
  if (row.components > 1) name += "x" + std::to_string(row.components);
  name += std::string("/") + name_of(row.backend);
  if (row.backend == Backend::cpu) name += "/threads:" + std::to_string(row.threads);
  if (!row.without.empty()) name += "/without:" + row.without;
  return name;
}

std::vector<WarpCase> warp_cases(Extent extent, int threads, bool with_cuda) {
  const bool full = extent == Extent::full;
  Rows rows;
  std::vector<Backend> backends = {Backend::cpu};
  if (with_cuda) backends.push_back(Backend::cuda);
  for (const Backend backend : backends) {
    const WarpCase row{.workload = torso_700(), .backend = backend, .threads = threads};
    add_workloads(rows, row, full);
    add_types(rows, row, full);
    add_skips(rows, row, full);
  }
  for (const int count : thread_counts(threads)) {
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
