/// @file point_file.hpp
/// Files of points: landmarks, contours and surfaces, which keep everything but their positions.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <tetwarp/axes.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/io_export.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// Points of a file. Its format is chosen by the end of its name:
///
/// - .csv, .tsv, .txt: columns x, y, z, or r, a, s or l, p, s, which name the axes; without a line
///   of names the first three columns. Separated by comma, semicolon or tab
/// - .fcsv, .mrk.json, .json: landmarks and curves of 3D Slicer
/// - .vtkhdf, .hdf, .h5: a VTKHDF UnstructuredGrid or PolyData without steps
/// - .stl, .ply, .obj, .vtp, .vtu, .vtk: any cells that VTK reads, in the program tetwarp-read; see
///   import_mesh()
class TETWARP_IO_EXPORT PointFile {
 public:
  /// @param axes  of the positions, where the file names none; VTKHDF files stay as they are
  /// @throws IoError  when the file is missing, damaged or of another format, or names neither RAS
  ///                  nor LPS; of texts it names the line
  explicit PointFile(const std::string& path, Axes axes = Axes::ras);
  PointFile(PointFile&&) noexcept;
  ~PointFile();

  /// Those of files in LPS are turned to RAS.
  const std::vector<Point3>& points() const;

  /// Whether `axes` matter: the file is no VTKHDF file and names none.
  bool takes_axes() const;

  /// Throws IoError unless the name is that of a format that the file can be written in.
  void check_output(const std::string& path) const;

  /// Writes a copy of the file with points at other places, in the file's own axes, and a column,
  /// array or key `inside`, 1 or 0. Points with 0 keep the place that the file gives them, digit by
  /// digit in texts. The file gets its name when it is complete.
  /// @param points  as many as the file has
  /// @param inside  one per point
  /// @returns what the format cannot hold, in words; empty: nothing
  /// @throws IoError  when it cannot be written
  std::string write(const std::string& path,
                    const std::vector<Point3>& points,
                    const std::vector<std::uint8_t>& inside) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tetwarp
