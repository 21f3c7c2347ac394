/// @file extension.hpp
/// Ends of the names of files.
#pragma once
#include <array>
#include <span>
#include <string>
#include <string_view>

#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// True when a name ends with `end`, in small or in capital letters. @param end  in small letters
TETWARP_IO_EXPORT bool has_extension(const std::string& path, std::string_view end);

/// Ends of the names that meshes and surfaces are written to: VTKHDF.
inline constexpr std::array<std::string_view, 3> vtkhdf_endings{".vtkhdf", ".hdf", ".h5"};

/// Ends of the names that volumes are written to.
inline constexpr std::array<std::string_view, 11> volume_endings{
    ".vtkhdf", ".hdf", ".h5", ".nii", ".nii.gz", ".nrrd", ".mha", ".mhd", ".mgh", ".mgz", ".vti"};

/// True when a name ends with one of `ends`.
TETWARP_IO_EXPORT bool has_one_of(const std::string& path, std::span<const std::string_view> ends);

/// For messages: ".a, .b or .c".
TETWARP_IO_EXPORT std::string listed_endings(std::span<const std::string_view> ends);

}  // namespace tetwarp
