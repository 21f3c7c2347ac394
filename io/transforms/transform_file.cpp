/// @file transform_file.cpp
/// Chooses the reader of a transform.
#include <tetwarp/transform_file.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tetwarp/io.hpp>
#include <tetwarp/itk_space.hpp>
#include <utility>
#include <variant>

#include "io/files/extension.hpp"
#include "io/h5/h5.hpp"
#include "io/transforms/field_file.hpp"
#include "io/transforms/fsl_field.hpp"
#include "io/transforms/itk_transform.hpp"
#include "io/transforms/itk_transform_files.hpp"

namespace tetwarp {
namespace {
bool has_transform_name(const std::string& path) {
  return has_extension(path, ".tfm") || has_extension(path, ".txt") || has_extension(path, ".mat");
}

/// Whether an image of so many components may be a displacement field.
bool may_be_field(int components, const Grid& grid) {
  return components == 3 || (components == 2 && grid.dims[2] == 1);
}

const char* what_of(const Transform& transform) {
  if (std::holds_alternative<AffineTransform>(transform)) return "affine transform";
  if (std::holds_alternative<DisplacementField>(transform)) return "displacement field";
  if (std::holds_alternative<BSplineTransform>(transform)) return "B-spline";
  return "composite";
}

/// @throws IoError  naming the first voxel of a region whose displacement is not finite
void check_displacement(const std::string& path, const Region& region, const float* displacement) {
  const std::int64_t count = 3 * region.voxel_count();
  std::uint32_t largest = 0;  // bits of sizes have their order, those that are not finite last
  for (std::int64_t n = 0; n < count; ++n) {
    largest = std::max(largest, std::bit_cast<std::uint32_t>(displacement[n]) & 0x7fffffff);
  }
  if (largest < 0x7f800000) return;
  const auto is_finite = [](float number) { return std::isfinite(number); };
  std::int64_t voxel =
      (std::find_if_not(displacement, displacement + count, is_finite) - displacement) / 3;
  std::array<std::int64_t, 3> place{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t size = region.end[axis] - region.begin[axis];
    place[axis] = region.begin[axis] + voxel % size;
    voxel /= size;
  }
  fail_not_finite(path, place);
}

/// itk_factor() of the positions that a transform is for.
Point3 world_of(const TransformReadOptions& options) {
  if (options.world) return *options.world;
  if (options.image.empty()) return {1, 1, 1};
  return itk_factor(options.image, read_volume_header(options.image)).value_or(Point3{1, 1, 1});
}

TransformParts opened(const std::string& path, const TransformReadOptions& options) {
  if (!has_transform_name(path)) {
    switch (kind_of(path)) {
      case FileKind::nifti:
        return is_fsl_field(read_nifti_header(path), options)
                   ? open_fsl_field(path, options, world_of(options))
                   : open_nifti_field(path, options, world_of(options));
      case FileKind::image:
        return open_image_field(path, options, world_of(options));
      case FileKind::hdf5:
        break;
      default:
        return open_volume_field(path, options, world_of(options));
    }
  }
  TransformParts parts = transform_of(path,
                                      has_extension(path, ".mat") ? read_itk_matlab(path)
                                      : has_transform_name(path)  ? read_itk_text(path)
                                                                  : read_itk_hdf5(path),
                                      world_of(options));
  parts.file.convention = std::string(what_of(parts.file.transform)) + " of ITK along LPS axes";
  return parts;
}

}  // namespace

bool is_transform_file(const std::string& path, const TransformReadOptions& options) {
  if (has_transform_name(path)) return true;
  switch (kind_of(path)) {
    case FileKind::nifti: {
      const NiftiHeader header = read_nifti_header(path);
      return may_be_field(header.components, header.grid) || is_fsl_field(header, options);
    }
    case FileKind::image: {
      const VolumeHeader header = read_volume_header(path);
      return may_be_field(header.arrays.front().components, header.grid);
    }
    case FileKind::volume: {
      const std::vector<ArrayHeader> arrays = read_volume_header(path).arrays;
      return std::any_of(arrays.begin(), arrays.end(), [](const ArrayHeader& array) {
        return array.name == "tetwarp_displacement";
      });
    }
    case FileKind::hdf5:
      return is_itk_hdf5(path);
    default:
      return false;
  }
}

std::int64_t transform_step_count(const std::string& path, const TransformReadOptions& options) {
  if (has_transform_name(path)) return 1;
  const FileKind kind = kind_of(path);
  if (kind != FileKind::nifti && kind != FileKind::image && kind != FileKind::volume) return 1;
  if (kind == FileKind::nifti && is_fsl_field(read_nifti_header(path), options)) return 1;
  return std::max<std::int64_t>(1, std::ssize(read_volume_header(path).times));
}

TransformFile read_transform(const std::string& path, const TransformReadOptions& options) {
  TransformParts parts = open_transform(path, options);
  Transform& transform = parts.file.transform;
  auto* const chain = std::get_if<TransformChain>(&transform);
  for (std::size_t n = 0; n < parts.fields.size(); ++n) {
    auto* const field = chain == nullptr ? std::get_if<DisplacementField>(&transform)
                                         : std::get_if<DisplacementField>(&chain->links[n]);
    if (field == nullptr) continue;
    const std::int64_t voxels = field->grid.voxel_count();
    h5::check_memory(path, "", parts.fields[n].voxel_bytes * static_cast<double>(voxels));
    field->displacement.resize(3 * static_cast<std::size_t>(voxels));
    parts.fields[n].read({{0, 0, 0}, field->grid.dims}, field->displacement.data());
  }
  return std::move(parts.file);
}

TransformParts open_transform(const std::string& path, const TransformReadOptions& options) {
  const std::int64_t steps = transform_step_count(path, options);
  if (steps > 1 && !options.step) {
    throw IoError(path, "",
                  "holds " + std::to_string(steps) +
                      " steps of a displacement field; choose one by --steps N");
  }
  if (options.step && (*options.step < 0 || *options.step >= steps)) {
    throw IoError(path, "", "has no step " + std::to_string(*options.step));
  }
  TransformParts parts = opened(path, options);
  if (!options.takes_inverted && std::ranges::count(parts.file.is_inverted, true) > 0) {
    throw IoError(path, "",
                  "leads from the source to the output, and its inverse is needed; write that by "
                  "tetwarp compose " +
                      path + " -o FIELD --like IMAGE, and read FIELD");
  }
  for (FieldReader& field : parts.fields) {
    if (!field.read) continue;  // of a transform that is no field
    field.read = [path, read = std::move(field.read)](const Region& region, float* displacement) {
      read(region, displacement);
      check_displacement(path, region, displacement);
    };
  }
  return parts;
}

}  // namespace tetwarp
