/// @file fsl_field.cpp
/// Reads the numbers, finds whether they are relative or absolute, and turns them to displacements
/// in RAS.
#include "io/transforms/fsl_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <tetwarp/io.hpp>
#include <tetwarp/itk_space.hpp>
#include <utility>
#include <vector>

#include "host/base/point3.hpp"
#include "io/nifti/nifti_fields.hpp"
#include "io/nifti/nifti_samples.hpp"
#include "io/transforms/field_file.hpp"

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
  FslNumbers(const std::string& path, NiftiHeader header, const std::string& scratch) {
    const std::string found = "has " + std::to_string(header.steps) + " steps of " +
                              std::to_string(header.components) + " components";
    if (header.steps == 1 && header.components == 3) {
      header.steps = 3;  // which lie in a file as three components do
      header.components = 1;
    }
    if (header.steps != 3 || header.components != 1) {
      throw IoError(path, "", found + ", expected the three volumes of a warp field of FSL");
    }
    if (header.value_type() != PixelType::float32 && header.value_type() != PixelType::float64) {
      throw IoError(
          path, "",
          std::string("is of ") + name_of(header.value_type()) + ", expected float32 or float64");
    }
    for (std::int64_t axis = 0; axis < 3; ++axis) {
      axes_.emplace_back(path, header, axis, Axes::ras, scratch);
    }
  }

  /// What reads displacements that `read` makes of these numbers: they and the numbers of one axis
  /// and of all are in memory.
  FieldReader reader(std::function<void(const Region&, float*)> read) const {
    return {std::move(read), 12 + 8 + 24, axes_.front().buffer_bytes(),
            3 * axes_.front().unpacked_bytes()};
  }

  std::vector<double> read(const Region& region) {
    std::vector<double> numbers(3 * static_cast<std::size_t>(region.voxel_count()));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      visit(axis, region, &NiftiSamples::read,
            [&](std::size_t v, double number) { numbers[3 * v + axis] = number; });
    }
    return numbers;
  }

  /// Calls take(voxel of the region, number).
  /// @pre regions follow each other as NiftiSamples::read_in_order() requires
  template <class Take>
  void read_in_order(std::size_t axis, const Region& region, const Take& take) {
    visit(axis, region, &NiftiSamples::read_in_order, take);
  }

 private:
  template <class Read, class Take>
  void visit(std::size_t axis, const Region& region, Read read, const Take& take) {
    const bool is_single = axes_[axis].header().value_type() == PixelType::float32;
    const auto count = static_cast<std::size_t>(region.voxel_count());
    std::vector<float> singles(is_single ? count : 0);
    std::vector<double> doubles(is_single ? 0 : count);
    (axes_[axis].*read)(region, is_single ? static_cast<void*>(singles.data()) : doubles.data());
    for (std::size_t v = 0; v < count; ++v) {
      take(v, is_single ? static_cast<double>(singles[v]) : doubles[v]);
    }
  }

  std::deque<NiftiSamples> axes_;
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

/// Sum of squares about the mean.
class Spread {
 public:
  void add(double x) {
    const double apart = x - mean_;
    mean_ += apart / ++count_;
    sum_ += apart * (x - mean_);
  }
  double sum() const { return sum_; }

 private:
  double count_ = 0, mean_ = 0, sum_ = 0;
};

/// Displacements spread less than the coordinates of an image, positions as much as these. Reads
/// axis by axis, in the order of the file.
FslWarp kind_of_numbers(const std::string& path, const FslSpace& space, FslNumbers& numbers) {
  const auto& dims = space.grid.dims;
  constexpr std::int64_t most_voxels = 1 << 18;  // in memory
  const std::int64_t slices = std::max<std::int64_t>(1, most_voxels / (dims[0] * dims[1]));
  double as_they_are = 0, without_place = 0;  // sums of squares about the mean
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Spread number, rest;
    for (std::int64_t k = 0; k < dims[2]; k += slices) {
      const Region region{{0, 0, k}, {dims[0], dims[1], std::min(k + slices, dims[2])}};
      numbers.read_in_order(axis, region, [&](std::size_t v, double x) {
        const auto n = static_cast<std::int64_t>(v);
        const Point3 voxel{static_cast<double>(n % dims[0]),
                           static_cast<double>(n / dims[0] % dims[1]),
                           static_cast<double>(k + n / (dims[0] * dims[1]))};
        if (!std::isfinite(x))
          fail_not_finite(path, {n % dims[0], n / dims[0] % dims[1], k + n / (dims[0] * dims[1])});
        number.add(x);
        rest.add(x - space.of_voxel(voxel)[axis]);
      });
    }
    as_they_are += number.sum();
    without_place += rest.sum();
  }
  if (4 * as_they_are < without_place) return FslWarp::relative;
  if (4 * without_place < as_they_are) return FslWarp::absolute;
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

TransformParts open_fsl_field(const std::string& path,
                              const TransformReadOptions& options,
                              const Point3& world) {
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
  const auto numbers = std::make_shared<FslNumbers>(path, header, options.scratch);
  const FslWarp kind = options.fsl ? *options.fsl : kind_of_numbers(path, from, *numbers);
  const Grid field_grid = scaled(from.grid, ratio(itk_factor(header.facts), world));
  const auto read = [numbers, from, to, kind, field_grid](const Region& region,
                                                          float* displacement) {
    const std::vector<double> some = numbers->read(region);
    for_voxels(region, [&](const Point3& voxel, std::size_t v) {
      Point3 x{some[3 * v], some[3 * v + 1], some[3 * v + 2]};
      if (kind == FslWarp::relative) x = plus(x, from.of_voxel(voxel));
      const Point3 there = to.grid.world_of(to.voxel_of(x));
      const Point3 here = field_grid.world_of(voxel);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        displacement[3 * v + axis] = static_cast<float>(there[axis] - here[axis]);
      }
    });
  };
  TransformFile file{DisplacementField{field_grid, {}},
                     std::string(kind == FslWarp::relative ? "displacements" : "positions") +
                         " in scaled voxels of FSL (" + (options.fsl ? "--fsl" : "intent 2006") +
                         ")"};
  file.ends_with_field = true;
  return {std::move(file), {numbers->reader(read)}};
}

}  // namespace tetwarp
