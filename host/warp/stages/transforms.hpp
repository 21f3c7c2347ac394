/// @file transforms.hpp
/// The transforms of a step's tetrahedra, for the sources whose samples are changed.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>

#include "host/base/warp_backend.hpp"
#include "host/warp/geometry.hpp"
#include "host/warp/stages/pairs.hpp"
#include "kernels/warp/tet_transform.hpp"

namespace tetwarp {

template <class Exec>
class WarpTransforms {
 public:
  /// The arguments must outlive the object.
  WarpTransforms(Exec& exec, const WarpPlan& plan, const WarpGeometry& geometry)
      : exec_(exec), options_(plan.options), axes_(geometry.axes), outside_(plain_transform()) {
    for (std::size_t s = 0; s < plan.sources.size(); ++s) {
      const bool is_plain = !options_.antialias && options_.intensity == Intensity::value &&
                            reorientation(s) == Quantity::components;
      if (!is_plain) buffers_[reorientation(s)].reserve(std::ssize(plan.mesh.tets));
    }
    for (int axis = 0; axis < 3 && options_.antialias; ++axis) {
      const auto& linear = geometry.outside.linear;
      const double step[3] = {linear[0][axis], linear[1][axis], linear[2][axis]};
      outside_.parts[axis] = parts_of(step);
    }
    outside_.is_plain = !is_averaging(outside_);
  }

  /// Computes the transforms of a step after its pairs; of an update only those that have changed.
  void run(const WarpPairs<Exec>& pairs) {
    bool is_first = true;  // the first source counts the tetrahedra that average
    for (auto& [reorientation, buffer] : buffers_) {
      tet_transform(exec_, pairs.setups(), pairs.tets(), pairs.nodes(), pairs.rest(), pairs.moved(),
                    choice(reorientation), buffer.view(pairs.tet_count()),
                    {&pairs.counters()->mesh.averaged, is_first ? 1 : 0});
      is_first = false;
    }
  }

  /// Of source s; size 0: all are plain.
  View<const VoxelTransform> transforms(std::size_t s, std::int64_t tet_count) const {
    const auto found = buffers_.find(reorientation(s));
    return found == buffers_.end() ? View<const VoxelTransform>{}
                                   : found->second.const_view(tet_count);
  }
  Quantity reorientation(std::size_t s) const {
    return options_.quantities.empty() ? Quantity::components : options_.quantities[s];
  }
  /// Of voxels that no tetrahedron covers.
  const VoxelTransform& outside() const { return outside_; }

 private:
  TransformChoice choice(Quantity reorientation) const {
    return {.averages = options_.antialias,
            .divides = options_.intensity != Intensity::value,
            .reorientation = reorientation,
            .axes = axes_,
            .voxel_ratio = voxel_ratio_of(axes_)};
  }

  Exec& exec_;
  const WarpOptions& options_;
  const GridAxes& axes_;
  VoxelTransform outside_;
  std::map<Quantity, typename Exec::template Buffer<VoxelTransform>> buffers_;
};

}  // namespace tetwarp
