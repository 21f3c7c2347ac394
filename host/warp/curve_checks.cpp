/// @file curve_checks.cpp
/// Rejects what is computed from one affine map per tetrahedron.
#include "host/warp/curve_checks.hpp"

#include <algorithm>

namespace tetwarp {

std::string curves_refusal(const WarpOptions& options, bool forward) {
  const auto refused = [](const std::string& what, const char* why) {
    return what + " " + why + ", which tetrahedra of ten nodes do not have; split them";
  };
  if (options.antialias) return refused("antialias", "averages by affine maps");
  if (options.intensity != Intensity::value) {
    return refused(std::string("intensity ") + name_of(options.intensity), "scales by affine maps");
  }
  if (std::ranges::any_of(options.quantities,
                          [](Quantity q) { return q != Quantity::components; })) {
    return refused("quantities of vectors and tensors", "turn by affine maps");
  }
  if (options.label_rule != LabelRule::linear) {
    return refused(std::string("label rule ") + name_of(options.label_rule), "uses affine maps");
  }
  if (forward) return refused("the forward displacement", "is that of affine maps");
  return {};
}

}  // namespace tetwarp
