/// @file names.cpp
/// The words of the enums of io.hpp and transform_file.hpp.
#include <tetwarp/io.hpp>
#include <tetwarp/transform_file.hpp>

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
    {FileKind::image, "DICOM, NRRD, VTK or FreeSurfer image or MetaImage"},
    {FileKind::unknown, "file of unknown kind"}};
constexpr EnumName<FslWarp> fsl_warp_names[] = {{FslWarp::relative, "relative"},
                                                {FslWarp::absolute, "absolute"}};
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
template <>
TETWARP_IO_EXPORT std::span<const EnumName<FslWarp>> names_of() {
  return fsl_warp_names;
}

}  // namespace tetwarp
