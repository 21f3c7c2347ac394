/// @file warp_cases.cpp
#include "bench/warp_cases.hpp"

#include <algorithm>

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
  void add_with_and_without_culling(WarpCase row) {
    add(row);
    row.without = "culling";
    for (const SkipVariant& variant : skip_variants()) {
      if (variant.name == row.without) row.skip = variant.skip;
    }
    add(row);
  }
  /// Rows of one input stand together, so that it is made once.
  std::vector<WarpCase> sorted() && {
    std::stable_sort(rows_.begin(), rows_.end(), [](const WarpCase& a, const WarpCase& b) {
      return a.workload.name < b.workload.name;
    });
    return std::move(rows_);
  }

 private:
  std::vector<WarpCase> rows_;
};

}  // namespace

std::vector<SkipVariant> skip_variants() {
  return {{"culling", {.rejected_cells = false, .accepted_cells = false}},
          {"rejected_cells", {.rejected_cells = false}},
          {"accepted_cells", {.accepted_cells = false}},
          {"copied_voxels", {.copied_voxels = false}},
          {"constant_cells", {.constant_cells = false}}};
}

std::string name_of(const WarpCase& row) {
  std::string name = row.workload.name + (row.image == Image::in_air ? "_in_air" : "") +
                     (row.filter == Filter::nearest ? "/nearest/" : "/linear/") +
                     name_of(row.type) + "/" + name_of(row.backend);
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
    // One step of every workload; time against volume size and against tetrahedra.
    for (const Workload& workload : {ties_128(), torso_700(), fish_35()}) {
      rows.add({.workload = workload, .backend = backend, .threads = threads});
    }
    for (const std::int64_t n : {128, 256, 384, 512}) {
      if (n == 512 && !full) continue;
      rows.add_with_and_without_culling(
          {.workload = rotated(n), .backend = backend, .threads = threads});
    }
    for (const int tets : waved_tet_counts) {
      rows.add_with_and_without_culling(
          {.workload = waved(256, tets), .backend = backend, .threads = threads});
    }
    // Filters and pixel types.
    for (const Workload& workload : {rotated(256), torso_700(), waved(256, 5000)}) {
      for (const Filter filter : filters) {
        for (const PixelType type : types) {
          if (!full && workload.name != rotated(256).name) continue;
          rows.add({workload, filter, type, backend, threads});
        }
      }
    }
    // What each skip saves, on a workload that has something to skip and on one that has not.
    for (const Workload& workload : {ties_128(), rotated(256), waved(256, 50000)}) {
      for (const Image image : {Image::textured, Image::in_air}) {
        WarpCase row{.workload = workload, .backend = backend, .threads = threads, .image = image};
        rows.add(row);
        for (const SkipVariant& variant : skip_variants()) {
          row.without = variant.name;
          row.skip = variant.skip;
          // Only air around the image makes cells constant.
          const bool matters = (image == Image::in_air) == (variant.name == "constant_cells");
          if (full || matters) rows.add(row);
        }
      }
    }
  }
  for (const int count : thread_counts(threads)) {
    for (const Workload& workload :
         {torso_700(), rotated(256), waved(256, 5000), waved(256, 500000)}) {
      rows.add({.workload = workload, .threads = count});
    }
  }
  if (full) rows.add({.workload = rotated(128), .backend = Backend::reference});
  return std::move(rows).sorted();
}

}  // namespace tetwarp::bench
