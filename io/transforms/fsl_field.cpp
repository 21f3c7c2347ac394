/// @file fsl_field.cpp
/// Reads the numbers, finds whether they are relative or absolute, and turns them to displacements
/// in RAS.
#include "io/transforms/fsl_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <tetwarp/io.hpp>
#include <utility>
#include <vector>

#include "host/base/point3.hpp"
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

/// The three numbers of voxels: along the axis of time, as FSL writes them, or of components.
class FslNumbers {
 public:
  FslNumbers(const std::string& path, const NiftiHeader& header) {
    const bool are_steps = header.steps == 3 && header.components == 1;
    if (!are_steps && !(header.steps == 1 && header.components == 3)) {
      throw IoError(path, "",
                    "has " + std::to_string(header.steps) + " steps of " +
                        std::to_string(header.components) +
                        " components, expected the three volumes of a warp field of FSL");
    }
    for (std::int64_t step = 0; step < (are_steps ? 3 : 1); ++step) {
      readers_.emplace_back(path, "", step);
    }
    const ArrayHeader& array = readers_.front().array();
    if (array.type != PixelType::float32 && array.type != PixelType::float64) {
      throw IoError(path, array.name,
                    std::string("is of ") + name_of(array.type) + ", expected float32 or float64");
    }
  }

  const Grid& grid() const { return readers_.front().grid(); }
  /// Memory of a voxel while it is read: displacements, numbers, and those of a reader.
  double voxel_bytes() const { return 12 + 24 + 24; }

  std::vector<double> read(const Region& region) const {
    return readers_.front().array().type == PixelType::float32 ? read_as<float>(region)
                                                               : read_as<double>(region);
  }

 private:
  template <class T>
  std::vector<double> read_as(const Region& region) const {
    const std::size_t stride = readers_.size();
    std::vector<double> numbers(3 * static_cast<std::size_t>(region.voxel_count()));
    std::vector<T> samples(numbers.size() / stride);
    for (std::size_t r = 0; r < stride; ++r) {
      readers_[r].read(region, samples.data());
      for (std::size_t n = 0; n < samples.size(); ++n) {
        numbers[stride * n + r] = static_cast<double>(samples[n]);
      }
    }
    return numbers;
  }

  std::vector<VolumeReader> readers_;
};

/// Calls visit(voxel, its number) for all voxels of a region.
template <class Visit>
void for_voxels(const Region& region, const Visit& visit) {
  std::size_t v = 0;
  for (std::int64_t k = region.begin[2]; k < region.end[2]; ++k) {
    for (std::int64_t j = region.begin[1]; j < region.end[1]; ++j) {
      for (std::int64_t i = region.begin[0]; i < region.end[0]; ++i, ++v) {
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
FslWarp kind_of_numbers(const std::string& path, const FslSpace& space, const FslNumbers& numbers) {
  const auto& dims = space.grid.dims;
  constexpr std::int64_t most_voxels = 1 << 18;  // in memory
  const std::int64_t slices = std::max<std::int64_t>(1, most_voxels / (dims[0] * dims[1]));
  Spread as_they_are, without_place;
  for (std::int64_t k = 0; k < dims[2]; k += slices) {
    const Region region{{0, 0, k}, {dims[0], dims[1], std::min(k + slices, dims[2])}};
    const std::vector<double> some = numbers.read(region);
    for_voxels(region, [&](const Point3& voxel, std::size_t v) {
      const Point3 x = space.of_voxel(voxel);
      const Point3 number{some[3 * v], some[3 * v + 1], some[3 * v + 2]};
      as_they_are.add(number);
      without_place.add({number[0] - x[0], number[1] - x[1], number[2] - x[2]});
    });
  }
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

TransformParts open_fsl_field(const std::string& path, const TransformReadOptions& options) {
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
  const auto numbers = std::make_shared<const FslNumbers>(path, header);
  const FslWarp kind = options.fsl ? *options.fsl : kind_of_numbers(path, from, *numbers);
  FieldReader reader{[numbers, from, to, kind](const Region& region, float* displacement) {
                       const std::vector<double> some = numbers->read(region);
                       for_voxels(region, [&](const Point3& voxel, std::size_t v) {
                         Point3 x{some[3 * v], some[3 * v + 1], some[3 * v + 2]};
                         if (kind == FslWarp::relative) x = plus(x, from.of_voxel(voxel));
                         const Point3 there = to.grid.world_of(to.voxel_of(x));
                         const Point3 here = from.grid.world_of(voxel);
                         for (std::size_t axis = 0; axis < 3; ++axis) {
                           displacement[3 * v + axis] =
                               static_cast<float>(there[axis] - here[axis]);
                         }
                       });
                     },
                     numbers->voxel_bytes()};
  TransformFile file{DisplacementField{from.grid, {}},
                     std::string(kind == FslWarp::relative ? "displacements" : "positions") +
                         " in scaled voxels of FSL (" + (options.fsl ? "--fsl" : "intent 2006") +
                         ")"};
  file.ends_with_field = true;
  return {std::move(file), {std::move(reader)}};
}

}  // namespace tetwarp
