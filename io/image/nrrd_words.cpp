/// @file nrrd_words.cpp
/// Names of types, spaces and fields.
#include "io/image/nrrd_words.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <sstream>
#include <vector>

namespace tetwarp {
namespace {
struct TypeName {
  const char* name;
  PixelType type;
};
constexpr TypeName type_names[] = {{"uint8", PixelType::uint8},
                                   {"uchar", PixelType::uint8},
                                   {"unsigned char", PixelType::uint8},
                                   {"uint8_t", PixelType::uint8},
                                   {"int8", PixelType::int8},
                                   {"signed char", PixelType::int8},
                                   {"int8_t", PixelType::int8},
                                   {"uint16", PixelType::uint16},
                                   {"ushort", PixelType::uint16},
                                   {"unsigned short", PixelType::uint16},
                                   {"unsigned short int", PixelType::uint16},
                                   {"uint16_t", PixelType::uint16},
                                   {"int16", PixelType::int16},
                                   {"short", PixelType::int16},
                                   {"short int", PixelType::int16},
                                   {"signed short", PixelType::int16},
                                   {"signed short int", PixelType::int16},
                                   {"int16_t", PixelType::int16},
                                   {"uint32", PixelType::uint32},
                                   {"uint", PixelType::uint32},
                                   {"unsigned int", PixelType::uint32},
                                   {"uint32_t", PixelType::uint32},
                                   {"int32", PixelType::int32},
                                   {"int", PixelType::int32},
                                   {"signed int", PixelType::int32},
                                   {"int32_t", PixelType::int32},
                                   {"uint64", PixelType::uint64},
                                   {"ulonglong", PixelType::uint64},
                                   {"unsigned long long", PixelType::uint64},
                                   {"unsigned long long int", PixelType::uint64},
                                   {"uint64_t", PixelType::uint64},
                                   {"int64", PixelType::int64},
                                   {"longlong", PixelType::int64},
                                   {"long long", PixelType::int64},
                                   {"long long int", PixelType::int64},
                                   {"signed long long", PixelType::int64},
                                   {"signed long long int", PixelType::int64},
                                   {"int64_t", PixelType::int64},
                                   {"float", PixelType::float32},
                                   {"double", PixelType::float64}};

/// The axes of a space, and which of them point against RAS.
struct Space {
  const char* name;
  const char* short_name;
  std::array<bool, 3> is_negated;
};
constexpr Space spaces[] = {{"rightanteriorsuperior", "ras", {false, false, false}},
                            {"leftanteriorsuperior", "las", {true, false, false}},
                            {"leftposteriorsuperior", "lps", {true, true, false}}};
}  // namespace

std::string lower_case(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

std::string nrrd_field(const std::string& written) {
  const std::string name = lower_case(written);
  for (const std::string usual :
       {"axis mins", "axis maxs", "byte skip", "data file", "line skip", "sample units"}) {
    std::string joined = usual;
    std::erase(joined, ' ');
    if (name == joined) return usual;
  }
  return name == "centerings" ? "centers" : name;
}

std::optional<PixelType> nrrd_type(const std::string& name) {
  const auto* const known =
      std::find_if(std::begin(type_names), std::end(type_names),
                   [&](const TypeName& entry) { return lower_case(name) == entry.name; });
  return known == std::end(type_names) ? std::nullopt : std::optional(known->type);
}

const char* nrrd_type_name(PixelType type) {
  return std::find_if(std::begin(type_names), std::end(type_names),
                      [&](const TypeName& entry) { return type == entry.type; })
      ->name;
}

bool is_unit_frame(const std::string& frame) {
  std::string text = frame;
  for (char& c : text) c = c == '(' || c == ')' || c == ',' ? ' ' : c;
  std::istringstream words(text);
  const std::vector<double> entries{std::istream_iterator<double>(words), {}};
  const std::size_t axes = entries.size() == 4 ? 2 : 3;
  for (std::size_t n = 0; n < entries.size(); ++n) {
    if (entries[n] != (n % (axes + 1) == 0 ? 1 : 0)) return false;
  }
  return words.eof() && entries.size() == axes * axes;
}

bool may_be_displacement(const std::string& kind) {
  static const std::set<std::string> kinds{"",     "vector", "2-vector", "3-vector",
                                           "list", "none",   "???"};
  return kinds.contains(kind);
}

std::optional<std::array<bool, 3>> nrrd_space(const std::string& written) {
  std::string name = lower_case(written);
  std::erase_if(name, [](char c) { return c == '-' || c == ' '; });
  const auto* const known = std::find_if(
      std::begin(spaces), std::end(spaces),
      [&](const Space& entry) { return name == entry.name || name == entry.short_name; });
  return known == std::end(spaces) ? std::nullopt : std::optional(known->is_negated);
}

}  // namespace tetwarp
