/// @file fingerprint.cpp
/// The hash of words, and what of options and volumes is hashed.
#include "host/cli/job/fingerprint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace tetwarp::cli {

void Fingerprint::add(std::span<const std::byte> bytes) {
  hash_.add_bits(bytes.size());
  add_part(bytes);
  end();
}

void Fingerprint::add_part(std::span<const std::byte> bytes) {
  const auto take = [&](std::size_t count) {
    std::memcpy(reinterpret_cast<std::byte*>(&rest_) + rest_bytes_, bytes.data(), count);
    rest_bytes_ += count;
    bytes = bytes.subspan(count);
  };
  const auto take_rest = [&] {
    if (!bytes.empty()) take(std::min(bytes.size(), sizeof rest_ - rest_bytes_));
  };
  if (rest_bytes_ > 0) take_rest();
  if (rest_bytes_ == sizeof rest_) end();
  for (; bytes.size() >= sizeof rest_; bytes = bytes.subspan(sizeof rest_)) {
    std::uint64_t word;
    std::memcpy(&word, bytes.data(), sizeof word);
    hash_.add_bits(word);
  }
  take_rest();
}

void Fingerprint::end() {
  hash_.add_bits(rest_);
  rest_ = 0;
  rest_bytes_ = 0;
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

void Fingerprint::add(const NiftiFacts& facts) {
  add(facts.sform_code);
  add(facts.qform_code);
  add(facts.xyzt_units);
  add(facts.intent_code);
  add(facts.intent_p);
  add(facts.intent_name);
  add(facts.description);
  add(facts.component_axes);
  add(facts.cal_min);
  add(facts.cal_max);
  add(facts.time_step);
}

void Fingerprint::add(const WarpOptions& options) {
  add(options.backend);
  add(options.filter);
  add(options.label_rule);
  add(options.label_gaussian.sigma);
  add(options.label_gaussian.cutoff);
  add(options.overshoot);
  add(options.antialias);
  add(options.intensity);
  add(options.quantities);
  add(options.outside);
  add(options.falloff);
  add(options.background);
  add(*options.output_grid);
}

void Fingerprint::add(const Volume& volume) {
  begin({volume.name, volume.type, volume.components}, volume.grid);
  add_part(volume.data);
  end();
}

void Fingerprint::begin(const ArrayHeader& array, const Grid& grid) {
  add(array.name);
  add(array.type);
  add(array.components);
  add(grid);
  hash_.add_bits(static_cast<std::size_t>(grid.voxel_count()) *
                 static_cast<std::size_t>(array.components) * size_of(array.type));
}

std::string Fingerprint::text() const {
  return fmt::format("{:016x}", hash_.value());
}

}  // namespace tetwarp::cli
