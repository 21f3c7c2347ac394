/// @file warp.cpp
/// Back end reference: the warp straight from its definition. Every tetrahedron over its bounding
/// box, ownership by determinants in exact integers, values in float64; serial, no culling, no
/// filter. It shares no line with the kernels it is the judge of.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <tetwarp/error.hpp>
#include <vector>

#include "host/pixel_dispatch.hpp"
#include "host/reference/exact_geometry.hpp"
#include "host/reference/fields.hpp"
#include "host/reference/sample.hpp"
#include "host/warp_backend.hpp"

namespace tetwarp {

namespace {

using namespace reference;

class ReferenceBackend : public WarpBackend {
 public:
  explicit ReferenceBackend(const WarpPlan& plan)
      : plan_(plan), output_(plan.output_grid), source_(plan.sources.front().grid) {}

  std::string device() const override { return processor_name(); }
  int threads() const override { return 1; }

  void upload(int flight, const PositionsView& deformed) override {
    positions_[flight].assign(deformed.xyz, deformed.xyz + 3 * deformed.node_count);
  }

  void compute(int flight, const WarpTarget& target, const Progress& progress) override {
    const auto start = std::chrono::steady_clock::now();
    const std::size_t voxels = static_cast<std::size_t>(plan_.target_grid.voxel_count());
    StepReport& report = reports_[flight];
    report = {};
    const double* const rest = plan_.mesh.rest_positions.front().data();
    const double* const deformed = positions_[flight].data();
    claim_all(rest, deformed, report.counts, progress);
    for (std::size_t s = 0; s < plan_.sources.size(); ++s) {
      with_pixel_type(plan_.sources[s].type,
                      [&]<class T>(T) { fill<T>(s, static_cast<T*>(target.volumes[s])); });
    }
    for (std::size_t v = 0; v < voxels; ++v) {
      report.counts.covered += owner_[v] >= 0;
      if (target.mask != nullptr) target.mask[v] = owner_[v] >= 0;
      if (target.tet != nullptr) target.tet[v] = owner_[v];
    }
    for (const std::uint8_t count : strictly_inside_) report.counts.folded += count > 1;
    report.counts.voxels = static_cast<std::int64_t>(voxels);
    report.counts.outside = report.counts.voxels - report.counts.covered;
    report.counts.tetrahedra = static_cast<std::int64_t>(plan_.mesh.tets.size());
    write_fields(rest, deformed, target.fields);
    if (target.fields.forward != nullptr) {
      Counts exchanged;
      claim_all(deformed, rest, exchanged, {});
      write_displacement(target.fields.forward);
    }
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    report.timings.raster = passed.count();
    if (progress && !progress(1.0)) throw Cancelled();
  }

  StepReport finish(int flight) override { return reports_[flight]; }

 private:
  /// Finds the owner of every voxel and its source position.
  void claim_all(const double* rest,
                 const double* deformed,
                 Counts& counts,
                 const Progress& progress) {
    const auto voxels = static_cast<std::size_t>(plan_.target_grid.voxel_count());
    owner_.assign(voxels, -1);
    source_position_.assign(voxels, Eigen::Vector3d::Zero());
    strictly_inside_.assign(plan_.options.count_folded ? voxels : 0, 0);
    const auto tets = static_cast<std::int32_t>(plan_.mesh.tets.size());
    for (std::int32_t t = 0; t < tets; ++t) {
      claim(t, rest, deformed, counts);
      if (progress && t % 64 == 0 && !progress(0.5 * t / tets)) throw Cancelled();
    }
  }

  Corners corners_of(std::int32_t t, const double* positions, const IndexSpace& space) const {
    Corners corners;
    for (std::size_t node = 0; node < 4; ++node) {
      const auto n = static_cast<std::size_t>(plan_.mesh.tets[static_cast<std::size_t>(t)][node]);
      corners[node] = space.quanta_of(positions + 3 * n);
    }
    return corners;
  }

  /// Gives tetrahedron t every voxel of its closed shape that no lower one owns.
  void claim(std::int32_t t, const double* rest_positions, const double* deformed, Counts& counts) {
    const Corners now = corners_of(t, deformed, output_);
    const Corners rest = corners_of(t, rest_positions, source_);
    check_extent(now);
    check_extent(rest);
    const Integer volume = signed_volume(now);
    if (volume == 0) {
      ++counts.flat;
      return;
    }
    const bool mirrored = output_.to_world.determinant() * source_.to_world.determinant() < 0;
    const Integer rest_volume = mirrored ? -signed_volume(rest) : signed_volume(rest);
    counts.inverted += (volume > 0 && rest_volume < 0) || (volume < 0 && rest_volume > 0);

    Quanta first, last;  // voxels of the box, within the region
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::int64_t low = now[0][axis], high = low;
      for (const Quanta& node : now) {
        low = std::min(low, node[axis]);
        high = std::max(high, node[axis]);
      }
      const auto begin = static_cast<std::int64_t>(std::ceil(static_cast<double>(low) / one_voxel));
      const auto end = static_cast<std::int64_t>(std::floor(static_cast<double>(high) / one_voxel));
      first[axis] = std::max(begin, plan_.region.begin[axis]);
      last[axis] = std::min(end, plan_.region.end[axis] - 1);
    }
    const std::optional<Eigen::Vector3d> shift = whole_shift(rest, now);
    for (std::int64_t k = first[2]; k <= last[2]; ++k) {
      for (std::int64_t j = first[1]; j <= last[1]; ++j) {
        for (std::int64_t i = first[0]; i <= last[0]; ++i) {
          ++counts.inside_tests;
          const std::optional<Barycentric> b =
              barycentric_of(now, {i * one_voxel_int, j * one_voxel_int, k * one_voxel_int});
          if (!b) continue;
          const std::size_t v = voxel_at(i, j, k);
          if (!strictly_inside_.empty() && !b->on_face && strictly_inside_[v] < 2) {
            ++strictly_inside_[v];
          }
          if (owner_[v] >= 0) continue;
          owner_[v] = t;
          source_position_[v] =
              shift
                  ? Eigen::Vector3d(Eigen::Vector3d(static_cast<double>(i), static_cast<double>(j),
                                                    static_cast<double>(k)) +
                                    *shift)
                  : combined(rest, b->weight);
        }
      }
    }
  }

  /// sum_i b_i R_i [voxel]
  static Eigen::Vector3d combined(const Corners& rest, const Eigen::Vector4d& weight) {
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    for (std::size_t node = 0; node < 4; ++node) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        x(static_cast<Eigen::Index>(axis)) += weight(static_cast<Eigen::Index>(node)) *
                                              (static_cast<double>(rest[node][axis]) / one_voxel);
      }
    }
    return x;
  }

  std::size_t voxel_at(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const Region& r = plan_.region;
    const std::array<std::int64_t, 3>& n = plan_.target_grid.dims;
    return static_cast<std::size_t>(((k - r.begin[2]) * n[1] + (j - r.begin[1])) * n[0] +
                                    (i - r.begin[0]));
  }

  template <class T>
  void fill(std::size_t s, T* out) const {
    const Sampler<T> sampler(plan_.sources[s], plan_.options);
    std::size_t v = 0;
    for (std::int64_t k = plan_.region.begin[2]; k < plan_.region.end[2]; ++k) {
      for (std::int64_t j = plan_.region.begin[1]; j < plan_.region.end[1]; ++j) {
        for (std::int64_t i = plan_.region.begin[0]; i < plan_.region.end[0]; ++i, ++v) {
          T* voxel = out + v * static_cast<std::size_t>(sampler.components());
          if (owner_[v] >= 0) {
            sampler.store(source_position_[v], voxel);
          } else if (plan_.options.outside == Outside::identity) {
            sampler.store(same_place(i, j, k), voxel);
          } else {
            std::fill_n(voxel, sampler.components(), sampler.background());
          }
        }
      }
    }
  }

  /// Calls body(v, index) for every voxel of the region.
  template <class Body>
  void for_each_voxel(const Body& body) const {
    std::size_t v = 0;
    for (std::int64_t k = plan_.region.begin[2]; k < plan_.region.end[2]; ++k) {
      for (std::int64_t j = plan_.region.begin[1]; j < plan_.region.end[1]; ++j) {
        for (std::int64_t i = plan_.region.begin[0]; i < plan_.region.end[0]; ++i, ++v) {
          body(v, Eigen::Vector3d(static_cast<double>(i), static_cast<double>(j),
                                  static_cast<double>(k)));
        }
      }
    }
  }

  /// Where the material of each voxel comes from, less the voxel's own place.
  void write_displacement(float* displacement) const {
    for_each_voxel([&](std::size_t v, const Eigen::Vector3d& index) {
      Eigen::Vector3d apart = Eigen::Vector3d::Zero();
      if (owner_[v] >= 0) {
        apart = source_.origin - output_.origin + source_.to_world * source_position_[v] -
                output_.to_world * index;
      }
      store({apart(0), apart(1), apart(2)}, v, displacement);
    });
  }

  void write_fields(const double* rest, const double* deformed, const FieldTarget& fields) const {
    if (fields.displacement != nullptr) write_displacement(fields.displacement);
    if (fields.jacobian == nullptr && fields.gradient == nullptr && fields.strain == nullptr)
      return;
    for (std::size_t v = 0; v < owner_.size(); ++v) {
      Eigen::Matrix3d f = Eigen::Matrix3d::Zero(), e = f;
      if (owner_[v] >= 0) {
        f = gradient_of(corners_of(owner_[v], rest, source_), source_,
                        corners_of(owner_[v], deformed, output_), output_);
        e = green_lagrange(f);
      }
      store({f.determinant()}, v, fields.jacobian);
      store({f(0, 0), f(0, 1), f(0, 2), f(1, 0), f(1, 1), f(1, 2), f(2, 0), f(2, 1), f(2, 2)}, v,
            fields.gradient);
      store({e(0, 0), e(1, 1), e(2, 2), e(0, 1), e(1, 2), e(0, 2)}, v, fields.strain);
    }
  }

  /// Source index of an output voxel's own world position; whole voxels within 2^-40 are whole.
  Eigen::Vector3d same_place(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const Eigen::Vector3d index(static_cast<double>(i), static_cast<double>(j),
                                static_cast<double>(k));
    const Eigen::Vector3d world_offset =
        output_.to_world * index + (output_.origin - source_.origin);
    Eigen::Vector3d x = source_.from_world * world_offset;
    for (double& entry : x) {
      if (std::abs(entry - std::nearbyint(entry)) < 0x1p-40) entry = std::nearbyint(entry);
    }
    return x;
  }

  WarpPlan plan_;
  std::vector<double> positions_[2];
  StepReport reports_[2];
  IndexSpace output_;
  IndexSpace source_;
  std::vector<std::int32_t> owner_;
  std::vector<Eigen::Vector3d> source_position_;
  std::vector<std::uint8_t> strictly_inside_;
};

}  // namespace

std::unique_ptr<WarpBackend> make_reference_backend(const WarpPlan& plan) {
  return std::make_unique<ReferenceBackend>(plan);
}

}  // namespace tetwarp
