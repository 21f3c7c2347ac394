/// @file field_buffers.hpp
/// Memory for every field that a step can write.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include <tetwarp/warp.hpp>

namespace tetwarp::test {

/// Displacement, Jacobian, gradient, strain and, on request, the forward field.
class FieldBuffers {
 public:
  FieldBuffers() = default;
  FieldBuffers(const Grid& grid, bool with_forward) {
    const auto voxels = static_cast<std::size_t>(grid.voxel_count());
    for (std::size_t f = 0; f < arrays_.size(); ++f) {
      if (f < 4 || with_forward) arrays_[f].assign(voxels * components[f], -77.0F);
    }
  }

  FieldTarget target() {
    const auto field = [&](std::size_t f) {
      return arrays_[f].empty() ? nullptr : arrays_[f].data();
    };
    return {.displacement = field(0),
            .jacobian = field(1),
            .gradient = field(2),
            .strain = field(3),
            .forward = field(4)};
  }

  const std::vector<float>& displacement() const { return arrays_[0]; }
  const std::vector<float>& jacobian() const { return arrays_[1]; }
  const std::vector<float>& gradient() const { return arrays_[2]; }
  const std::vector<float>& strain() const { return arrays_[3]; }
  const std::vector<float>& forward() const { return arrays_[4]; }

  static constexpr std::array<std::size_t, 5> components{3, 1, 9, 6, 3};
  const std::array<std::vector<float>, 5>& arrays() const { return arrays_; }

  void swap(FieldBuffers& other) { arrays_.swap(other.arrays_); }
  bool operator==(const FieldBuffers&) const = default;

 private:
  std::array<std::vector<float>, 5> arrays_;
};

}  // namespace tetwarp::test
