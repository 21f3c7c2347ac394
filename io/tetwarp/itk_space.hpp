/// @file itk_space.hpp
/// Where ITK places the positions of an image, from the unit and the forms of a NIfTI header.
#pragma once
#include <optional>
#include <string>

#include <tetwarp/io.hpp>
#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// From positions along a header's axes, in its unit, to ITK's positions in RAS and millimeters: a
/// factor per axis. ITK turns the positions of a header with a form from RAS to LPS, and takes
/// those of a header without one as LPS.
TETWARP_IO_EXPORT Point3 itk_factor(const NiftiFacts& facts);

/// The same of a volume file; nothing where positions have no unit: VTKHDF without facts, .vti.
TETWARP_IO_EXPORT std::optional<Point3> itk_factor(const std::string& path,
                                                   const VolumeHeader& header);

/// The facts of the first array that has some.
TETWARP_IO_EXPORT std::optional<NiftiFacts> first_facts(const VolumeHeader& header);

/// From positions with one such factor to the same places with another one.
TETWARP_IO_EXPORT Point3 ratio(const Point3& from, const Point3& to);

/// Whether components of vectors and tensors in a file may be along LPS axes, which
/// VolumeReadOptions::axes states: NIfTI, NRRD and MetaImage.
TETWARP_IO_EXPORT bool has_component_axes(const std::string& path);

/// A grid whose positions are multiplied by a factor of the same size along all axes.
TETWARP_IO_EXPORT Grid scaled(Grid grid, const Point3& factor);

}  // namespace tetwarp
