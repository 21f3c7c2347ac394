/// @file nifti_fields.cpp
/// Copies fields from and to bytes of either order.
#include "io/nifti/nifti_fields.hpp"

#include <algorithm>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

namespace tetwarp {
namespace {
/// Bytes 4 to 11 of NIfTI-2; the last five reveal changes that a transfer as text makes.
constexpr std::string_view single_magic_2("n+2\0\r\n\032\n", 8), pair_magic_2("ni2\0\r\n\032\n", 8);
constexpr std::string_view single_magic_1("n+1\0", 4), pair_magic_1("ni1\0", 4);

/// Reads fields from bytes.
class Decoder {
 public:
  Decoder(const std::vector<char>& bytes, bool is_swapped)
      : bytes_(bytes), is_swapped_(is_swapped) {}

  template <class Stored, class T>
  void number(std::size_t at, T& value) const {
    std::array<char, sizeof(Stored)> raw{};
    std::memcpy(raw.data(), bytes_.data() + at, raw.size());
    if (is_swapped_) std::reverse(raw.begin(), raw.end());
    Stored stored;
    std::memcpy(&stored, raw.data(), sizeof stored);
    value = static_cast<T>(stored);
  }

  void text(std::size_t at, std::size_t size, std::string& value) const {
    const char* const begin = bytes_.data() + at;
    value.assign(begin, std::find(begin, begin + size, '\0'));
  }

 private:
  const std::vector<char>& bytes_;
  bool is_swapped_;
};

/// Writes fields into bytes.
class Encoder {
 public:
  explicit Encoder(std::vector<char>& bytes) : bytes_(bytes) {}

  template <class Stored, class T>
  void number(std::size_t at, const T& value) const {
    const auto stored = static_cast<Stored>(value);
    std::memcpy(bytes_.data() + at, &stored, sizeof stored);
  }

  /// The last byte of the field stays zero.
  void text(std::size_t at, std::size_t size, const std::string& value) const {
    std::memcpy(bytes_.data() + at, value.data(), std::min(value.size(), size - 1));
  }

 private:
  std::vector<char>& bytes_;
};

template <class Stored, class Coder, class Numbers>
void numbers(const Coder& coder, std::size_t at, Numbers& values) {
  for (std::size_t n = 0; n < values.size(); ++n) {
    coder.template number<Stored>(at + n * sizeof(Stored), values[n]);
  }
}

/// Passes every field with its place and stored type to a Decoder or an Encoder.
template <class Coder, class Fields>
void exchange_1(const Coder& coder, Fields& fields) {
  coder.template number<std::uint8_t>(39, fields.dim_info);
  numbers<std::int16_t>(coder, 40, fields.dim);
  numbers<float>(coder, 56, fields.intent_p);
  coder.template number<std::int16_t>(68, fields.intent_code);
  coder.template number<std::int16_t>(70, fields.datatype);
  coder.template number<std::int16_t>(72, fields.bitpix);
  coder.template number<std::int16_t>(74, fields.slice_start);
  numbers<float>(coder, 76, fields.pixdim);
  coder.template number<float>(108, fields.vox_offset);
  coder.template number<float>(112, fields.scl_slope);
  coder.template number<float>(116, fields.scl_inter);
  coder.template number<std::int16_t>(120, fields.slice_end);
  coder.template number<std::uint8_t>(122, fields.slice_code);
  coder.template number<std::uint8_t>(123, fields.xyzt_units);
  coder.template number<float>(124, fields.cal_max);
  coder.template number<float>(128, fields.cal_min);
  coder.template number<float>(132, fields.slice_duration);
  coder.template number<float>(136, fields.toffset);
  coder.text(148, 80, fields.descrip);
  coder.text(228, 24, fields.aux_file);
  coder.template number<std::int16_t>(252, fields.qform_code);
  coder.template number<std::int16_t>(254, fields.sform_code);
  numbers<float>(coder, 256, fields.quatern);
  numbers<float>(coder, 268, fields.qoffset);
  for (std::size_t row = 0; row < 3; ++row) numbers<float>(coder, 280 + 16 * row, fields.srow[row]);
  coder.text(328, 16, fields.intent_name);
}

template <class Coder, class Fields>
void exchange_2(const Coder& coder, Fields& fields) {
  coder.template number<std::int16_t>(12, fields.datatype);
  coder.template number<std::int16_t>(14, fields.bitpix);
  numbers<std::int64_t>(coder, 16, fields.dim);
  numbers<double>(coder, 80, fields.intent_p);
  numbers<double>(coder, 104, fields.pixdim);
  coder.template number<std::int64_t>(168, fields.vox_offset);
  coder.template number<double>(176, fields.scl_slope);
  coder.template number<double>(184, fields.scl_inter);
  coder.template number<double>(192, fields.cal_max);
  coder.template number<double>(200, fields.cal_min);
  coder.template number<double>(208, fields.slice_duration);
  coder.template number<double>(216, fields.toffset);
  coder.template number<std::int64_t>(224, fields.slice_start);
  coder.template number<std::int64_t>(232, fields.slice_end);
  coder.text(240, 80, fields.descrip);
  coder.text(320, 24, fields.aux_file);
  coder.template number<std::int32_t>(344, fields.qform_code);
  coder.template number<std::int32_t>(348, fields.sform_code);
  numbers<double>(coder, 352, fields.quatern);
  numbers<double>(coder, 376, fields.qoffset);
  for (std::size_t row = 0; row < 3; ++row) {
    numbers<double>(coder, 400 + 32 * row, fields.srow[row]);
  }
  coder.template number<std::int32_t>(496, fields.slice_code);
  coder.template number<std::int32_t>(500, fields.xyzt_units);
  coder.template number<std::int32_t>(504, fields.intent_code);
  coder.text(508, 16, fields.intent_name);
  coder.template number<std::uint8_t>(524, fields.dim_info);
}

template <class Coder, class Fields>
void exchange(const Coder& coder, Fields& fields) {
  fields.version == 1 ? exchange_1(coder, fields) : exchange_2(coder, fields);
}
}  // namespace

NiftiStart decode_nifti(const std::vector<char>& bytes) {
  NiftiStart start;
  if (bytes.size() < 348) return start;
  std::int32_t size = 0;
  Decoder(bytes, false).number<std::int32_t>(0, size);
  if (size != 348 && size != 540) {
    Decoder(bytes, true).number<std::int32_t>(0, size);
    start.is_swapped = true;
  }
  NiftiFields fields;
  const auto has_magic = [&](std::size_t at, std::string_view magic) {
    return std::string_view(bytes.data() + at, magic.size()) == magic;
  };
  if (size == 348) {
    fields.is_pair = has_magic(344, pair_magic_1);
    start.is_analyze = !fields.is_pair && !has_magic(344, single_magic_1);
    if (start.is_analyze) return start;
  } else if (size == 540 && bytes.size() >= 540) {
    fields.version = 2;
    fields.is_pair = has_magic(4, pair_magic_2);
    if (!fields.is_pair && !has_magic(4, single_magic_2)) return start;
  } else {
    return start;
  }
  exchange(Decoder(bytes, start.is_swapped), fields);
  const std::size_t announced = fields.header_bytes();
  start.has_extensions = announced < bytes.size() && bytes[announced] != 0;
  start.fields = fields;
  return start;
}

std::vector<char> encode_nifti(const NiftiFields& fields, bool has_extensions) {
  std::vector<char> bytes(fields.header_bytes() + 4);
  const Encoder encoder(bytes);
  encoder.number<std::int32_t>(0, fields.header_bytes());
  const std::string_view magic = fields.version == 1 ? single_magic_1 : single_magic_2;
  std::ranges::copy(magic, bytes.begin() + (fields.version == 1 ? 344 : 4));
  if (fields.version == 1) bytes[38] = 'r';  // `regular`, which SPM requires
  exchange(encoder, fields);
  bytes[fields.header_bytes()] = has_extensions ? 1 : 0;
  return bytes;
}

}  // namespace tetwarp
