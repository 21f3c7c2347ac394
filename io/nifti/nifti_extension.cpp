/// @file nifti_extension.cpp
/// Makes and finds the extension.
#include "io/nifti/nifti_extension.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace tetwarp {
namespace {
const std::string key = "tetwarp_fingerprint ";
constexpr std::int32_t comment_code = 6;
constexpr std::int32_t largest = 256;  // bytes of an extension that may hold a fingerprint
}  // namespace

std::vector<char> fingerprint_extension(const std::string& fingerprint) {
  if (fingerprint.empty()) return {};
  const std::string text = key + fingerprint;
  const std::size_t size = (8 + text.size() + 15) / 16 * 16;
  const std::int32_t numbers[2] = {static_cast<std::int32_t>(size), comment_code};
  std::vector<char> bytes(size);
  std::memcpy(bytes.data(), numbers, sizeof numbers);
  std::memcpy(bytes.data() + sizeof numbers, text.data(), text.size());
  return bytes;
}

std::string read_fingerprint_extension(const std::string& path,
                                       bool is_swapped,
                                       std::size_t header_bytes,
                                       std::int64_t data_offset) {
  NiftiStream stream(path, "rb", true);
  std::array<char, 4> announced{};
  auto at = static_cast<std::int64_t>(header_bytes);
  // A file of this program has the order of its machine.
  if (is_swapped || !stream || !stream.seek(at) || !stream.read(announced.data(), 4)) return {};
  at += 4;
  while (announced[0] != 0 && at + 16 <= data_offset) {
    std::int32_t numbers[2];
    if (!stream.read(numbers, sizeof numbers)) return {};
    const std::int32_t size = numbers[0];
    if (size < 16 || size > data_offset - at) return {};
    if (numbers[1] == comment_code && size <= largest) {
      std::string text(static_cast<std::size_t>(size - 8), '\0');
      if (!stream.read(text.data(), text.size())) return {};
      text.resize(std::min(text.find('\0'), text.size()));
      if (text.starts_with(key)) return text.substr(key.size());
    }
    at += size;
    if (!stream.seek(at)) return {};
  }
  return {};
}

}  // namespace tetwarp
