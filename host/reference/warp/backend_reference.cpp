/// @file backend_reference.cpp
/// Back end reference: the warp straight from its definition, serially and without culling; values
/// in float64. It shares no code with the kernels that are tested against it.
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

#include "host/base/pixel_dispatch.hpp"
#include "host/base/warp_backend.hpp"
#include "host/reference/warp/fields.hpp"
#include "host/reference/warp/nearest_surface.hpp"
#include "host/reference/warp/overlap.hpp"
#include "host/reference/warp/ownership.hpp"
#include "host/reference/warp/sample.hpp"
#include "host/reference/warp/sample_transform.hpp"

namespace tetwarp {
namespace {
using namespace reference;

class ReferenceBackend : public WarpBackend {
 public:
  explicit ReferenceBackend(const WarpPlan& plan) : plan_(plan), owners_(plan_) {}

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
    owners_.claim_all(rest, deformed, report.counts, progress);
    make_rules(rest, deformed, report.counts);
    if (extends(plan_.options.outside)) find_extension(rest, deformed);
    for (std::size_t s = 0; s < plan_.sources.size(); ++s) {
      with_pixel_type(plan_.sources[s].type, [&]<class T>(T) {
        T* const out = static_cast<T*>(target.volumes[s]);
        fill<T>(s, out);
        if (plan_.options.intensity != Intensity::value && !plan_.options.source_window) {
          conserve(s, rest, deformed, out, report);
        }
        if (plan_.options.label_rule == LabelRule::volume) {
          const T* labels = static_cast<const T*>(plan_.sources[s].data);
          const std::vector<double> chosen =
              elected([&](std::int64_t v) { return static_cast<double>(labels[v]); },
                      plan_.sources[s].grid.dims, moved_tets(rest, deformed), plan_.region,
                      static_cast<double>(stored<T>(plan_.options.background)));
          std::ranges::transform(chosen, out, [](double label) { return static_cast<T>(label); });
        }
      });
    }
    for (std::size_t v = 0; v < voxels; ++v) {
      report.counts.covered += owners_.owner[v] >= 0;
      if (target.mask != nullptr) target.mask[v] = owners_.owner[v] >= 0;
      if (target.owner != nullptr) target.owner[v] = owners_.cell_of(owners_.owner[v]);
    }
    for (const std::uint8_t count : owners_.strictly_inside) report.counts.folded += count > 1;
    report.counts.voxels = static_cast<std::int64_t>(voxels);
    report.counts.outside = report.counts.voxels - report.counts.covered;
    report.counts.tetrahedra = static_cast<std::int64_t>(plan_.mesh.tets.size());
    write_fields(rest, deformed, target.fields);
    if (target.fields.forward != nullptr) {
      Counts exchanged;
      owners_.claim_all(deformed, rest, exchanged, {});
      write_displacement(target.fields.forward);
    }
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    report.timings.raster = passed.count();
    if (progress && !progress(1.0)) throw Cancelled();
  }

  StepReport finish(int flight) override { return reports_[flight]; }

 private:
  void make_rules(const double* rest, const double* deformed, Counts& counts) {
    transforms_.assign(plan_.mesh.tets.size(), SampleTransform());
    for (std::size_t t = 0; t < transforms_.size(); ++t) {
      const auto number = static_cast<std::int32_t>(t);
      const Corners now = owners_.corners_of(number, deformed, owners_.output);
      if (signed_volume(now) == 0) continue;
      transforms_[t] = transform_of(owners_.corners_of(number, rest, owners_.source), now,
                                    owners_.source, owners_.output, plan_.options);
      counts.tets_averaged += transforms_[t].averages();
    }
  }

  /// Displacements of the voxels that no tetrahedron covers.
  void find_extension(const double* rest, const double* deformed) {
    const NearestSurface surface(plan_, owners_, rest, deformed);
    extension_.assign(owners_.owner.size(), Eigen::Vector3d::Zero());
    for_each_voxel([&](std::size_t v, const Eigen::Vector3d& index) {
      if (owners_.owner[v] < 0) extension_[v] = surface.displacement(index);
    });
  }

  std::vector<MovedTet> moved_tets(const double* rest, const double* deformed) const {
    std::vector<MovedTet> tets;
    tets.reserve(plan_.mesh.tets.size());
    for (std::int32_t t = 0; t < std::ssize(plan_.mesh.tets); ++t) {
      tets.push_back({owners_.corners_of(t, rest, owners_.source),
                      owners_.corners_of(t, deformed, owners_.output)});
    }
    return tets;
  }

  /// Totals of source s and its output; with conservative intensity also the output itself.
  template <class T>
  void conserve(
      std::size_t s, const double* rest, const double* deformed, T* out, StepReport& report) const {
    const std::vector<MovedTet> tets = moved_tets(rest, deformed);
    const double source_voxel = std::abs(owners_.source.to_world.determinant());
    const double output_voxel = std::abs(owners_.output.to_world.determinant());
    if (plan_.options.intensity == Intensity::conservative) {
      for (const StoringChange& change :
           carry(plan_.sources[s], tets, plan_.region, plan_.output_grid.dims,
                 source_voxel / output_voxel, out)) {
        report.totals.rounding.push_back(change.rounding * output_voxel);
        report.totals.clipping.push_back(change.clipping * output_voxel);
        report.counts.values_clipped += change.clipped;
      }
    }
    const std::vector<double> before = total_held<T>(plan_.sources[s], tets);
    const auto components = static_cast<std::size_t>(plan_.sources[s].components);
    std::vector<double> after(components, 0.0);
    for (std::size_t n = 0; n < owners_.owner.size() * components; ++n) {
      after[n % components] += static_cast<double>(out[n]);
    }
    for (std::size_t c = 0; c < components; ++c) {
      report.totals.before.push_back(before[c] * source_voxel);
      report.totals.after.push_back(after[c] * output_voxel);
    }
  }

  template <class T>
  void fill(std::size_t s, T* out) const {
    const bool has_range =
        plan_.options.source_window && plan_.options.overshoot == Overshoot::clamp;
    const Sampler<T> sampler(plan_.sources[s], plan_.source_region, plan_.options,
                             has_range ? &plan_.options.source_window->ranges[s] : nullptr);
    std::size_t v = 0;
    for (std::int64_t k = plan_.region.begin[2]; k < plan_.region.end[2]; ++k) {
      for (std::int64_t j = plan_.region.begin[1]; j < plan_.region.end[1]; ++j) {
        for (std::int64_t i = plan_.region.begin[0]; i < plan_.region.end[0]; ++i, ++v) {
          T* voxel = out + v * static_cast<std::size_t>(sampler.components());
          if (owners_.owner[v] >= 0) {
            const SampleTransform& transform =
                transforms_[static_cast<std::size_t>(owners_.owner[v])];
            store_voxel(s, sampler, owners_.source_position[v], transform, voxel);
          } else if (plan_.options.outside == Outside::identity) {
            store_voxel(s, sampler, same_place(i, j, k), outside_transform(), voxel);
          } else if (extends(plan_.options.outside)) {
            const Eigen::Vector3d step = owners_.source.from_world * extension_[v];
            sampler.store(same_place(i, j, k) + step, voxel);
          } else {
            std::fill_n(voxel, sampler.components(), sampler.background());
          }
        }
      }
    }
  }

  /// Transform of voxels outside the mesh, which sample the source at their own position.
  SampleTransform outside_transform() const {
    SampleTransform transform;
    transform.step = owners_.source.from_world * owners_.output.to_world;
    if (plan_.options.antialias) transform.parts = parts_of(transform.step);
    return transform;
  }

  /// Writes one voxel: a sample, or the mean of samples at the midpoints of its parts, changed by
  /// its transform.
  template <class T>
  void store_voxel(std::size_t s,
                   const Sampler<T>& sampler,
                   const Eigen::Vector3d& x,
                   const SampleTransform& transform,
                   T* voxel) const {
    const WarpOptions& options = plan_.options;
    const Quantity quantity =
        options.quantities.empty() ? Quantity::components : options.quantities[s];
    const bool turns =
        quantity != Quantity::components && !transform.is_still && !transform.is_singular;
    if (!turns && !transform.averages() && transform.scale == 1) return sampler.store(x, voxel);
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(sampler.components());
    int count = 0;
    for (int c = 0; c < transform.parts(2); ++c) {
      for (int b = 0; b < transform.parts(1); ++b) {
        for (int a = 0; a < transform.parts(0); ++a) {
          const Eigen::Array3d part = Eigen::Vector3i(a, b, c).cast<double>();
          const Eigen::Array3d within = (part + 0.5) / transform.parts.cast<double>().array() - 0.5;
          count += sampler.add(x + transform.step * within.matrix(), mean);
        }
      }
    }
    if (count == 0) {
      std::fill_n(voxel, sampler.components(), sampler.background());
      return;
    }
    sampler.clamp(mean /= count);
    if (turns) mean = reoriented(mean, quantity, transform.forward);
    for (int c = 0; c < sampler.components(); ++c) voxel[c] = stored<T>(mean(c) * transform.scale);
  }

  /// Calls op(v, index) for every voxel of the region.
  template <class Op>
  void for_each_voxel(const Op& op) const {
    std::size_t v = 0;
    for (std::int64_t k = plan_.region.begin[2]; k < plan_.region.end[2]; ++k) {
      for (std::int64_t j = plan_.region.begin[1]; j < plan_.region.end[1]; ++j) {
        for (std::int64_t i = plan_.region.begin[0]; i < plan_.region.end[0]; ++i, ++v) {
          op(v, Eigen::Vector3d(static_cast<double>(i), static_cast<double>(j),
                                static_cast<double>(k)));
        }
      }
    }
  }

  /// Rest position of the material at each voxel minus the voxel's position [world].
  void write_displacement(float* displacement) const {
    for_each_voxel([&](std::size_t v, const Eigen::Vector3d& index) {
      Eigen::Vector3d apart = Eigen::Vector3d::Zero();
      if (owners_.owner[v] >= 0) {
        apart = owners_.source.origin - owners_.output.origin +
                owners_.source.to_world * owners_.source_position[v] -
                owners_.output.to_world * index;
      }
      store({apart(0), apart(1), apart(2)}, v, displacement);
    });
  }

  /// The same outside of the mesh.
  void write_extension(float* displacement) const {
    for_each_voxel([&](std::size_t v, const Eigen::Vector3d&) {
      const Eigen::Vector3d& u = extension_[v];
      if (owners_.owner[v] < 0) store({u(0), u(1), u(2)}, v, displacement);
    });
  }

  void write_fields(const double* rest, const double* deformed, const FieldTarget& fields) const {
    if (fields.displacement != nullptr) {
      write_displacement(fields.displacement);
      if (extends(plan_.options.outside)) write_extension(fields.displacement);
    }
    if (fields.jacobian == nullptr && fields.gradient == nullptr && fields.strain == nullptr)
      return;
    for_each_voxel([&](std::size_t v, const Eigen::Vector3d& index) {
      Eigen::Matrix3d f = Eigen::Matrix3d::Zero(), e = f;
      if (owners_.owner[v] >= 0) {
        f = owners_.gradient(owners_.owner[v], index, rest, deformed);
        e = green_lagrange(f);
      }
      store({f.determinant()}, v, fields.jacobian);
      store({f(0, 0), f(0, 1), f(0, 2), f(1, 0), f(1, 1), f(1, 2), f(2, 0), f(2, 1), f(2, 2)}, v,
            fields.gradient);
      store({e(0, 0), e(1, 1), e(2, 2), e(0, 1), e(1, 2), e(0, 2)}, v, fields.strain);
    });
  }

  /// Source index of the world position of an output voxel, rounded to whole voxels within 2^-40.
  Eigen::Vector3d same_place(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const Eigen::Vector3d index(static_cast<double>(i), static_cast<double>(j),
                                static_cast<double>(k));
    const Eigen::Vector3d world_offset =
        owners_.output.to_world * index + (owners_.output.origin - owners_.source.origin);
    Eigen::Vector3d x = owners_.source.from_world * world_offset;
    for (double& entry : x) {
      if (std::abs(entry - std::nearbyint(entry)) < 0x1p-40) entry = std::nearbyint(entry);
    }
    return x;
  }

  WarpPlan plan_;
  std::vector<double> positions_[2];
  StepReport reports_[2];
  Ownership owners_;
  std::vector<SampleTransform> transforms_;  ///< of every tetrahedron
  std::vector<Eigen::Vector3d> extension_;   ///< of every voxel; zero where it is covered [world]
};
}  // namespace

std::unique_ptr<WarpBackend> make_reference_backend(const WarpPlan& plan) {
  return std::make_unique<ReferenceBackend>(plan);
}

}  // namespace tetwarp
