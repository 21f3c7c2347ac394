/// @file nifti_volume.cpp
/// Samples of NIfTI volumes. They are read and written here and not by the library, which replaces
/// NaN by zero and does not report a full disk.
#include <cstring>
#include <tetwarp/io.hpp>

#include "io/finished_file.hpp"
#include "io/h5.hpp"
#include "io/nifti_components.hpp"
#include "io/nifti_header.hpp"

namespace tetwarp {
namespace {
/// Calls `body` with a value of the C++ type of `type`.
template <class Body>
void with_type(PixelType type, const Body& body) {
  switch (type) {
    case PixelType::uint8:
      return body(std::uint8_t{});
    case PixelType::int8:
      return body(std::int8_t{});
    case PixelType::uint16:
      return body(std::uint16_t{});
    case PixelType::int16:
      return body(std::int16_t{});
    case PixelType::uint32:
      return body(std::uint32_t{});
    case PixelType::int32:
      return body(std::int32_t{});
    case PixelType::uint64:
      return body(std::uint64_t{});
    case PixelType::int64:
      return body(std::int64_t{});
    case PixelType::float32:
      return body(float{});
    case PixelType::float64:
      return body(double{});
  }
}

/// Copies `count` elements of `size` bytes from every `in_stride`-th to every `out_stride`-th one.
void copy_strided(const std::byte* in,
                  std::size_t in_stride,
                  std::byte* out,
                  std::size_t out_stride,
                  std::size_t size,
                  std::size_t count) {
  if (in_stride == 1 && out_stride == 1) {
    std::memcpy(out, in, size * count);
    return;
  }
  for (std::size_t v = 0; v < count; ++v) {
    std::memcpy(out + v * out_stride * size, in + v * in_stride * size, size);
  }
}

/// Stores slope * sample + intercept of one slice, or its negative, as component `c` of `out`.
void scale_slice(const std::vector<std::byte>& slice,
                 const NiftiHeader& header,
                 Volume& out,
                 std::size_t first,
                 std::size_t c,
                 bool is_negated) {
  const auto components = static_cast<std::size_t>(out.components);
  with_type(header.type, [&](auto sample) {
    const std::size_t count = slice.size() / sizeof sample;
    for (std::size_t v = 0; v < count; ++v) {
      std::memcpy(&sample, slice.data() + v * sizeof sample, sizeof sample);
      double value = header.slope * static_cast<double>(sample) + header.intercept;
      if (is_negated) value = 0 - value;
      const std::size_t place = (first + v) * components + c;
      if (out.type == PixelType::float64) {
        out.samples<double>()[place] = value;
      } else {
        out.samples<float>()[place] = static_cast<float>(value);
      }
    }
  });
}
}  // namespace

NiftiFacts read_nifti_facts(const std::string& path, Axes axes) {
  NiftiFacts facts = read_nifti_header(path).facts;
  facts.component_axes = axes;
  return facts;
}

Volume read_nifti(const std::string& path, Axes axes) {
  const NiftiHeader header = read_nifti_header(path);
  PixelType type = header.type;
  if (header.is_scaled() && type != PixelType::float64) type = PixelType::float32;
  const ComponentMap map =
      component_map(path, type, header.components, header.facts.intent_code, axes);
  const double bytes = static_cast<double>(header.grid.voxel_count()) * header.components *
                       static_cast<double>(size_of(type));
  h5::check_memory(path, "", bytes);
  Volume volume = make_volume(header.grid, type, header.components);

  NiftiStream stream(path, "rb", true);
  bool is_good = stream && stream.seek(header.data_offset);
  const std::size_t size = size_of(header.type);
  const std::size_t slice_voxels =
      static_cast<std::size_t>(header.grid.dims[0] * header.grid.dims[1]);
  const auto slices = static_cast<std::size_t>(header.grid.dims[2]);
  const auto components = static_cast<std::size_t>(header.components);
  std::vector<std::byte> slice(slice_voxels * size);
  // The file stores one component after the other.
  for (std::size_t c = 0; c < components; ++c) {
    for (std::size_t k = 0; k < slices && is_good; ++k) {
      is_good = stream.read(slice.data(), slice.size());
      if (header.is_swapped && size > 1) {
        nifti_swap_Nbytes(slice_voxels, static_cast<int>(size), slice.data());
      }
      const std::size_t first = k * slice_voxels;
      if (header.is_scaled()) {
        scale_slice(slice, header, volume, first, map.place[c], map.is_negated[c]);
      } else {
        if (map.is_negated[c]) negate_samples(type, slice);
        std::byte* out = volume.data.data() + (first * components + map.place[c]) * size;
        copy_strided(slice.data(), 1, out, components, size, slice_voxels);
      }
    }
  }
  if (!is_good) throw IoError(path, "", "ends before its last sample: truncated, copy it again");
  return volume;
}

void write_nifti(const std::string& path,
                 const Volume& volume,
                 Axes axes,
                 const std::optional<NiftiFacts>& given_facts) {
  const bool is_compressed = path.ends_with(".nii.gz");
  if (!is_compressed && !path.ends_with(".nii")) {
    throw IoError(path, "", "the name of a NIfTI image must end in .nii or .nii.gz");
  }
  static_cast<void>(VolumeView(volume));  // checks that the samples fill the grid
  NiftiFacts facts = given_facts.value_or(default_nifti_facts(volume.components));
  if (axes == Axes::lps && facts.intent_code == NIFTI_INTENT_DISPVECT) {
    facts.intent_code = NIFTI_INTENT_VECTOR;
  }
  const ComponentMap map =
      component_map(path, volume.type, volume.components, facts.intent_code, axes);
  const nifti_1_header header = make_nifti_header(path, volume, facts);
  const char no_extensions[4] = {0, 0, 0, 0};
  FinishedFile file(path);
  NiftiStream stream(file.temporary(), "wb", is_compressed);
  bool is_good = stream && stream.write(&header, sizeof header) &&
                 stream.write(no_extensions, sizeof no_extensions);

  const std::size_t size = size_of(volume.type);
  const std::size_t slice_voxels =
      static_cast<std::size_t>(volume.grid.dims[0] * volume.grid.dims[1]);
  const auto slices = static_cast<std::size_t>(volume.grid.dims[2]);
  const auto components = static_cast<std::size_t>(volume.components);
  std::vector<std::byte> slice(slice_voxels * size);
  for (std::size_t c = 0; c < components; ++c) {
    for (std::size_t k = 0; k < slices && is_good; ++k) {
      const std::byte* in =
          volume.data.data() + (k * slice_voxels * components + map.place[c]) * size;
      copy_strided(in, components, slice.data(), 1, size, slice_voxels);
      if (map.is_negated[c]) negate_samples(volume.type, slice);
      is_good = stream.write(slice.data(), slice.size());
    }
  }
  if (!stream.close() || !is_good)
    throw IoError(path, "", "cannot be written; check the free space of the disk");
  file.finish();
}

}  // namespace tetwarp
