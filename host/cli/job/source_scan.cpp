/// @file source_scan.cpp
/// Reads a source in parts.
#include "host/cli/job/source_scan.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "host/base/pixel_dispatch.hpp"
#include "host/cli/common/interrupt.hpp"

namespace tetwarp::cli {
namespace {
void widen(std::vector<double>& range, PixelType type, std::span<const std::byte> bytes) {
  with_pixel_type(type, [&]<class T>(T) {
    const std::span samples(reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T));
    const std::size_t components = range.size() / 2;
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const double sample = static_cast<double>(samples[s]);
      const std::size_t c = s % components;
      if (sample < range[2 * c]) range[2 * c] = sample;
      if (sample > range[2 * c + 1]) range[2 * c + 1] = sample;
    }
  });
}
}  // namespace

std::vector<double> scan_source(const VolumeReader& source,
                                double bytes,
                                bool needs_range,
                                Fingerprint& fingerprint) {
  const ArrayHeader& array = source.array();
  const auto& dims = source.grid().dims;
  const auto components = static_cast<std::size_t>(array.components);
  const auto voxel = static_cast<std::int64_t>(components * size_of(array.type));
  constexpr double beyond = std::numeric_limits<double>::infinity();
  std::vector<double> range;
  for (std::size_t c = 0; needs_range && c < components; ++c) {
    range.insert(range.end(), {beyond, -beyond});
  }
  fingerprint.begin(array, source.grid());
  const auto max_rows =
      static_cast<std::int64_t>(std::max(1.0, bytes / static_cast<double>(dims[0] * voxel)));
  const std::int64_t rows = std::min(max_rows, dims[1]);
  const std::int64_t slices = std::clamp<std::int64_t>(max_rows / dims[1], 1, dims[2]);
  std::vector<std::byte> part(static_cast<std::size_t>(slices * rows * dims[0] * voxel));
  Region region{{0, 0, 0}, {dims[0], 0, 0}};
  for (std::int64_t k = 0; k < dims[2]; k = region.end[2]) {
    region.begin[2] = k;
    region.end[2] = std::min(k + slices, dims[2]);
    for (std::int64_t j = 0; j < dims[1]; j = region.end[1]) {
      stop_if_interrupted();
      region.begin[1] = j;
      region.end[1] = std::min(j + rows, dims[1]);
      source.read(region, part.data());
      const std::span<const std::byte> read(part.data(),
                                            static_cast<std::size_t>(region.voxel_count() * voxel));
      fingerprint.add_part(read);
      if (needs_range) widen(range, array.type, read);
    }
  }
  fingerprint.end();
  return range;
}

}  // namespace tetwarp::cli
