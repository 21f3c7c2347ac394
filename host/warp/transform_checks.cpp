/// @file transform_checks.cpp
/// Checks filters, quantities and conservative intensities.
#include "host/warp/transform_checks.hpp"

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "kernels/warp/sample/gaussian_label.hpp"

namespace tetwarp {
namespace {
void check_filter(const VolumeView& source, Filter filter) {
  const std::string type = std::string("source: ") + name_of(source.type);
  if (filter == Filter::labels) {
    if (!is_integer(source.type)) {
      throw std::invalid_argument(type + " holds no labels; use another filter or integers");
    }
    if (source.components != 1) {
      throw std::invalid_argument("source: " + std::to_string(source.components) +
                                  " components, labels have one; use the nearest filter");
    }
    return;
  }
  const bool is_64_bit = is_integer(source.type) && size_of(source.type) == 8;
  if (is_64_bit && filter != Filter::nearest) {
    throw std::invalid_argument(type +
                                " cannot be interpolated without loss; use the nearest filter");
  }
}

/// Components that a quantity has; 0: any number.
int components_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::components:
      return 0;
    case Quantity::vector:
    case Quantity::covariant_vector:
    case Quantity::contravariant_vector:
      return 3;
    case Quantity::tensor:
    case Quantity::principal_tensor:
      return 6;
  }
  return 0;
}

void check_quantity(const VolumeView& source, Quantity quantity) {
  if (quantity == Quantity::components) return;
  const int expected = components_of(quantity);
  if (source.components != expected) {
    throw std::invalid_argument(
        "quantities: a " + std::string(expected == 3 ? "vector" : "tensor") + " has " +
        std::to_string(expected) + " components, the source " + std::to_string(source.components));
  }
}

/// Rejects options that would add to a total or change it.
void check_conservative(const WarpOptions& options) {
  const char* wrong = nullptr;
  if (options.antialias) wrong = "means are exact without antialias";
  if (options.background != 0) wrong = "the background must be 0";
  if (options.outside != Outside::background) wrong = "outside must be background";
  for (const Quantity quantity : options.quantities) {
    if (quantity != Quantity::components) wrong = "vectors and tensors take density";
  }
  if (wrong != nullptr) {
    throw std::invalid_argument(std::string("intensity: to keep the total, ") + wrong);
  }
}

/// Rejects what the rules for labels have no meaning for.
void check_label_rule(std::span<const VolumeView> sources, const WarpOptions& options) {
  if (options.label_rule == LabelRule::linear) return;
  const std::string rule = std::string("label rule: ") + name_of(options.label_rule);
  if (options.filter != Filter::labels) {
    throw std::invalid_argument(rule + " is for labels; set the filter to labels");
  }
  if (options.label_rule == LabelRule::volume && options.outside != Outside::background) {
    throw std::invalid_argument(rule +
                                " knows labels in the mesh alone; set outside to background");
  }
  if (extends(options.outside)) {
    throw std::invalid_argument(rule + " has no labels beyond the mesh but those of the source; " +
                                "set outside to background or identity");
  }
  const auto& [sigma, cutoff] = options.label_gaussian;
  if (!(sigma > 0 && cutoff > 0 && sigma * cutoff <= GaussianWindow::max_reach)) {
    throw std::invalid_argument(
        "label gaussian: expected sigma and cutoff above 0, and a product of at most 8 voxels");
  }
  for (const VolumeView& source : sources) {
    if (size_of(source.type) != 8) continue;
    throw std::invalid_argument(rule + " takes labels of at most 32 bits, the source has " +
                                name_of(source.type));
  }
}

/// Rejects what the derivative of a displacement outside of the mesh would change.
void check_outside(const WarpOptions& options) {
  if (options.outside == Outside::falloff &&
      !(std::isfinite(options.falloff) && options.falloff > 0)) {
    throw std::invalid_argument("falloff: expected a finite distance above 0");
  }
  if (!extends(options.outside)) return;
  if (options.intensity != Intensity::value) {
    throw std::invalid_argument(std::string("outside: ") + name_of(options.outside) +
                                " is for values, not for densities; use background or identity");
  }
  for (const Quantity quantity : options.quantities) {
    if (quantity == Quantity::components) continue;
    throw std::invalid_argument(std::string("outside: ") + name_of(options.outside) +
                                " turns no vectors and tensors; use background or identity");
  }
}
}  // namespace

void check_sources(std::span<const VolumeView> sources, const std::string& what_to_do) {
  if (sources.empty()) throw std::invalid_argument("sources: no volume");
  for (const VolumeView& source : sources) {
    check_grid(source.grid, "source");
    if (source.grid != sources.front().grid) {
      throw std::invalid_argument("sources: volumes on different grids; " + what_to_do +
                                  " them one by one");
    }
    if (source.components < 1 || source.components > 9) {
      throw std::invalid_argument("source: " + std::to_string(source.components) +
                                  " components, expected 1 to 9");
    }
    if (source.data == nullptr) throw std::invalid_argument("source: no samples");
  }
}

void check_source_transform(const VolumeView& source,
                            Quantity quantity,
                            const WarpOptions& options) {
  check_filter(source, options.filter);
  if (is_integer(source.type) && !std::isfinite(options.background)) {
    throw std::invalid_argument(std::string("background: not a finite number, which ") +
                                name_of(source.type) + " cannot hold");
  }
  check_quantity(source, quantity);
  const bool computes = options.intensity != Intensity::value || quantity != Quantity::components;
  const bool is_64_bit = is_integer(source.type) && size_of(source.type) == 8;
  if (computes && (is_64_bit || options.filter == Filter::labels)) {
    throw std::invalid_argument(
        std::string("source: ") + (is_64_bit ? name_of(source.type) : "labels") +
        " cannot be scaled or turned; leave out intensity and quantities, or use another type");
  }
}

void check_transforms(std::span<const VolumeView> sources, const WarpOptions& options) {
  const bool blends = options.filter != Filter::nearest && options.filter != Filter::labels;
  if (options.antialias && !blends) {
    throw std::invalid_argument(
        "antialias: cannot average samples with nearest and labels; use another filter");
  }
  if (!options.quantities.empty() && options.quantities.size() != sources.size()) {
    throw std::invalid_argument("quantities: expected none or one per source, " +
                                std::to_string(sources.size()) + ", got " +
                                std::to_string(options.quantities.size()));
  }
  if (options.intensity == Intensity::conservative) check_conservative(options);
  check_outside(options);
  check_label_rule(sources, options);
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const Quantity quantity =
        options.quantities.empty() ? Quantity::components : options.quantities[s];
    check_source_transform(sources[s], quantity, options);
  }
}

}  // namespace tetwarp
