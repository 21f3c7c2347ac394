/// @file names.hpp
/// The words of the public enums, as options of the command and reports spell them.
#pragma once
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

#include <tetwarp/export.hpp>

namespace tetwarp {

/// One enumerator and its word.
template <class Enum>
struct EnumName {
  Enum value;
  const char* name;
};

/// All words of an enum, in the order in which help lists them. Defined for Backend, PixelType,
/// Filter, LabelRule, Overshoot, Quantity, Intensity, Outside, Deformation, FrictionLaw,
/// AdhesionRule, ContactMethod, ContactCoupling, ContactMeasure, ContactPrecision, ContactStatus,
/// AdhesionIntegrator, BodyKind, TransferLookup, MaterialMean and MassKind, and in tetwarp::io for
/// Axes, ContactStart and FileKind; a use for another enum does not link.
template <class Enum>
TETWARP_EXPORT std::span<const EnumName<Enum>> names_of();

/// The word of an enumerator, e.g. "int16", "auto" or "not converged".
template <class Enum>
requires std::is_enum_v<Enum>
const char* name_of(Enum value) {
  for (const EnumName<Enum>& entry : names_of<Enum>()) {
    if (entry.value == value) return entry.name;
  }
  return "";
}

/// The enumerator of a word: parse<Filter>("linear").
/// @throws std::invalid_argument that lists the words
template <class Enum>
Enum parse(std::string_view word) {
  std::string listed;
  for (const EnumName<Enum>& entry : names_of<Enum>()) {
    if (word == entry.name) return entry.value;
    listed += (listed.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw std::invalid_argument("'" + std::string(word) + "' is not one of " + listed);
}

}  // namespace tetwarp
