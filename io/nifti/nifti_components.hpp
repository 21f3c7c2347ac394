/// @file nifti_components.hpp
/// Order and signs of the components of vectors and tensors in NIfTI files and in other axes.
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <string>

#include <tetwarp/axes.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// From the components of a file to those of a Volume.
struct ComponentMap {
  std::array<std::size_t, 9> place;  ///< in the volume, of each component of the file
  std::array<bool, 9> is_negated;    ///< by component of the file
  int count = 0;                     ///< components of the file
  double scale = 1;                  ///< of all components that are written
};

/// The components of an array whose x and y change their sign between RAS and LPS: of vectors
/// (three), symmetric tensors (six, in VTK's order) and tensors (nine, row by row).
/// @returns by component of a volume; all false for other numbers of components
std::array<bool, 9> turned_components(int components);

/// The map of a NIfTI file; `path` is for messages.
/// @throws IoError as read_nifti()
ComponentMap component_map(
    const std::string& path, PixelType type, int components, int intent_code, Axes axes);

/// The map of an NRRD file or a MetaImage, whose components keep their order; `path` is for
/// messages. Symmetric tensors are refused along LPS: these files do not say in which order of
/// ITK's, Teem's or VTK's the six components are.
/// @throws IoError  as component_map()
ComponentMap image_component_map(const std::string& path,
                                 PixelType type,
                                 int components,
                                 Axes axes);

/// The map of a displacement field that ITK reads; see ArrayHeader::is_itk_field. `path` is for
/// messages.
/// @param has_form   the header has a sform or a qform
/// @param unit       millimeters of one unit of the header
/// @throws IoError unless the field has three components of float32 or float64
ComponentMap itk_field_map(const std::string& path,
                           PixelType type,
                           int components,
                           const Grid& grid,
                           bool has_form,
                           double unit);

/// Negates samples of float32 or float64 in place; zero stays positive.
void negate_samples(PixelType type, std::span<std::byte> samples);

/// Multiplies samples of float32 or float64 in place; zero stays positive.
void scale_samples(PixelType type, double factor, std::span<std::byte> samples);

}  // namespace tetwarp
