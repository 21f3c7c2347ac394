/// @file fsl_field.cpp
/// Reads the numbers, finds whether they are relative or absolute, and turns them to displacements
/// in RAS.
#include "io/transforms/fsl_field.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <tetwarp/io.hpp>
#include <utility>
#include <vector>

#include "io/nifti/nifti_fields.hpp"

namespace tetwarp {
namespace {
constexpr int displacement_intent = 2006;  // FSL_FNIRT_DISPLACEMENT_FIELD
constexpr int first_intent = 2006, last_intent = 2018;

/// FSL's coordinates of an image's voxels.
struct FslSpace {
  Grid grid;
  Point3 size;      ///< of a voxel
  bool is_flipped;  ///< the first index counts from the other end

  Point3 of_voxel(const Point3& index) const {
    const double i = is_flipped ? static_cast<double>(grid.dims[0] - 1) - index[0] : index[0];
    return {i * size[0], index[1] * size[1], index[2] * size[2]};
  }
  Point3 voxel_of(const Point3& x) const {
    const double i = x[0] / size[0];
    return {is_flipped ? static_cast<double>(grid.dims[0] - 1) - i : i, x[1] / size[1],
            x[2] / size[2]};
  }
};

double determinant(const std::array<double, 9>& m) {
  return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
         m[2] * (m[3] * m[7] - m[4] * m[6]);
}

FslSpace space_of(const std::string& path) {
  const NiftiHeader header = read_nifti_header(path);
  const NiftiStart start = read_nifti_start(nifti_header_path(path));
  const bool has_form = start.fields->sform_code > 0 || start.fields->qform_code > 0;
  FslSpace space{header.grid, {}, has_form && determinant(header.grid.direction) > 0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double size = std::abs(start.fields->pixdim[axis + 1]);
    if (!(size > 0) || !std::isfinite(size)) {
      throw IoError(path, "pixdim[" + std::to_string(axis + 1) + "]",
                    "is no voxel size, in which the coordinates of FSL are measured");
    }
    space.size[axis] = size;
  }
  return space;
}

/// The three numbers of every voxel: along the axis of time, as FSL writes them, or of components.
std::vector<double> numbers_of(const std::string& path, const NiftiHeader& header) {
  const bool are_steps = header.steps == 3 && header.components == 1;
  if (!are_steps && !(header.steps == 1 && header.components == 3)) {
    throw IoError(path, "",
                  "has " + std::to_string(header.steps) + " steps of " +
                      std::to_string(header.components) +
                      " components, expected the three volumes of a warp field of FSL");
  }
  std::vector<double> numbers(3 * static_cast<std::size_t>(header.grid.voxel_count()));
  for (std::int64_t step = 0; step < (are_steps ? 3 : 1); ++step) {
    const Volume volume = read_volume(path, {}, step);
    const std::size_t stride = are_steps ? 3 : 1;
    const auto copy = [&](auto samples) {
      std::size_t n = static_cast<std::size_t>(step);
      for (const auto sample : samples) {
        numbers[n] = static_cast<double>(sample);
        n += stride;
      }
    };
    if (volume.type == PixelType::float32) {
      copy(volume.samples<float>());
    } else if (volume.type == PixelType::float64) {
      copy(volume.samples<double>());
    } else {
      throw IoError(path, volume.name,
                    std::string("is of ") + name_of(volume.type) + ", expected float32 or float64");
    }
  }
  return numbers;
}

/// Calls visit(voxel, its number) for all voxels.
template <class Visit>
void for_voxels(const Grid& grid, const Visit& visit) {
  std::size_t v = 0;
  for (std::int64_t k = 0; k < grid.dims[2]; ++k) {
    for (std::int64_t j = 0; j < grid.dims[1]; ++j) {
      for (std::int64_t i = 0; i < grid.dims[0]; ++i, ++v) {
        visit(Point3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}, v);
      }
    }
  }
}

/// Root of the sum of squares about the mean, of three numbers per voxel.
class Spread {
 public:
  void add(const Point3& x) {
    ++count_;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double apart = x[axis] - mean_[axis];
      mean_[axis] += apart / count_;
      sum_ += apart * (x[axis] - mean_[axis]);
    }
  }
  double value() const { return std::sqrt(sum_); }

 private:
  double count_ = 0, sum_ = 0;
  Point3 mean_{0, 0, 0};
};

/// Displacements spread less than the coordinates of an image, positions as much as these.
FslWarp kind_of_numbers(const std::string& path,
                        const FslSpace& space,
                        const std::vector<double>& numbers) {
  Spread as_they_are, without_place;
  for_voxels(space.grid, [&](const Point3& voxel, std::size_t v) {
    const Point3 x = space.of_voxel(voxel);
    const Point3 number{numbers[3 * v], numbers[3 * v + 1], numbers[3 * v + 2]};
    as_they_are.add(number);
    without_place.add({number[0] - x[0], number[1] - x[1], number[2] - x[2]});
  });
  if (2 * as_they_are.value() < without_place.value()) return FslWarp::relative;
  if (2 * without_place.value() < as_they_are.value()) return FslWarp::absolute;
  throw IoError(path, "",
                "its numbers may be displacements or positions: state --fsl relative or --fsl "
                "absolute");
}
}  // namespace

bool is_fsl_field(const NiftiHeader& header, const TransformReadOptions& options) {
  const int intent = header.facts.intent_code;
  return options.fsl.has_value() ||
         (!options.axes && intent >= first_intent && intent <= last_intent);
}

TransformFile read_fsl_field(const std::string& path, const TransformReadOptions& options) {
  const NiftiHeader header = read_nifti_header(path);
  const int intent = header.facts.intent_code;
  if (!options.fsl && intent != displacement_intent) {
    throw IoError(path, "intent_code",
                  "is " + std::to_string(intent) +
                      ", coefficients or another field of FSL; convert it by fnirtfileutils "
                      "--in=FILE --out=FIELD --withaff");
  }
  if (options.image.empty()) {
    throw IoError(path, "",
                  "is a warp field of FSL, which leads to voxels of the image that it warps, and "
                  "here is none: warp an image by it");
  }
  if (kind_of(options.image) != FileKind::nifti) {
    throw IoError(options.image, "",
                  "is no NIfTI image, to whose voxels the warp field '" + path +
                      "' of FSL leads; convert it to NIfTI");
  }
  const FslSpace from = space_of(path), to = space_of(options.image);
  const std::vector<double> numbers = numbers_of(path, header);
  const FslWarp kind = options.fsl ? *options.fsl : kind_of_numbers(path, from, numbers);
  DisplacementField field{from.grid, std::vector<float>(numbers.size())};
  for_voxels(from.grid, [&](const Point3& voxel, std::size_t v) {
    const Point3 start = from.of_voxel(voxel), here = from.grid.world_of(voxel);
    Point3 x{numbers[3 * v], numbers[3 * v + 1], numbers[3 * v + 2]};
    for (std::size_t axis = 0; axis < 3 && kind == FslWarp::relative; ++axis)
      x[axis] += start[axis];
    const Point3 there = to.grid.world_of(to.voxel_of(x));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      field.displacement[3 * v + axis] = static_cast<float>(there[axis] - here[axis]);
    }
  });
  TransformFile file{std::move(field),
                     std::string(kind == FslWarp::relative ? "displacements" : "positions") +
                         " in scaled voxels of FSL (" + (options.fsl ? "--fsl" : "intent 2006") +
                         ")"};
  file.ends_with_field = true;
  return file;
}

}  // namespace tetwarp
