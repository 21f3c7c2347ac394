/// @file fuzz_foreign_files.hpp
/// Surfaces and images in the formats of other programs: a tetrahedron's faces, a few voxels.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/io/fuzz_mesh_files.hpp"

namespace tetwarp::test {

inline std::vector<ForeignMesh> foreign_surfaces() {
  const std::string stl =
      "solid s\nfacet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\n"
      "endloop\nendfacet\nfacet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
      "vertex 0 0 1\nendloop\nendfacet\nendsolid s\n";
  std::string packed_stl(80, ' ');
  packed_stl += packed<std::uint32_t>({2});
  for (const float z : {0.0F, 1.0F}) {
    packed_stl += packed<float>({0, 0, 1, 0, 0, z, 1, 0, z, 0, 1, z}) + std::string(2, '\0');
  }
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n";
  const std::string vtp =
      "<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<PolyData>\n"
      "<Piece NumberOfPoints=\"4\" NumberOfPolys=\"2\">\n<PointData>\n"
      "<DataArray type=\"Float32\" Name=\"heat\" format=\"ascii\">1 2 3 4</DataArray>\n"
      "</PointData>\n<Points>\n<DataArray type=\"Float64\" NumberOfComponents=\"3\" "
      "format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray>\n</Points>\n<Polys>\n"
      "<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 2 1 0 1 3</DataArray>\n"
      "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">3 6</DataArray>\n</Polys>\n"
      "</Piece>\n</PolyData>\n</VTKFile>\n";
  return {{"stl", "n.stl", stl},
          {"stl-binary", "o.stl", packed_stl},
          {"ply", "p.ply", ply},
          {"obj", "q.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\n"},
          {"vtp", "r.vtp", vtp}};
}

/// An element of explicit little endian, group and number in one: 0x00280010.
inline std::string dicom_element(std::uint32_t tag, const std::string& vr, std::string value) {
  if (value.size() % 2 > 0) value += vr == "UI" || vr == "OB" ? '\0' : ' ';
  const auto size = static_cast<std::uint32_t>(value.size());
  const std::string length = vr == "OW" || vr == "OB" || vr == "SQ"
                                 ? std::string(2, '\0') + packed<std::uint32_t>({size})
                                 : packed<std::uint16_t>({static_cast<std::uint16_t>(size)});
  return packed<std::uint16_t>(
             {static_cast<std::uint16_t>(tag >> 16), static_cast<std::uint16_t>(tag & 0xFFFF)}) +
         vr + length + value;
}

/// Elements by their tags, which are written in their order.
using DicomFacts = std::map<std::uint32_t, std::pair<std::string, std::string>>;

/// An image of 4 x 3 samples of 16 bits, or several of them, at a position.
inline std::string dicom_image(const std::string& kind,
                               const std::string& position,
                               const DicomFacts& more,
                               int frames = 1) {
  const auto number = [](std::uint16_t value) {
    return std::pair<std::string, std::string>("US", packed<std::uint16_t>({value}));
  };
  DicomFacts facts{{0x00080016, {"UI", kind}},
                   {0x00080018, {"UI", "1.2.3.1"}},
                   {0x00080060, {"CS", "CT"}},
                   {0x0020000E, {"UI", "1.2.3"}},
                   {0x00200032, {"DS", position}},
                   {0x00200037, {"DS", "1\\0\\0\\0\\1\\0"}},
                   {0x00280002, number(1)},
                   {0x00280004, {"CS", "MONOCHROME2"}},
                   {0x00280010, number(3)},
                   {0x00280011, number(4)},
                   {0x00280030, {"DS", "2\\1.5"}},
                   {0x00280100, number(16)},
                   {0x00280101, number(16)},
                   {0x00280102, number(15)},
                   {0x00280103, number(0)},
                   {0x7FE00010, {"OW", std::string(static_cast<std::size_t>(24 * frames), '\1')}}};
  for (const auto& [tag, fact] : more) facts[tag] = fact;
  std::string body;
  for (const auto& [tag, fact] : facts) body += dicom_element(tag, fact.first, fact.second);
  const std::string meta = dicom_element(0x00020002, "UI", kind) +
                           dicom_element(0x00020003, "UI", "1.2.3.1") +
                           dicom_element(0x00020010, "UI", "1.2.840.10008.1.2.1");
  const auto length = static_cast<std::uint32_t>(meta.size());
  return std::string(128, '\0') + "DICM" +
         dicom_element(0x00020000, "UL", packed<std::uint32_t>({length})) + meta + body;
}

inline std::string ct_slice(const std::string& position) {
  return dicom_image("1.2.840.10008.5.1.4.1.1.2", position,
                     {{0x00281052, {"DS", "-1000"}}, {0x00281053, {"DS", "1"}}});
}

/// Series are read with this slice beside the damaged one; it stays as it is.
inline const ForeignMesh good_slice = {"", "series/0.dcm", ct_slice("0\\0\\0")};

inline std::vector<ForeignMesh> foreign_images() {
  const std::string dose = dicom_image(
      "1.2.840.10008.5.1.4.1.1.481.2", "0\\0\\0",
      {{0x00280008, {"IS", "3"}}, {0x3004000C, {"DS", "0\\2\\4"}}, {0x3004000E, {"DS", "0.01"}}},
      3);
  const std::string vti =
      "<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "<ImageData WholeExtent=\"0 2 0 1 0 1\" Origin=\"0 0 0\" Spacing=\"1 2 3\">\n"
      "<Piece Extent=\"0 2 0 1 0 1\">\n<PointData Scalars=\"a\">\n"
      "<DataArray type=\"Int16\" Name=\"a\" format=\"ascii\">0 1 2 3 4 5 6 7 8 9 10 11"
      "</DataArray>\n</PointData>\n</Piece>\n</ImageData>\n</VTKFile>\n";
  return {{"dicom", "s.dcm", ct_slice("0\\0\\0")},
          {"dicom-dose", "t.dcm", dose},
          {"dicom-series", "series/1.dcm", ct_slice("0\\0\\3")},
          {"vti", "u.vti", vti}};
}

}  // namespace tetwarp::test
