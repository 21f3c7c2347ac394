/// @file field_file.cpp
/// The convention of a field from its header.
#include "io/transforms/field_file.hpp"

#include <tetwarp/io.hpp>
#include <utility>

namespace tetwarp {
namespace {
constexpr int vector_intent = 1007;

/// How the numbers of a field are meant.
struct FieldConvention {
  Axes axes;             ///< of the components
  bool is_in_mm;         ///< else in the unit of the header
  bool holds_positions;  ///< else displacements
  std::string said_by;   ///< origin of the convention: a header field, or an option
};

FieldConvention convention_of(const std::string& path,
                              const NiftiFacts& facts,
                              const std::optional<Axes>& axes) {
  if (axes) return {*axes, *axes == Axes::lps, false, "--axes"};
  if (facts.intent_code == nifti_displacement_intent) {
    return {Axes::ras, false, false, "intent DISPVECT"};
  }
  if (facts.intent_code == vector_intent && facts.intent_name == "NREG_TRANS") {
    const double kind = facts.intent_p[0];
    if (kind == 0) return {Axes::ras, false, true, "NiftyReg's deformation field"};
    if (kind == 1) return {Axes::ras, false, false, "NiftyReg's displacement field"};
    throw IoError(path, "",
                  "is a transform of NiftyReg, but neither a displacement nor a deformation field; "
                  "convert it by reg_transform -disp");
  }
  if (facts.intent_code == vector_intent) {
    return {Axes::lps, true, false, "intent VECTOR, as ITK and ANTs write it"};
  }
  throw IoError(path, "",
                "its intent " + std::to_string(facts.intent_code) +
                    " does not tell the axes of its components; state --axes lps for a field that "
                    "ITK or ANTs applies, --axes ras for displacements along NIfTI's axes");
}

/// Millimeters of a unit of length of a NIfTI header.
double millimeters(const NiftiFacts& facts) {
  const int unit = facts.xyzt_units & 7;
  return unit == 1 ? 1000 : unit == 3 ? 0.001 : 1;
}

std::vector<float> numbers_of(const std::string& path, const Volume& volume, double scale) {
  std::vector<float> numbers;
  const auto add = [&](auto samples) {
    numbers.reserve(samples.size());
    for (const auto sample : samples) {
      numbers.push_back(static_cast<float>(scale * static_cast<double>(sample)));
    }
  };
  if (volume.components != 3) {
    throw IoError(path, volume.name,
                  "has " + std::to_string(volume.components) +
                      " components, expected the three of a displacement");
  }
  if (volume.type == PixelType::float32) {
    add(volume.samples<float>());
  } else if (volume.type == PixelType::float64) {
    add(volume.samples<double>());
  } else {
    throw IoError(path, volume.name,
                  std::string("is of ") + name_of(volume.type) + ", expected float32 or float64");
  }
  return numbers;
}
}  // namespace

TransformFile read_nifti_field(const std::string& path, const std::optional<Axes>& axes) {
  const NiftiFacts facts = read_nifti_facts(path);
  const FieldConvention convention = convention_of(path, facts, axes);
  // ITK turns positions and components only of headers with a form.
  const bool has_form = facts.sform_code > 0 || facts.qform_code > 0;
  const Axes turned = has_form ? convention.axes : Axes::ras;
  const Volume volume = read_volume(path, {}, 0, {.axes = turned});
  const double scale = convention.is_in_mm ? 1 / millimeters(facts) : 1;
  DisplacementField field{volume.grid, numbers_of(path, volume, scale)};
  if (convention.holds_positions) {
    std::size_t v = 0;
    for (std::int64_t k = 0; k < field.grid.dims[2]; ++k) {
      for (std::int64_t j = 0; j < field.grid.dims[1]; ++j) {
        for (std::int64_t i = 0; i < field.grid.dims[0]; ++i) {
          const Point3 x = field.grid.world_of(
              {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
          for (const double coordinate : x) {
            float& number = field.displacement[v++];
            number = static_cast<float>(static_cast<double>(number) - coordinate);
          }
        }
      }
    }
  }
  return {std::move(field),
          std::string(convention.holds_positions ? "positions" : "displacements") + " along " +
              (turned == Axes::lps ? "LPS"
               : has_form          ? "RAS"
                                   : "the header's") +
              " axes in " + (convention.is_in_mm ? "mm" : "the header's unit") + " (" +
              convention.said_by + ")"};
}

TransformFile read_image_field(const std::string& path, const std::optional<Axes>& axes) {
  const Volume volume = read_volume(path);
  DisplacementField field{volume.grid, numbers_of(path, volume, 1)};
  const bool is_lps = axes.value_or(Axes::lps) == Axes::lps;
  for (std::size_t n = 0; is_lps && n < field.displacement.size(); ++n) {
    if (n % 3 < 2) field.displacement[n] = 0 - field.displacement[n];
  }
  return {std::move(field),
          std::string("displacements along ") + (is_lps ? "LPS" : "RAS") +
              (axes ? " axes (--axes)" : " axes, as ITK and 3D Slicer write them")};
}

TransformFile read_volume_field(const std::string& path) {
  const Volume volume = read_volume(path, "tetwarp_displacement");
  return {DisplacementField{volume.grid, numbers_of(path, volume, 1)},
          "displacements along the file's axes (array tetwarp_displacement)"};
}

}  // namespace tetwarp
