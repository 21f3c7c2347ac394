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
#include "host/reference/hexahedron.hpp"
#include "host/reference/rule.hpp"
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
    owner_.assign(voxels, -1);
    source_position_.assign(voxels, Eigen::Vector3d::Zero());
    rules_.assign(plan_.mesh.tets.size(), Rule());
    strictly_inside_.assign(plan_.options.count_folded ? voxels : 0, 0);
    StepReport& report = reports_[flight];
    report = {};
    const auto tets = static_cast<std::int32_t>(plan_.mesh.tets.size());
    for (std::int32_t t = 0; t < tets; ++t) {
      claim(t, positions_[flight].data(), report.counts);
      if (progress && t % 64 == 0 && !progress(0.5 * t / tets)) throw Cancelled();
    }
    for (std::size_t s = 0; s < plan_.sources.size(); ++s) {
      with_pixel_type(plan_.sources[s].type,
                      [&]<class T>(T) { fill<T>(s, static_cast<T*>(target.volumes[s])); });
    }
    for (std::size_t v = 0; v < voxels; ++v) {
      report.counts.covered += owner_[v] >= 0;
      if (target.mask != nullptr) target.mask[v] = owner_[v] >= 0;
      if (target.tet != nullptr) target.tet[v] = cell_of(owner_[v]);
    }
    for (const std::uint8_t count : strictly_inside_) report.counts.folded += count > 1;
    report.counts.voxels = static_cast<std::int64_t>(voxels);
    report.counts.outside = report.counts.voxels - report.counts.covered;
    report.counts.tetrahedra = tets;
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    report.timings.raster = passed.count();
    if (progress && !progress(1.0)) throw Cancelled();
  }

  StepReport finish(int flight) override { return reports_[flight]; }

 private:
  /// Gives tetrahedron t every voxel of its closed shape that no lower one owns.
  void claim(std::int32_t t, const double* deformed, Counts& counts) {
    Corners now, rest;
    for (std::size_t node = 0; node < 4; ++node) {
      const auto n = static_cast<std::size_t>(plan_.mesh.tets[static_cast<std::size_t>(t)][node]);
      now[node] = output_.quanta_of(deformed + 3 * n);
      rest[node] = source_.quanta_of(plan_.mesh.rest_positions[n].data());
    }
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
    Rule& rule = rules_[static_cast<std::size_t>(t)];
    rule = rule_of(rest, now, source_, output_, plan_.options);
    counts.tets_averaged += rule.averages();
    const std::optional<Hexahedron> hex = hexahedron_of(t, deformed);
    const std::optional<Eigen::Vector3d> shift = hex ? hex->shift : whole_shift(rest, now);
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
          const Eigen::Vector3d x(static_cast<double>(i), static_cast<double>(j),
                                  static_cast<double>(k));
          if (shift) {
            source_position_[v] = x + *shift;
          } else if (hex) {
            source_position_[v] = hex->rest.at(hex->now.inverse(x));
          } else {
            source_position_[v] = combined(rest, b->weight);
          }
        }
      }
    }
  }

  /// Tetrahedra that are no parts of hexahedra; they come first.
  std::int32_t lone_tets() const {
    return static_cast<std::int32_t>(plan_.mesh.tets.size() - 6 * plan_.mesh.hexes.size());
  }
  std::int32_t cell_of(std::int32_t t) const {
    return t < lone_tets() ? t : lone_tets() + (t - lone_tets()) / 6;
  }
  /// What tetrahedron t is a part of.
  struct Hexahedron {
    Trilinear now;
    Trilinear rest;
    std::optional<Eigen::Vector3d> shift;
  };
  std::optional<Hexahedron> hexahedron_of(std::int32_t t, const double* deformed) const {
    if (t < lone_tets()) return std::nullopt;
    const auto h = static_cast<std::size_t>(cell_of(t) - lone_tets());
    HexCorners now, rest;
    for (std::size_t node = 0; node < 8; ++node) {
      const auto n = static_cast<std::size_t>(plan_.mesh.hexes[h][node]);
      now[node] = output_.quanta_of(deformed + 3 * n);
      rest[node] = source_.quanta_of(plan_.mesh.rest_positions[n].data());
    }
    return Hexahedron{Trilinear(now), Trilinear(rest), whole_shift(rest, now)};
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
            const Rule& rule = rules_[static_cast<std::size_t>(owner_[v])];
            store(s, sampler, source_position_[v], rule, voxel);
          } else if (plan_.options.outside == Outside::identity) {
            store(s, sampler, same_place(i, j, k), outside_rule(), voxel);
          } else {
            std::fill_n(voxel, sampler.components(), sampler.background());
          }
        }
      }
    }
  }

  /// Of voxels that show the source at their own place.
  Rule outside_rule() const {
    Rule rule;
    rule.step = source_.from_world * output_.to_world;
    if (plan_.options.antialias) rule.parts = parts_of(rule.step);
    return rule;
  }

  /// One voxel: a sample, or a mean of samples at the midpoints of its parts, by its rule.
  template <class T>
  void store(std::size_t s,
             const Sampler<T>& sampler,
             const Eigen::Vector3d& x,
             const Rule& rule,
             T* voxel) const {
    const WarpOptions& options = plan_.options;
    const Quantity quantity =
        options.quantities.empty() ? Quantity::components : options.quantities[s];
    const bool turns = quantity != Quantity::components && !rule.is_still && !rule.is_singular;
    if (!turns && !rule.averages() && rule.scale == 1) return sampler.store(x, voxel);
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(sampler.components());
    int count = 0;
    for (int c = 0; c < rule.parts(2); ++c) {
      for (int b = 0; b < rule.parts(1); ++b) {
        for (int a = 0; a < rule.parts(0); ++a) {
          const Eigen::Array3d part = Eigen::Vector3i(a, b, c).cast<double>();
          const Eigen::Array3d within = (part + 0.5) / rule.parts.cast<double>().array() - 0.5;
          count += sampler.add(x + rule.step * within.matrix(), mean);
        }
      }
    }
    if (count == 0) {
      std::fill_n(voxel, sampler.components(), sampler.background());
      return;
    }
    sampler.clamp(mean /= count);
    if (turns) mean = reoriented(mean, quantity, rule.forward);
    for (int c = 0; c < sampler.components(); ++c) voxel[c] = stored<T>(mean(c) * rule.scale);
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
  std::vector<Rule> rules_;  ///< of every tetrahedron
  std::vector<std::uint8_t> strictly_inside_;
};

}  // namespace

std::unique_ptr<WarpBackend> make_reference_backend(const WarpPlan& plan) {
  return std::make_unique<ReferenceBackend>(plan);
}

}  // namespace tetwarp
