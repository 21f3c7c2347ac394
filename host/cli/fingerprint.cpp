/// @file fingerprint.cpp
#include "host/cli/fingerprint.hpp"

#include <fmt/format.h>

#include <cstring>

namespace tetwarp::cli {

void Fingerprint::mix(std::uint64_t word) {
  hash_ = (hash_ ^ word) * 0x100000001b3;
  hash_ ^= hash_ >> 32;
}

void Fingerprint::add(std::span<const std::byte> bytes) {
  mix(bytes.size());
  for (; bytes.size() >= sizeof(std::uint64_t); bytes = bytes.subspan(sizeof(std::uint64_t))) {
    std::uint64_t word;
    std::memcpy(&word, bytes.data(), sizeof word);
    mix(word);
  }
  std::uint64_t rest = 0;
  if (!bytes.empty()) std::memcpy(&rest, bytes.data(), bytes.size());
  mix(rest);
}

void Fingerprint::add(std::string_view text) {
  add(std::as_bytes(std::span(text)));
}

void Fingerprint::add(const Grid& grid) {
  add(grid.dims);
  add(grid.origin);
  add(grid.spacing);
  add(grid.direction);
}

void Fingerprint::add(const WarpOptions& options) {
  add(options.backend);
  add(options.filter);
  add(options.overshoot);
  add(options.antialias);
  add(options.intensity);
  add(options.quantities);
  add(options.outside);
  add(options.background);
  add(*options.output_grid);
}

void Fingerprint::add(const Volume& volume) {
  add(volume.name);
  add(volume.type);
  add(volume.components);
  add(volume.grid);
  add(volume.data);
}

std::string Fingerprint::text() const {
  return fmt::format("{:016x}", hash_);
}

}  // namespace tetwarp::cli
