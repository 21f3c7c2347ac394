/// @file names.cpp
/// The words of the enums of io.hpp.
#include <tetwarp/io.hpp>

namespace tetwarp {
namespace {
constexpr EnumName<Axes> axes_names[] = {{Axes::ras, "ras"}, {Axes::lps, "lps"}};
constexpr EnumName<ContactStart> contact_start_names[] = {{ContactStart::zero, "zero"},
                                                          {ContactStart::stored, "stored"}};
constexpr EnumName<FileKind> file_kind_names[] = {
    {FileKind::volume, "volume"},
    {FileKind::mesh, "mesh"},
    {FileKind::other_vtkhdf, "VTKHDF file of another type"},
    {FileKind::contact_problem, "contact problem"},
    {FileKind::hdf5, "general HDF5 file"},
    {FileKind::nifti, "NIfTI image"},
    {FileKind::analyze, "Analyze 7.5 image"},
    {FileKind::image, "NRRD image or MetaImage"},
    {FileKind::unknown, "file of unknown kind"}};
}  // namespace

template <>
TETWARP_IO_EXPORT std::span<const EnumName<Axes>> names_of() {
  return axes_names;
}
template <>
TETWARP_IO_EXPORT std::span<const EnumName<ContactStart>> names_of() {
  return contact_start_names;
}
template <>
TETWARP_IO_EXPORT std::span<const EnumName<FileKind>> names_of() {
  return file_kind_names;
}

}  // namespace tetwarp
