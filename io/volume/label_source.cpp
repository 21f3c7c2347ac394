/// @file label_source.cpp
/// Converts slice by slice.
#include "io/volume/label_source.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <tetwarp/error.hpp>
#include <utility>

namespace tetwarp {
namespace {
template <class Float>
void convert(const std::string& path,
             const std::string& array,
             const std::vector<std::byte>& from,
             std::int32_t* to) {
  using Limits = std::numeric_limits<std::int32_t>;
  const auto* const floats = reinterpret_cast<const Float*>(from.data());
  for (std::size_t s = 0; s < from.size() / sizeof(Float); ++s) {
    const double value = static_cast<double>(floats[s]);
    if (!(value >= Limits::min() && value <= Limits::max()) || value != std::nearbyint(value)) {
      throw IoError(path, array,
                    "holds " + std::to_string(value) +
                        ", which is no label: labels are whole numbers; use another filter");
    }
    to[s] = static_cast<std::int32_t>(value);
  }
}
}  // namespace

LabelSource::LabelSource(std::string path, std::unique_ptr<VolumeSource> floats)
    : path_(std::move(path)), floats_(std::move(floats)), array_(floats_->array()) {
  array_.type = PixelType::int32;
}

double LabelSource::chunk_bytes() const {
  const Grid& own = grid();
  const double slice = static_cast<double>(own.dims[0]) * static_cast<double>(own.dims[1]) *
                       floats_->array().components *
                       static_cast<double>(size_of(floats_->array().type));
  return floats_->chunk_bytes() + slice;
}

void LabelSource::read(const Region& region, void* samples) {
  const ArrayHeader& stored = floats_->array();
  auto* to = static_cast<std::int32_t*>(samples);
  Region slice = region;
  std::vector<std::byte> part;
  for (std::int64_t k = region.begin[2]; k < region.end[2]; ++k) {
    slice.begin[2] = k;
    slice.end[2] = k + 1;
    const auto count = static_cast<std::size_t>(slice.voxel_count() * stored.components);
    part.resize(count * size_of(stored.type));
    floats_->read(slice, part.data());
    stored.type == PixelType::float32 ? convert<float>(path_, stored.name, part, to)
                                      : convert<double>(path_, stored.name, part, to);
    to += count;
  }
}

}  // namespace tetwarp
