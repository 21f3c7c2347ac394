#include "bench/warp/truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "bench/warp/workloads.hpp"
#include "host/base/counter_hash.hpp"
#include "host/base/pixel_dispatch.hpp"
#include "host/reference/warp/exact_geometry.hpp"

namespace tetwarp::bench {
namespace {
using namespace reference;

constexpr std::int64_t complete_up_to = 128 * 128 * 128;
constexpr std::int64_t sampled_voxels = 100'000;
constexpr std::int64_t bin_edge = 16;

std::array<std::int64_t, 3> voxel_at(const Grid& grid, std::int64_t index) {
  return {index % grid.dims[0], index / grid.dims[0] % grid.dims[1],
          index / (grid.dims[0] * grid.dims[1])};
}

/// The voxels of a truth by cubes of 16^3 output voxels.
class Bins {
 public:
  Bins(const Grid& grid, const std::vector<std::int64_t>& voxels) : grid_(grid) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      dims_[axis] = (grid.dims[axis] + bin_edge - 1) / bin_edge;
    }
    members_.resize(static_cast<std::size_t>(dims_[0] * dims_[1] * dims_[2]));
    for (std::size_t v = 0; v < voxels.size(); ++v) {
      const auto at = voxel_at(grid, voxels[v]);
      members_[bin(at[0] / bin_edge, at[1] / bin_edge, at[2] / bin_edge)].push_back(v);
    }
  }

  /// visit(v) for every voxel number v of the bins that a tetrahedron's box touches.
  template <class Visit>
  void visit_box(const Corners& tet, const Visit& visit) const {
    std::int64_t first[3], last[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::int64_t low = tet[0][axis], high = low;
      for (const Quanta& node : tet) {
        low = std::min(low, node[axis]);
        high = std::max(high, node[axis]);
      }
      const std::int64_t bin_quanta = bin_edge * one_voxel_int;
      if (high < 0 || low > grid_.dims[axis] * one_voxel_int) return;
      first[axis] = std::max(low, std::int64_t{0}) / bin_quanta;
      last[axis] = std::min(high / bin_quanta, dims_[axis] - 1);
    }
    for (std::int64_t k = first[2]; k <= last[2]; ++k) {
      for (std::int64_t j = first[1]; j <= last[1]; ++j) {
        for (std::int64_t i = first[0]; i <= last[0]; ++i) {
          for (const std::size_t v : members_[bin(i, j, k)]) visit(v);
        }
      }
    }
  }

 private:
  std::size_t bin(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>((k * dims_[1] + j) * dims_[0] + i);
  }

  const Grid& grid_;
  std::array<std::int64_t, 3> dims_;
  std::vector<std::vector<std::size_t>> members_;
};

std::vector<std::int64_t> chosen_voxels(const Grid& output, bool all) {
  std::vector<std::int64_t> voxels(
      static_cast<std::size_t>(all ? output.voxel_count() : sampled_voxels));
  for (std::size_t v = 0; v < voxels.size(); ++v) {
    voxels[v] =
        all ? static_cast<std::int64_t>(v)
            : static_cast<std::int64_t>(unit_of(v) * static_cast<double>(output.voxel_count()));
  }
  return voxels;
}

Point3 source_position(const Corners& rest,
                       const Corners& now,
                       const Quanta& at,
                       const Eigen::Vector4d& weight) {
  const std::optional<Eigen::Vector3d> shift = whole_shift(rest, now);
  Point3 position{0, 0, 0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (shift) {
      position[axis] =
          static_cast<double>(at[axis]) / one_voxel + (*shift)(static_cast<Eigen::Index>(axis));
      continue;
    }
    for (std::size_t node = 0; node < 4; ++node) {
      position[axis] += weight(static_cast<Eigen::Index>(node)) *
                        static_cast<double>(rest[node][axis]) / one_voxel;
    }
  }
  return position;
}

bool is_in_box(const Corners& tet, const Quanta& at) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::minmax({tet[0][axis], tet[1][axis], tet[2][axis], tet[3][axis]});
    if (at[axis] < low || at[axis] > high) return false;
  }
  return true;
}
}  // namespace

Truth make_truth(const scenes::Scene& scene) {
  const Grid& grid = scene.output_grid;
  Truth truth;
  truth.is_complete = scene.source_grid.voxel_count() <= complete_up_to;
  truth.voxels = chosen_voxels(grid, truth.is_complete);
  truth.owners.assign(truth.voxels.size(), -1);
  truth.positions.assign(truth.voxels.size(), Point3{0, 0, 0});
  const Bins bins(grid, truth.voxels);
  const IndexSpace output(grid), source(scene.source_grid);
  for (std::size_t t = 0; t < scene.mesh.tets.size(); ++t) {
    Corners now, rest;
    for (std::size_t node = 0; node < 4; ++node) {
      const auto n = static_cast<std::size_t>(scene.mesh.tets[t][node]);
      now[node] = output.quanta_of(scene.deformed[n].data());
      rest[node] = source.quanta_of(scene.mesh.rest_positions[n].data());
    }
    if (signed_volume(now) == 0) continue;
    bins.visit_box(now, [&](std::size_t v) {
      if (truth.owners[v] >= 0) return;  // the lowest tetrahedron owns it
      Quanta at = voxel_at(grid, truth.voxels[v]);
      for (std::int64_t& x : at) x *= one_voxel_int;
      if (!is_in_box(now, at)) return;
      const std::optional<Barycentric> b = barycentric_of(now, at);
      if (!b) return;
      truth.owners[v] = static_cast<std::int32_t>(t);
      truth.positions[v] = source_position(rest, now, at, b->weight);
    });
  }
  return truth;
}

std::optional<double> sample_truth(const VolumeView& source,
                                   Filter filter,
                                   const Point3& position,
                                   int component) {
  std::array<std::int64_t, 3> low;
  std::array<double, 3> fraction;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double x = position[axis];
    const auto dims = static_cast<double>(source.grid.dims[axis]);
    if (!(x >= -0.5 - rim && x <= dims - 0.5 + rim)) return std::nullopt;
    const double whole = std::floor(filter == Filter::nearest ? x + 0.5 : x);
    if (filter == Filter::nearest && std::abs(x - whole) > 0.5 - 1e-4) return std::nullopt;
    low[axis] = static_cast<std::int64_t>(whole);
    fraction[axis] = filter == Filter::nearest ? 0.0 : x - whole;
  }
  double sum = 0;
  with_pixel_type(source.type, [&]<class T>(T) {
    for (unsigned corner = 0; corner < 8; ++corner) {
      double weight = 1;
      std::int64_t offset = 0;
      for (std::size_t axis = 3; axis-- > 0;) {
        const std::int64_t upper = corner >> axis & 1;
        weight *= upper != 0 ? fraction[axis] : 1 - fraction[axis];
        const std::int64_t i =
            std::clamp(low[axis] + upper, std::int64_t{0}, source.grid.dims[axis] - 1);
        offset = offset * source.grid.dims[axis] + i;
      }
      sum += weight * static_cast<double>(static_cast<const T*>(
                          source.data)[offset * source.components + component]);
    }
  });
  return sum;
}

double error_between(double value, double expected) {
  const double distance = std::abs(value - expected);
  return std::isnan(distance) ? std::numeric_limits<double>::infinity() : distance;
}

Accuracy compare(const Truth& truth,
                 const VolumeView& source,
                 Filter filter,
                 const void* output,
                 const std::int32_t* owner) {
  Accuracy accuracy;
  std::int64_t valued = 0;
  double squares = 0;
  with_pixel_type(source.type, [&]<class T>(T) {
    for (std::size_t v = 0; v < truth.voxels.size(); ++v) {
      const std::int32_t expected_owner = truth.owners[v], given = owner[truth.voxels[v]];
      const T* const values = static_cast<const T*>(output) + truth.voxels[v] * source.components;
      const bool is_blank =
          std::all_of(values, values + source.components, [](T value) { return value == T{0}; });
      accuracy.holes += expected_owner >= 0 && given < 0;
      accuracy.painted += expected_owner < 0 && (given >= 0 || !is_blank);
      accuracy.doubles += expected_owner >= 0 && given >= 0 && given != expected_owner;
      for (int c = 0; expected_owner >= 0 && c < source.components; ++c) {
        const std::optional<double> expected = sample_truth(source, filter, truth.positions[v], c);
        if (!expected) continue;
        ++valued;
        const double error =
            error_between(static_cast<double>(values[c]), *expected) / range_of(source.type);
        accuracy.max_error = std::max(accuracy.max_error, error);
        squares += error * error;
      }
    }
  });
  accuracy.compared = static_cast<std::int64_t>(truth.voxels.size());
  if (valued > 0) accuracy.rms_error = std::sqrt(squares / static_cast<double>(valued));
  return accuracy;
}

double error_bound(PixelType type, Filter filter) {
  if (filter == Filter::nearest) return 0;
  // Positions are good to 1e-5 voxel in float32 and neighbors differ by less than the range.
  if (type == PixelType::float64) return 1e-9;
  return is_integer(type) ? 0.5 / range_of(type) + 1e-5 : 1e-5;
}

std::optional<std::string> fault_of(const Accuracy& accuracy,
                                    double bound,
                                    const Counts& counts,
                                    const scenes::Scene& scene,
                                    const std::int32_t* owner) {
  if (accuracy.compared == 0) return "nothing was compared";
  if (accuracy.holes + accuracy.painted + accuracy.doubles > 0) {
    return fmt::format("{} holes, {} painted and {} doubly covered voxels", accuracy.holes,
                       accuracy.painted, accuracy.doubles);
  }
  if (!(accuracy.max_error <= bound)) {
    return fmt::format("error {:.2g} of the range, at most {:.2g} is right", accuracy.max_error,
                       bound);
  }
  const std::int64_t voxels = scene.output_grid.voxel_count();
  const std::int64_t owned = voxels - std::count(owner, owner + voxels, -1);
  if (counts.covered != owned) {
    return fmt::format("counted {} covered voxels, but {} have an owner", counts.covered, owned);
  }
  if (counts.voxels != voxels || counts.covered + counts.outside != voxels ||
      counts.tetrahedra != static_cast<std::int64_t>(scene.mesh.tets.size()) ||
      counts.pairs_rejected + counts.pairs_accepted + counts.pairs_partial !=
          counts.candidate_pairs ||
      counts.exact_tests > counts.inside_tests) {
    return "counters that contradict each other";
  }
  return std::nullopt;
}

}  // namespace tetwarp::bench
