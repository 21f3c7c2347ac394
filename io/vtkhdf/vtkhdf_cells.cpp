/// @file vtkhdf_cells.cpp
/// Points, connectivity, offsets and types.
#include "io/vtkhdf/vtkhdf_cells.hpp"

#include "io/h5/h5_write.hpp"

namespace tetwarp {

void write_integers(const h5::Object& parent,
                    const std::string& name,
                    const std::vector<std::int64_t>& values,
                    bool is_column) {
  const hsize_t dims[2] = {values.size(), 1};
  h5::write_dataset(parent, name, H5T_STD_I64LE, H5T_NATIVE_INT64,
                    {dims, is_column ? std::size_t{2} : std::size_t{1}}, values.data());
}

void write_grid(const h5::Object& root, std::span<const Point3> points, const CellRows& cells) {
  const hsize_t dims[2] = {points.size(), 3};
  h5::write_dataset(root, "Points", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, dims, points.data());
  write_integers(root, "NumberOfPoints", {static_cast<std::int64_t>(points.size())});
  write_integers(root, "NumberOfCells", {static_cast<std::int64_t>(cells.types.size())});
  write_integers(root, "NumberOfConnectivityIds", {cells.offsets.back()});
  write_integers(root, "Offsets", cells.offsets);
  const hsize_t id_count = cells.nodes.size(), type_count = cells.types.size();
  h5::write_dataset(root, "Connectivity", H5T_STD_I64LE, H5T_NATIVE_INT32, {&id_count, 1},
                    cells.nodes.data());
  h5::write_dataset(root, "Types", H5T_STD_U8LE, H5T_NATIVE_UINT8, {&type_count, 1},
                    cells.types.data());
}

}  // namespace tetwarp
