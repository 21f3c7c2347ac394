/// @file field_file.cpp
/// The convention of a field from its header.
#include "io/transforms/field_file.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <tetwarp/io.hpp>
#include <tetwarp/itk_space.hpp>
#include <tetwarp/nifti.hpp>
#include <utility>

#include "io/files/component_facts.hpp"
#include "io/h5/h5.hpp"
#include "io/image/nrrd_header.hpp"
#include "io/image/nrrd_words.hpp"
#include "io/transforms/itk_flat_transform.hpp"

namespace tetwarp {
namespace {
constexpr int vector_intent = 1007;

/// How the numbers of a field are meant.
struct FieldConvention {
  bool is_of_itk;        ///< along LPS axes in mm; else along RAS axes in the header's unit
  bool holds_positions;  ///< else displacements
  std::string said_by;   ///< origin of the convention: a header field, or an option
};

FieldConvention convention_of(const std::string& path,
                              const NiftiFacts& facts,
                              const std::optional<Axes>& axes) {
  if (facts.intent_code == vector_intent && facts.intent_name == "NREG_TRANS") {
    if (axes == Axes::lps) {
      throw IoError(path, "", "is a transform of NiftyReg, along RAS axes; leave out --axes lps");
    }
    const double kind = facts.intent_p[0];
    if (kind == 0) return {false, true, "NiftyReg's deformation field"};
    if (kind == 1) return {false, false, "NiftyReg's displacement field"};
    throw IoError(path, "",
                  "is a transform of NiftyReg, but neither a displacement nor a deformation field; "
                  "convert it by reg_transform -disp");
  }
  if (axes) return {*axes == Axes::lps, false, "--axes"};
  if (facts.intent_code == nifti_displacement_intent) {
    return {false, false, "intent DISPVECT"};
  }
  if (facts.intent_code == vector_intent) {
    return {true, false, "intent VECTOR, as ITK and ANTs write it"};
  }
  throw IoError(path, "",
                "its intent " + std::to_string(facts.intent_code) +
                    " does not tell the axes of its components; state --axes lps for a field that "
                    "ITK or ANTs applies, --axes ras for displacements along NIfTI's axes");
}

/// From displacements along LPS in millimeters to those of a world with this factor of ITK's space.
Point3 from_lps(const Point3& world) {
  return ratio({-1, -1, 1}, world);
}

/// The numbers of a field's file.
class FieldNumbers {
 public:
  FieldNumbers(const std::string& path,
               const std::string& array,
               const TransformReadOptions& options)
      : path_(path),
        reader_(
            path, array, options.step.value_or(0), VolumeReadOptions{.scratch = options.scratch}) {
    const ArrayHeader& header = reader_.array();
    const bool is_flat = header.components == 2 && itk_components(reader_.grid()) == 2;
    if (header.components != 3 && !is_flat) {
      throw IoError(path, header.name,
                    "has " + std::to_string(header.components) +
                        " components, expected the three of a displacement, or two of a single "
                        "slice across the third axis of the world");
    }
    if (header.type != PixelType::float32 && header.type != PixelType::float64) {
      throw IoError(path, header.name,
                    std::string("is of ") + name_of(header.type) + ", expected float32 or float64");
    }
  }

  /// Of two components as of lifted().
  Grid grid() const {
    Grid grid = reader_.grid();
    if (components() == 2) grid.spacing[2] = flat_thickness;
    return grid;
  }
  int components() const { return reader_.array().components; }

  /// What reads displacements that `read` makes of these numbers.
  FieldReader reader(std::function<void(const Region&, float*)> read) const {
    const std::size_t number = is_single() ? sizeof(float) : sizeof(double);
    const double beside =
        is_stored() ? 0 : static_cast<double>(number) * static_cast<double>(components());
    return {std::move(read), 12 + beside, reader_.chunk_bytes(), reader_.unpacked_bytes()};
  }

  /// @param numbers  out, three of each voxel of a region, multiplied by `factor` component by
  ///                 component
  void read(const Region& region, const Point3& factor, float* numbers) const {
    if (!is_stored()) {
      return is_single() ? read_changed<float>(region, factor, numbers)
                         : read_changed<double>(region, factor, numbers);
    }
    const auto count = static_cast<std::size_t>(3 * region.voxel_count());
    reader_.read(region, numbers);
    for (std::size_t n = 0; factor != Point3{1, 1, 1} && n < count; ++n) {
      numbers[n] = product(factor[n % 3], numbers[n]);
    }
  }

 private:
  bool is_single() const { return reader_.array().type == PixelType::float32; }
  /// Whether three numbers of float32 are there for each voxel.
  bool is_stored() const { return is_single() && components() == 3; }

  template <class Number>
  static float product(double factor, Number number) {
    return static_cast<float>(0 + factor * static_cast<double>(number));  // no -0
  }

  template <class Number>
  void read_changed(const Region& region, const Point3& factor, float* numbers) const {
    const auto given = static_cast<std::size_t>(components());
    const std::size_t count = given * static_cast<std::size_t>(region.voxel_count());
    h5::check_memory(path_, reader_.array().name, static_cast<double>(sizeof(Number) * count));
    const auto stored = std::make_unique_for_overwrite<Number[]>(count);
    reader_.read(region, stored.get());
    for (std::size_t n = 0; n < count; ++n) {
      *numbers++ = product(factor[n % given], stored[n]);
      if (given == 2 && n % 2 == 1) *numbers++ = 0;
    }
  }

  std::string path_;
  VolumeReader reader_;
};

/// A field of these numbers.
/// @param place   factor of the grid's positions
/// @param factor  of the components of the numbers
/// @param change  makes the displacements of a region of the numbers; may be empty
TransformParts parts_of(const std::shared_ptr<const FieldNumbers>& numbers,
                        const Point3& place,
                        const Point3& factor,
                        std::string convention,
                        const std::function<void(const Region&, float*)>& change = {}) {
  const auto read = [numbers, factor, change](const Region& region, float* displacement) {
    numbers->read(region, factor, displacement);
    if (change) change(region, displacement);
  };
  return {{DisplacementField{scaled(numbers->grid(), place), {}}, std::move(convention)},
          {numbers->reader(read)}};
}

/// Positions minus those of their voxels.
/// @param axes  3, or 2: the third coordinate is not given
void subtract_places(const Grid& grid, int axes, const Region& region, float* positions) {
  for (std::int64_t k = region.begin[2]; k < region.end[2]; ++k) {
    for (std::int64_t j = region.begin[1]; j < region.end[1]; ++j) {
      for (std::int64_t i = region.begin[0]; i < region.end[0]; ++i) {
        const Point3 x =
            grid.world_of({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        for (std::size_t axis = 0; axis < static_cast<std::size_t>(axes); ++axis) {
          positions[axis] = static_cast<float>(static_cast<double>(positions[axis]) - x[axis]);
        }
        positions += 3;
      }
    }
  }
}

/// Whether the displacements of an NRRD file lead from the source to the output.
/// @throws IoError  when it says that its numbers are none, or are along other axes
bool leads_to_output(const std::string& path, const ImageHeader& header) {
  if (!may_be_displacement(header.component_kind)) {
    throw IoError(path, "kinds",
                  "its components are of kind '" + header.component_kind +
                      "', expected vector or list of a displacement");
  }
  if (std::ranges::count(header.left_out, frame_fact) > 0) {
    throw IoError(path, frame_fact,
                  "turns the components from LPS axes, which is not read; write them along these");
  }
  const std::string type = header.field_type.value_or("resampling");
  if (type == "resampling") return false;
  if (type == "modeling") return true;
  throw IoError(path, nrrd_field_type, "is '" + type + "', expected resampling or modeling");
}
}  // namespace

TransformParts open_nifti_field(const std::string& path,
                                const TransformReadOptions& options,
                                const Point3& world) {
  const NiftiFacts facts = read_nifti_facts(path);
  const FieldConvention convention = convention_of(path, facts, options.axes);
  const auto numbers = std::make_shared<const FieldNumbers>(path, "", options);
  const Point3 place = ratio(itk_factor(facts), world);
  if (convention.is_of_itk) {
    // ITK turns the positions of headers with a form alone, and components never.
    const bool has_form = facts.sform_code > 0 || facts.qform_code > 0;
    return parts_of(numbers, place, from_lps(world),
                    std::string("displacements along ") + (has_form ? "LPS" : "the header's") +
                        " axes in mm (" + convention.said_by + ")");
  }
  std::function<void(const Region&, float*)> change;
  if (convention.holds_positions) {
    change = [grid = scaled(numbers->grid(), place), axes = numbers->components()](
                 const Region& region, float* displacement) {
      subtract_places(grid, axes, region, displacement);
    };
  }
  return parts_of(numbers, place, place,
                  std::string(convention.holds_positions ? "positions" : "displacements") +
                      " along RAS axes in the header's unit (" + convention.said_by + ")",
                  change);
}

TransformParts open_image_field(const std::string& path,
                                const TransformReadOptions& options,
                                const Point3& world) {
  const bool is_lps = options.axes.value_or(Axes::lps) == Axes::lps;
  const Point3 ras_mm{1, 1, 1};
  TransformParts parts =
      parts_of(std::make_shared<const FieldNumbers>(path, "", options), ratio(ras_mm, world),
               is_lps ? from_lps(world) : ratio(ras_mm, world),
               std::string("displacements along ") + (is_lps ? "LPS" : "RAS") +
                   (options.axes ? " axes (--axes)" : " axes, as ITK and 3D Slicer write them"));
  if (is_nrrd(path)) parts.file.is_inverted = {leads_to_output(path, read_nrrd_header(path))};
  return parts;
}

TransformParts open_volume_field(const std::string& path,
                                 const TransformReadOptions& options,
                                 const Point3& world) {
  const std::optional<Point3> factor = itk_factor(path, read_volume_header(path));
  const Point3 place = factor ? ratio(*factor, world) : Point3{1, 1, 1};
  return parts_of(std::make_shared<const FieldNumbers>(path, "tetwarp_displacement", options),
                  place, place, "displacements along the file's axes (array tetwarp_displacement)");
}

void fail_not_finite(const std::string& path, const std::array<std::int64_t, 3>& voxel) {
  throw IoError(path, "",
                "its displacement is not finite at voxel (" + std::to_string(voxel[0]) + ", " +
                    std::to_string(voxel[1]) + ", " + std::to_string(voxel[2]) +
                    "); correct it, or write 0 where there is none");
}

}  // namespace tetwarp
