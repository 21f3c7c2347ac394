/// @file field_file.cpp
/// The convention of a field from its header.
#include "io/transforms/field_file.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <tetwarp/io.hpp>
#include <utility>

#include "io/h5/h5.hpp"

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

/// The numbers of a field's file.
class FieldNumbers {
 public:
  FieldNumbers(const std::string& path, const std::string& array, const VolumeReadOptions& options)
      : path_(path), reader_(path, array, 0, options) {
    const ArrayHeader& header = reader_.array();
    if (header.components != 3) {
      throw IoError(path, header.name,
                    "has " + std::to_string(header.components) +
                        " components, expected the three of a displacement");
    }
    if (header.type != PixelType::float32 && header.type != PixelType::float64) {
      throw IoError(path, header.name,
                    std::string("is of ") + name_of(header.type) + ", expected float32 or float64");
    }
  }

  const Grid& grid() const { return reader_.grid(); }
  /// What reads displacements that `read` makes of these numbers.
  FieldReader reader(std::function<void(const Region&, float*)> read) const {
    return {std::move(read), is_single() ? 12.0 : 12 + 24, reader_.chunk_bytes(),
            reader_.unpacked_bytes()};
  }

  /// @param numbers  out, of a region, each multiplied by `scale`
  void read(const Region& region, double scale, float* numbers) const {
    const auto count = static_cast<std::size_t>(3 * region.voxel_count());
    if (is_single()) {
      reader_.read(region, numbers);
      for (std::size_t n = 0; scale != 1 && n < count; ++n) {
        numbers[n] = static_cast<float>(scale * static_cast<double>(numbers[n]));
      }
      return;
    }
    const auto bytes = static_cast<double>(sizeof(double) * count);
    h5::check_memory(path_, reader_.array().name, bytes);
    const auto wide = std::make_unique_for_overwrite<double[]>(count);
    reader_.read(region, wide.get());
    for (std::size_t n = 0; n < count; ++n) numbers[n] = static_cast<float>(scale * wide[n]);
  }

 private:
  bool is_single() const { return reader_.array().type == PixelType::float32; }

  std::string path_;
  VolumeReader reader_;
};

/// A field of these numbers.
/// @param change  makes the displacements of a region of its numbers
template <class Change>
TransformParts parts_of(const std::shared_ptr<const FieldNumbers>& numbers,
                        double scale,
                        std::string convention,
                        Change change) {
  const auto read = [numbers, scale, change](const Region& region, float* displacement) {
    numbers->read(region, scale, displacement);
    change(region, displacement);
  };
  return {{DisplacementField{numbers->grid(), {}}, std::move(convention)}, {numbers->reader(read)}};
}

/// Positions minus those of their voxels.
void subtract_places(const Grid& grid, const Region& region, float* positions) {
  for (std::int64_t k = region.begin[2]; k < region.end[2]; ++k) {
    for (std::int64_t j = region.begin[1]; j < region.end[1]; ++j) {
      for (std::int64_t i = region.begin[0]; i < region.end[0]; ++i) {
        const Point3 x =
            grid.world_of({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        for (const double coordinate : x) {
          *positions = static_cast<float>(static_cast<double>(*positions) - coordinate);
          ++positions;
        }
      }
    }
  }
}
}  // namespace

TransformParts open_nifti_field(const std::string& path, const TransformReadOptions& options) {
  const NiftiFacts facts = read_nifti_facts(path);
  const FieldConvention convention = convention_of(path, facts, options.axes);
  // ITK turns positions and components only of headers with a form.
  const bool has_form = facts.sform_code > 0 || facts.qform_code > 0;
  const Axes turned = has_form ? convention.axes : Axes::ras;
  const auto numbers = std::make_shared<const FieldNumbers>(
      path, "", VolumeReadOptions{.axes = turned, .scratch = options.scratch});
  const std::string said = std::string(convention.holds_positions ? "positions" : "displacements") +
                           " along " +
                           (turned == Axes::lps ? "LPS"
                            : has_form          ? "RAS"
                                                : "the header's") +
                           " axes in " + (convention.is_in_mm ? "mm" : "the header's unit") + " (" +
                           convention.said_by + ")";
  return parts_of(numbers, convention.is_in_mm ? 1 / millimeters(facts) : 1, said,
                  [grid = numbers->grid(), holds_positions = convention.holds_positions](
                      const Region& region, float* displacement) {
                    if (holds_positions) subtract_places(grid, region, displacement);
                  });
}

TransformParts open_image_field(const std::string& path, const TransformReadOptions& options) {
  const bool is_lps = options.axes.value_or(Axes::lps) == Axes::lps;
  return parts_of(
      std::make_shared<const FieldNumbers>(path, "", VolumeReadOptions{.scratch = options.scratch}),
      1,
      std::string("displacements along ") + (is_lps ? "LPS" : "RAS") +
          (options.axes ? " axes (--axes)" : " axes, as ITK and 3D Slicer write them"),
      [is_lps](const Region& region, float* displacement) {
        for (std::int64_t n = 0; is_lps && n < 3 * region.voxel_count(); ++n) {
          if (n % 3 < 2) displacement[n] = 0 - displacement[n];
        }
      });
}

TransformParts open_volume_field(const std::string& path) {
  return parts_of(
      std::make_shared<const FieldNumbers>(path, "tetwarp_displacement", VolumeReadOptions{}), 1,
      "displacements along the file's axes (array tetwarp_displacement)",
      [](const Region&, float*) {});
}

void fail_not_finite(const std::string& path, const std::array<std::int64_t, 3>& voxel) {
  throw IoError(path, "",
                "its displacement is not finite at voxel (" + std::to_string(voxel[0]) + ", " +
                    std::to_string(voxel[1]) + ", " + std::to_string(voxel[2]) +
                    "); correct it, or write 0 where there is none");
}

}  // namespace tetwarp
