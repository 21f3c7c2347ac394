/// @file vtkhdf_write_mesh.cpp
/// Writing VTKHDF UnstructuredGrid: static topology and rest points, displacements over steps.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>
#include <tetwarp/io.hpp>
#include <tetwarp/scene_io.hpp>
#include <utility>

#include "io/files/sink_checks.hpp"
#include "io/h5/h5_write.hpp"
#include "io/h5/value_names.hpp"
#include "io/vtkhdf/vtkhdf_cells.hpp"
#include "io/vtkhdf/vtkhdf_mesh_file.hpp"
#include "io/vtkhdf/vtkhdf_output.hpp"

namespace tetwarp {
namespace {
void check_arguments(const std::string& path,
                     const Mesh& mesh,
                     const std::vector<MidNodes>& mid_nodes,
                     const std::vector<std::vector<Point3>>& displacements,
                     const std::vector<double>& times) {
  try {
    check_mesh(mesh);
    check_mid_nodes(mesh, mid_nodes);
  } catch (const std::invalid_argument& error) {
    throw IoError(path, "/VTKHDF", error.what());
  }
  if (!times.empty() && times.size() != displacements.size()) {
    throw IoError(path, "/VTKHDF/Steps/Values",
                  std::to_string(times.size()) + " times for " +
                      std::to_string(displacements.size()) + " displacements, expected as many");
  }
  for (const double time : times) check_time(path, time);
  for (std::size_t step = 0; step < displacements.size(); ++step) {
    const std::string problem = "step " + std::to_string(step);
    if (displacements[step].size() != mesh.rest_positions.size()) {
      throw IoError(path, "/VTKHDF/PointData/displacement",
                    problem + " has " + std::to_string(displacements[step].size()) +
                        " nodes, the mesh has " + std::to_string(mesh.rest_positions.size()));
    }
    for (std::size_t node = 0; node < displacements[step].size(); ++node) {
      for (const double coordinate : displacements[step][node]) {
        if (std::isfinite(coordinate)) continue;
        throw IoError(path, "/VTKHDF/PointData/displacement",
                      problem + ": node " + std::to_string(node) + " is not finite");
      }
    }
  }
}

void check_arrays(const std::string& path,
                  std::size_t points,
                  std::size_t cells,
                  const std::vector<MeshArray>& arrays) {
  std::set<std::pair<bool, std::string>> names{{false, "displacement"}};
  for (const MeshArray& array : arrays) {
    const std::size_t rows = array.is_of_cells ? cells : points;
    const std::string name =
        (array.is_of_cells ? "/VTKHDF/CellData/" : "/VTKHDF/PointData/") + array.name;
    if (array.name.empty() || array.name.find_first_of("/.") != std::string::npos ||
        !names.emplace(array.is_of_cells, array.name).second) {
      throw IoError(path, name, "array names must be unique, not empty, without '/' and '.'");
    }
    if (array.components < 1 || array.components > 9 ||
        array.data.size() !=
            rows * static_cast<std::size_t>(array.components) * size_of(array.type)) {
      throw IoError(path, name,
                    "has " + std::to_string(array.data.size()) + " bytes, expected " +
                        std::to_string(rows) + " rows of 1 to 9 components");
    }
  }
}

CellRows cells_of(const Mesh& mesh, const std::vector<MidNodes>& mid_nodes) {
  CellRows cells;
  for (std::size_t tet = 0; tet < mesh.tets.size(); ++tet) {
    const auto& corners = mesh.tets[tet];
    if (mid_nodes.empty() || mid_nodes[tet] == no_mid_nodes) {
      cells.add<4>(vtk_tetra, {&corners, 1});
      continue;
    }
    std::array<std::int32_t, 10> ten;
    std::ranges::copy(mid_nodes[tet], std::ranges::copy(corners, ten.begin()).out);
    cells.add<10>(vtk_quadratic_tetra, {&ten, 1});
  }
  cells.add<8>(vtk_hexahedron, mesh.hexes);
  return cells;
}

/// One dataset [step * node][3], filled step by step.
void write_displacements(const VtkhdfOutput& output,
                         const h5::Object& point_data,
                         const std::vector<std::vector<Point3>>& displacements) {
  const hsize_t node_count = displacements.front().size();
  const hsize_t dims[2] = {displacements.size() * node_count, 3};
  const hsize_t count[2] = {node_count, 3};
  const h5::Handle space(H5Screate_simple(2, dims, nullptr), H5Sclose);
  const h5::Handle memory(H5Screate_simple(2, count, nullptr), H5Sclose);
  const h5::Object dataset =
      h5::create_dataset(point_data, "displacement", H5T_IEEE_F64LE, space.id(), H5P_DEFAULT);
  for (std::size_t step = 0; step < displacements.size(); ++step) {
    const hsize_t start[2] = {step * node_count, 0};
    if (H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start, nullptr, count, nullptr) < 0 ||
        H5Dwrite(dataset.id(), H5T_NATIVE_DOUBLE, memory.id(), space.id(), H5P_DEFAULT,
                 displacements[step].front().data()) < 0) {
      dataset.fail_with_reason("cannot be written");
    }
    output.check_disk(dataset);
  }
}

void write_array(const VtkhdfOutput& output, const h5::Object& group, const MeshArray& array) {
  const auto components = static_cast<hsize_t>(array.components);
  const hsize_t dims[2] = {array.data.size() / (components * size_of(array.type)), components};
  const h5::Object dataset = h5::write_dataset(
      group, array.name, h5::file_type_of(array.type), h5::memory_type_of(array.type),
      {dims, components > 1 ? std::size_t{2} : std::size_t{1}}, array.data.data());
  write_value_names(dataset, array.value_names);
  output.check_disk(group);
}

void write_steps(const h5::Object& root,
                 std::vector<double> times,
                 std::int64_t node_count,
                 const std::vector<MeshArray>& arrays) {
  const h5::Object steps = h5::create_group(root, "Steps");
  const hsize_t count = times.size();
  h5::write_dataset(steps, "Values", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {&count, 1}, times.data());
  // Points and topology are the same rows at every step; the displacement has one set of rows per
  // step.
  const std::vector<std::int64_t> zeros(times.size(), 0);
  std::vector<std::int64_t> rows(times.size());
  for (std::size_t step = 0; step < rows.size(); ++step) {
    rows[step] = static_cast<std::int64_t>(step) * node_count;
  }
  write_integers(steps, "PartOffsets", zeros);
  write_integers(steps, "NumberOfParts", std::vector<std::int64_t>(times.size(), 1));
  write_integers(steps, "PointOffsets", zeros);
  write_integers(steps, "CellOffsets", zeros, true);
  write_integers(steps, "ConnectivityIdOffsets", zeros, true);
  const h5::Object point_data = h5::create_group(steps, "PointDataOffsets");
  const h5::Object cell_data = h5::create_group(steps, "CellDataOffsets");
  write_integers(point_data, "displacement", rows);
  for (const MeshArray& array : arrays) {
    write_integers(array.is_of_cells ? cell_data : point_data, array.name, zeros);
  }
  h5::write_scalar_attribute(steps, "NSteps", static_cast<std::int64_t>(count));
}

void write_cells_and_steps(const std::string& path,
                           const Mesh& mesh,
                           const std::vector<MidNodes>& mid_nodes,
                           const std::vector<std::vector<Point3>>& displacements,
                           const std::vector<double>& times,
                           const std::vector<MeshArray>& arrays) {
  const h5::Silence silence;
  check_arguments(path, mesh, mid_nodes, displacements, times);
  check_arrays(path, mesh.rest_positions.size(), mesh.cell_count(), arrays);
  const bool is_temporal = !displacements.empty();
  VtkhdfOutput output(path, "UnstructuredGrid", is_temporal);
  {
    const h5::Object& root = output.root();
    write_grid(root, mesh.rest_positions, cells_of(mesh, mid_nodes));
    const h5::Object cell_data = h5::create_group(root, "CellData");
    h5::create_group(root, "FieldData");
    const h5::Object point_data = h5::create_group(root, "PointData");
    for (const MeshArray& array : arrays) {
      write_array(output, array.is_of_cells ? cell_data : point_data, array);
    }
    if (is_temporal) {
      write_displacements(output, point_data, displacements);
      std::vector<double> values = times;
      if (values.empty()) {
        values.resize(displacements.size());
        std::iota(values.begin(), values.end(), 0.0);
      }
      write_steps(root, values, static_cast<std::int64_t>(mesh.rest_positions.size()), arrays);
    }
  }
  output.finish();
}

}  // namespace

void write_mesh(const std::string& path,
                const Mesh& mesh,
                const std::vector<std::vector<Point3>>& displacements,
                const std::vector<double>& times,
                const std::vector<MeshArray>& arrays) {
  write_cells_and_steps(path, mesh, {}, displacements, times, arrays);
}

void write_mesh(const std::string& path,
                const CurvedMesh& mesh,
                const std::vector<std::vector<Point3>>& displacements,
                const std::vector<double>& times,
                const std::vector<MeshArray>& arrays) {
  write_cells_and_steps(path, mesh.mesh, mesh.mid_nodes, displacements, times, arrays);
}

void write_surface(const std::string& path,
                   const Surface& surface,
                   const std::vector<MeshArray>& arrays) {
  const h5::Silence silence;
  if (surface.triangles.empty()) throw IoError(path, "/VTKHDF", "no triangle to write");
  check_arrays(path, surface.points.size(), surface.triangles.size(), arrays);
  VtkhdfOutput output(path, "UnstructuredGrid", false);
  {
    CellRows cells;
    cells.add<3>(vtk_triangle, surface.triangles);
    write_grid(output.root(), surface.points, cells);
    const h5::Object cell_data = h5::create_group(output.root(), "CellData");
    h5::create_group(output.root(), "FieldData");
    const h5::Object point_data = h5::create_group(output.root(), "PointData");
    for (const MeshArray& array : arrays) {
      write_array(output, array.is_of_cells ? cell_data : point_data, array);
    }
  }
  output.finish();
}

}  // namespace tetwarp
