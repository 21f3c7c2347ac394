/// @file nrrd_words.hpp
/// Names and words in NRRD headers, which have no case.
#pragma once
#include <array>
#include <optional>
#include <string>

#include <tetwarp/volume.hpp>

namespace tetwarp {

/// Key of 3D Slicer: where the displacements of a field lead. "resampling", as without it: from the
/// output to the source; "modeling": from the source to the output.
inline constexpr const char* nrrd_field_type = "displacement field type";

/// With small letters in place of A to Z.
std::string lower_case(std::string text);

/// The usual name of a field: in small letters, with its blanks where it may be one word.
std::string nrrd_field(const std::string& written);

/// The type of samples; nothing: it is not read.
std::optional<PixelType> nrrd_type(const std::string& name);

/// The name of a type in NRRD headers that are written.
const char* nrrd_type_name(PixelType type);

/// Whether axes of components, the columns of a "measurement frame", are those of the space.
bool is_unit_frame(const std::string& frame);

/// Whether numbers of this kind of axis may be displacements: the file states nothing else.
bool may_be_displacement(const std::string& kind);

/// Which axes of a space point against RAS; nothing: it is not read.
std::optional<std::array<bool, 3>> nrrd_space(const std::string& written);

}  // namespace tetwarp
