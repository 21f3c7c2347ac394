/// @file samples.hpp
/// Samples of several arrays over one region.
#pragma once
#include <cstddef>
#include <memory>
#include <vector>

#include <tetwarp/io.hpp>

namespace tetwarp::cli {

/// One entry per array.
using Samples = std::vector<std::unique_ptr<std::byte[]>>;

inline std::size_t bytes_of(const ArrayHeader& array, const Region& region) {
  return static_cast<std::size_t>(region.voxel_count() * array.components) * size_of(array.type);
}

/// Memory for samples, not initialized.
inline Samples make_samples(const std::vector<ArrayHeader>& arrays, const Region& region) {
  Samples samples;
  for (const ArrayHeader& array : arrays) {
    samples.push_back(std::make_unique_for_overwrite<std::byte[]>(bytes_of(array, region)));
  }
  return samples;
}

}  // namespace tetwarp::cli
