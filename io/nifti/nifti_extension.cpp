/// @file nifti_extension.cpp
/// Makes and finds the extension.
#include "io/nifti/nifti_extension.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

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

NiftiExtensions read_extensions(const std::string& path,
                                bool is_swapped,
                                std::size_t header_bytes,
                                std::int64_t end) {
  NiftiExtensions found;
  NiftiStream stream(path, "rb", true);
  std::array<char, 4> announced{};
  auto at = static_cast<std::int64_t>(header_bytes);
  if (!stream || !stream.seek(at) || !stream.read(announced.data(), 4)) return found;
  at += 4;
  while (announced[0] != 0 && at + 16 <= end) {
    std::array<std::int32_t, 2> numbers{};
    if (!stream.read(numbers.data(), sizeof numbers)) break;
    if (is_swapped) {
      const auto bytes = std::as_writable_bytes(std::span(numbers));
      std::ranges::reverse(bytes);
      std::swap(numbers[0], numbers[1]);
    }
    const auto [size, code] = numbers;
    if (size < 16 || size > end - at) break;
    std::string text;
    if (code == comment_code && size <= largest) {
      text.resize(static_cast<std::size_t>(size - 8));
      if (!stream.read(text.data(), text.size())) break;
      text.resize(std::min(text.find('\0'), text.size()));
    }
    if (text.starts_with(key)) {
      found.fingerprint = text.substr(key.size());
    } else {
      found.others.push_back("extension of code " + std::to_string(code) + ", " +
                             std::to_string(size) + " bytes");
    }
    at += size;
    if (!stream.seek(at)) break;
  }
  return found;
}

}  // namespace tetwarp
