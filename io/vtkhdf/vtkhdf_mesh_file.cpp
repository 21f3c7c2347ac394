/// @file vtkhdf_mesh_file.cpp
/// Reads rows of points, cells and displacements.
#include "io/vtkhdf/vtkhdf_mesh_file.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "io/h5/h5_read.hpp"
#include "io/h5/value_names.hpp"

namespace tetwarp {
namespace {
/// VTK's own names of its cell types.
std::string cell_type_name(std::int64_t type) {
  static constexpr std::pair<int, const char*> names[] = {{0, "VTK_EMPTY_CELL"},
                                                          {1, "VTK_VERTEX"},
                                                          {2, "VTK_POLY_VERTEX"},
                                                          {3, "VTK_LINE"},
                                                          {4, "VTK_POLY_LINE"},
                                                          {5, "VTK_TRIANGLE"},
                                                          {6, "VTK_TRIANGLE_STRIP"},
                                                          {7, "VTK_POLYGON"},
                                                          {8, "VTK_PIXEL"},
                                                          {9, "VTK_QUAD"},
                                                          {10, "VTK_TETRA"},
                                                          {11, "VTK_VOXEL"},
                                                          {12, "VTK_HEXAHEDRON"},
                                                          {13, "VTK_WEDGE"},
                                                          {14, "VTK_PYRAMID"},
                                                          {15, "VTK_PENTAGONAL_PRISM"},
                                                          {16, "VTK_HEXAGONAL_PRISM"},
                                                          {21, "VTK_QUADRATIC_EDGE"},
                                                          {22, "VTK_QUADRATIC_TRIANGLE"},
                                                          {23, "VTK_QUADRATIC_QUAD"},
                                                          {24, "VTK_QUADRATIC_TETRA"},
                                                          {25, "VTK_QUADRATIC_HEXAHEDRON"},
                                                          {26, "VTK_QUADRATIC_WEDGE"},
                                                          {27, "VTK_QUADRATIC_PYRAMID"},
                                                          {42, "VTK_POLYHEDRON"},
                                                          {71, "VTK_LAGRANGE_TETRAHEDRON"},
                                                          {78, "VTK_BEZIER_TETRAHEDRON"}};
  for (const auto& [number, name] : names) {
    if (number == type) return std::to_string(type) + " (" + name + ")";
  }
  return std::to_string(type);
}

constexpr std::int64_t skipped_type = 0;  ///< VTK_EMPTY_CELL, which is skipped, too

/// Dimension of a type of cells; 3 of those that are not known.
int dimension_of(std::int64_t type) {
  static constexpr std::int64_t flat[] = {0, 1, 2, 3, 4, 21, 35, 68, 75};  // points and curves
  static constexpr std::int64_t surfaces[] = {5,  6,  7,  8,  9,  22, 23, 28,
                                              30, 34, 36, 69, 70, 76, 77};
  if (std::ranges::find(flat, type) != std::end(flat)) return 1;
  return std::ranges::find(surfaces, type) != std::end(surfaces) ? 2 : 3;
}

/// Number of nodes of a cell that is read.
std::int64_t nodes_of_type(std::int64_t type) {
  switch (type) {
    case vtk_triangle:
      return 3;
    case vtk_tetra:
      return 4;
    case vtk_quadratic_tetra:
      return 10;
    default:
      return 8;
  }
}

/// Throws unless rows [first, first + count) exist.
void check_rows(const h5::Dataset& dataset, std::int64_t first, std::int64_t count) {
  if (first >= 0 && count >= 0 && first <= dataset.rows() && count <= dataset.rows() - first)
    return;
  dataset.fail("rows " + std::to_string(first) + " to " + std::to_string(first) + " + " +
               std::to_string(count) + " are needed, there are " + std::to_string(dataset.rows()) +
               "; correct the counts and the offsets under Steps, or the file is truncated");
}

void check_finite(const h5::Dataset& dataset, const std::vector<Point3>& rows) {
  for (std::size_t node = 0; node < rows.size(); ++node) {
    for (const double coordinate : rows[node]) {
      if (!std::isfinite(coordinate)) {
        dataset.fail("node " + std::to_string(node) + " is not finite, correct or remove it");
      }
    }
  }
}

h5::Dataset open_vectors(const h5::Object& parent, const std::string& name) {
  h5::Dataset dataset = h5::open_dataset(parent, name);
  if (!h5::is_numeric(dataset) || dataset.type_class != H5T_FLOAT) {
    dataset.fail("expected float32 or float64");
  }
  if (dataset.dims.size() != 2 || dataset.dims[1] != 3) {
    dataset.fail("expected shape [n][3]");
  }
  return dataset;
}

h5::Dataset open_column(const h5::Object& parent, const std::string& name) {
  h5::Dataset dataset = h5::open_dataset(parent, name);
  if (!h5::is_numeric(dataset) || dataset.type_class != H5T_INTEGER || dataset.dims.size() != 1) {
    dataset.fail("expected integers of shape [n]");
  }
  return dataset;
}

std::vector<std::int64_t> read_column(const h5::Dataset& dataset,
                                      std::int64_t first,
                                      std::int64_t count) {
  std::vector<std::int64_t> values(static_cast<std::size_t>(count));
  h5::read_block(dataset, H5T_NATIVE_INT64, {{first}}, {{count}}, values.data());
  return values;
}
}  // namespace

MeshFile::MeshFile(const std::string& path) : file_(open_vtkhdf(path, "UnstructuredGrid")) {
  const h5::Object& root = file_.root;
  node_counts_ = h5::read_integers(h5::open_dataset(root, "NumberOfPoints"));
  cell_counts_ = h5::read_integers(h5::open_dataset(root, "NumberOfCells"));
  id_counts_ = h5::read_integers(h5::open_dataset(root, "NumberOfConnectivityIds"));
  points_ = open_vectors(root, "Points");
  types_ = open_column(root, "Types");
  offsets_ = open_column(root, "Offsets");
  connectivity_ = open_column(root, "Connectivity");
  if (file_.is_temporal()) {
    part_counts_ = read_step_offsets(file_, file_.steps, "NumberOfParts");
    part_offsets_ = read_step_offsets(file_, file_.steps, "PartOffsets");
    point_offsets_ = read_step_offsets(file_, file_.steps, "PointOffsets");
    cell_offsets_ = read_step_offsets(file_, file_.steps, "CellOffsets");
    id_offsets_ = read_step_offsets(file_, file_.steps, "ConnectivityIdOffsets");
    displacement_offsets_ = read_point_data_offsets(file_, "displacement");
  }
  if (!h5::is_group(root, "PointData")) return;
  const h5::Object point_data = h5::open_group(root, "PointData");
  if (h5::has_child(point_data, "displacement")) {
    displacement_ = open_vectors(point_data, "displacement");
    check_displacement_offsets();
  }
}

/// Without offsets the rows of an array are those of the points, as VTK reads them.
void MeshFile::check_displacement_offsets() const {
  if (!file_.is_temporal() || !displacement_offsets_.empty()) return;
  if (displacement_.rows() <= points_.rows()) return;
  displacement_.fail("has " + std::to_string(displacement_.rows()) + " rows for " +
                     std::to_string(points_.rows()) +
                     " points, and no dataset Steps/PointDataOffsets/displacement tells which of "
                     "them a step has; add it");
}

std::vector<std::string> MeshFile::not_read() const {
  return paths_in(file_, {"PointData", "CellData", "FieldData"},
                  [](const std::string& path) { return path == "PointData/displacement"; });
}

std::map<std::int64_t, std::string> MeshFile::group_names() const {
  if (!h5::is_group(file_.root, "CellData")) return {};
  const h5::Object cell_data = h5::open_group(file_.root, "CellData");
  if (!h5::has_child(cell_data, "group")) return {};
  return read_value_names(h5::open_dataset(cell_data, "group"));
}

std::int64_t MeshFile::offset_of(const std::vector<std::int64_t>& offsets,
                                 std::int64_t step) const {
  return offsets.empty() ? 0 : offsets[static_cast<std::size_t>(step)];
}

std::vector<MeshPart> MeshFile::parts_of(std::int64_t step) const {
  const auto entries = static_cast<std::int64_t>(node_counts_.size());
  const std::int64_t first_part = offset_of(part_offsets_, step);
  const std::int64_t part_count = part_counts_.empty() ? entries : offset_of(part_counts_, step);
  if (cell_counts_.size() != node_counts_.size() || id_counts_.size() != node_counts_.size()) {
    file_.root.fail("NumberOfPoints, NumberOfCells and NumberOfConnectivityIds differ in length");
  }
  if (first_part > entries || part_count > entries - first_part) {
    file_.root.fail("step " + std::to_string(step) + " refers to parts " +
                    std::to_string(first_part) + " to " + std::to_string(first_part) + " + " +
                    std::to_string(part_count) + ", but NumberOfPoints has " +
                    std::to_string(entries) + " entries");
  }
  MeshPart next;
  next.first_node = offset_of(point_offsets_, step);
  next.first_cell = offset_of(cell_offsets_, step);
  next.first_offset = next.first_cell + first_part;
  next.first_id = offset_of(id_offsets_, step);
  std::vector<MeshPart> parts;
  for (std::int64_t part = first_part; part < first_part + part_count; ++part) {
    next.node_count = node_counts_[static_cast<std::size_t>(part)];
    next.cell_count = cell_counts_[static_cast<std::size_t>(part)];
    next.id_count = id_counts_[static_cast<std::size_t>(part)];
    check_rows(points_, next.first_node, next.node_count);
    check_rows(types_, next.first_cell, next.cell_count);
    check_rows(offsets_, next.first_offset, next.cell_count + 1);
    check_rows(connectivity_, next.first_id, next.id_count);
    parts.push_back(next);
    next.first_node += next.node_count;
    next.first_cell += next.cell_count;
    next.first_offset += next.cell_count + 1;
    next.first_id += next.id_count;
  }
  return parts;
}

std::vector<Point3> MeshFile::read_rows(const h5::Dataset& dataset,
                                        const std::vector<MeshPart>& parts,
                                        std::int64_t shift) const {
  std::int64_t total = 0;
  for (const MeshPart& part : parts) {
    check_rows(dataset, part.first_node + shift, part.node_count);
    total += part.node_count;
  }
  if (total >= std::int64_t{1} << 31) dataset.fail("2^31 or more nodes in one step");
  h5::check_memory(dataset.file, dataset.name, static_cast<double>(total) * sizeof(Point3));
  std::vector<Point3> rows(static_cast<std::size_t>(total));
  std::size_t row = 0;
  for (const MeshPart& part : parts) {
    if (part.node_count == 0) continue;
    h5::read_block(dataset, H5T_NATIVE_DOUBLE, {{part.first_node + shift, 0}},
                   {{part.node_count, 3}}, rows[row].data());
    row += static_cast<std::size_t>(part.node_count);
  }
  return rows;
}

std::vector<Point3> MeshFile::read_points(std::int64_t step) const {
  std::vector<Point3> points = read_rows(points_, parts_of(step), 0);
  check_finite(points_, points);
  return points;
}

std::vector<Point3> MeshFile::read_displacement(std::int64_t step) const {
  const std::int64_t shift =
      displacement_offsets_.empty()
          ? 0
          : offset_of(displacement_offsets_, step) - offset_of(point_offsets_, step);
  return read_rows(displacement_, parts_of(step), shift);
}

void MeshFile::check_displacement(const std::vector<Point3>& displacement) const {
  check_finite(displacement_, displacement);
}

bool MeshFile::has_solids(std::int64_t step) const {
  return std::ranges::any_of(parts_of(step), [&](const MeshPart& part) {
    return std::ranges::any_of(read_column(types_, part.first_cell, part.cell_count),
                               [](std::int64_t type) { return dimension_of(type) == 3; });
  });
}

MeshCells MeshFile::read_cells(std::int64_t step, CellChoice choice) const {
  const std::vector<MeshPart> parts = parts_of(step);
  std::int64_t node_count = 0;
  std::int64_t cell_count = 0;
  std::int64_t id_count = 0;
  for (const MeshPart& part : parts) {
    node_count += part.node_count;
    cell_count += part.cell_count;
    id_count += part.id_count;
  }
  const auto fail_without_cells = [&] {
    const std::string step_text = " at step " + std::to_string(step);
    types_.fail(choice == CellChoice::solids
                    ? "holds no tetrahedron or hexahedron" + step_text
                    : "holds no triangle (5, VTK_TRIANGLE)" + step_text + "; extract the surface");
  };
  if (cell_count == 0) fail_without_cells();
  constexpr std::int64_t limit = std::int64_t{1} << 31;
  if (cell_count >= limit || node_count >= limit) types_.fail("2^31 or more nodes or cells");
  constexpr double bytes_per_cell = 2 * sizeof(std::int64_t);
  constexpr double bytes_per_id = sizeof(std::int64_t) + sizeof(std::int32_t);
  h5::check_memory(file_.file.file, connectivity_.name,
                   bytes_per_cell * static_cast<double>(cell_count) +
                       bytes_per_id * static_cast<double>(id_count));
  MeshCells cells;
  std::int64_t first_node = 0, first_cell = 0;
  for (const MeshPart& part : parts) {
    read_part_cells(part, first_node, first_cell, choice, cells);
    first_node += part.node_count;
    first_cell += part.cell_count;
  }
  if (cells.count() == 0) fail_without_cells();
  return cells;
}

std::vector<std::int64_t> MeshFile::read_cell_types(const MeshPart& part,
                                                    std::int64_t first_cell,
                                                    CellChoice choice,
                                                    MeshCells& cells) const {
  const bool is_solid = choice == CellChoice::solids;
  std::vector<std::int64_t> types = read_column(types_, part.first_cell, part.cell_count);
  for (std::size_t cell = 0; cell < types.size(); ++cell) {
    const std::int64_t type = types[cell];
    const bool is_kept =
        is_solid ? type == vtk_tetra || type == vtk_hexahedron || type == vtk_quadratic_tetra
                 : type == vtk_triangle;
    if (is_kept) continue;
    const int dimension = dimension_of(type);
    if (is_solid ? dimension == 3 : dimension == 2) {
      types_.fail("cell " + std::to_string(first_cell + static_cast<std::int64_t>(cell)) +
                  " has type " + cell_type_name(type) +
                  (is_solid ? ", expected tetrahedra (10, VTK_TETRA, or 24, VTK_QUADRATIC_TETRA) "
                              "and hexahedra (12, VTK_HEXAHEDRON) only; split the cells into "
                              "tetrahedra"
                            : ", expected triangles (5, VTK_TRIANGLE) only; extract the surface"));
    }
    ++cells.skipped[cell_type_name(type)];
    types[cell] = skipped_type;
  }
  return types;
}

void MeshFile::read_part_cells(const MeshPart& part,
                               std::int64_t first_node,
                               std::int64_t first_cell,
                               CellChoice choice,
                               MeshCells& cells) const {
  const std::vector<std::int64_t> types = read_cell_types(part, first_cell, choice, cells);
  const std::string sizes_text = choice == CellChoice::solids
                                     ? "4 or 10 for each tetrahedron, 8 for each hexahedron"
                                     : "3 for each triangle";
  const std::vector<std::int64_t> offsets =
      read_column(offsets_, part.first_offset, part.cell_count + 1);
  std::int64_t expected = 0;
  for (std::size_t cell = 0; cell < offsets.size(); ++cell) {
    if (offsets[cell] != expected) {
      offsets_.fail("entry " + std::to_string(cell) + " of a part is " +
                    std::to_string(offsets[cell]) + ", expected " + std::to_string(expected) +
                    " (from 0 in steps of " + sizes_text + ")");
    }
    if (cell == types.size()) break;
    const std::int64_t type = types[cell];
    expected = type == skipped_type ? std::max(expected, offsets[cell + 1])
                                    : expected + nodes_of_type(type);
  }
  if (part.id_count != expected) {
    connectivity_.fail("NumberOfConnectivityIds is " + std::to_string(part.id_count) + " for " +
                       std::to_string(part.cell_count) + " cells, expected " +
                       std::to_string(expected) + ", " + sizes_text);
  }
  const std::vector<std::int64_t> ids = read_column(connectivity_, part.first_id, part.id_count);
  for (std::size_t cell = 0; cell < types.size(); ++cell) {
    const auto first = static_cast<std::size_t>(offsets[cell]);
    const auto take = [&](auto& list, std::size_t skipped = 0) {
      auto& nodes = list.emplace_back();
      for (std::size_t corner = 0; corner < nodes.size(); ++corner) {
        const std::int64_t node = ids[first + skipped + corner];
        if (node < 0 || node >= part.node_count) {
          connectivity_.fail("cell " +
                             std::to_string(first_cell + static_cast<std::int64_t>(cell)) +
                             " refers to node " + std::to_string(node) + ", expected 0 to " +
                             std::to_string(part.node_count - 1));
        }
        nodes[corner] = static_cast<std::int32_t>(first_node + node);
      }
    };
    if (types[cell] == vtk_triangle) take(cells.triangles);
    const bool has_ten = types[cell] == vtk_quadratic_tetra;
    if (has_ten) cells.mid_nodes.resize(cells.tets.size(), no_mid_nodes);
    if (has_ten || types[cell] == vtk_tetra) take(cells.tets);
    if (has_ten) {
      take(cells.mid_nodes, 4);
    } else if (types[cell] == vtk_tetra && !cells.mid_nodes.empty()) {
      cells.mid_nodes.push_back(no_mid_nodes);
    }
    if (types[cell] == vtk_hexahedron) take(cells.hexes);
  }
}

}  // namespace tetwarp
