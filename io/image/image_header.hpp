/// @file image_header.hpp
/// What the headers of NRRD files, MetaImages and FreeSurfer's images tell alike.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/volume.hpp>

namespace tetwarp {

/// An image whose samples are stored [step][k][j][i][component].
struct ImageHeader {
  Grid grid;  ///< in RAS
  PixelType type = PixelType::uint8;
  int components = 1;
  std::int64_t steps = 1;
  bool is_series = false;  ///< also with one step
  double first_time = 0;   ///< of the steps, in seconds where their unit is known
  double time_step = 1;
  std::vector<double> times = {};  ///< of a file to write; empty: no series
  std::string data_file;           ///< that holds the samples; may be the header's own
  std::int64_t data_offset = 0;    ///< of the samples; -1: they are the last bytes of the file
  bool is_packed = false;          ///< by zlib or gzip
  std::int64_t skipped = 0;        ///< bytes before the samples in what is packed
  bool is_big_endian = false;
  /// Of NRRD, in lower case: "resampling" or "modeling", the direction of displacements, or another
  /// word of the file; none: it does not tell.
  std::optional<std::string> field_type = {};
  std::string component_kind = {};         ///< of NRRD's axis of components, in lower case
  std::vector<std::string> left_out = {};  ///< other fields of the header

  std::size_t voxel_bytes() const { return static_cast<std::size_t>(components) * size_of(type); }
};

/// Sets spacing and direction from the steps along the grid's axes, and turns them and the origin
/// to RAS.
/// @param is_negated  by axis of the world: whether the file's axis points the other way
/// @throws std::invalid_argument  as check_grid()
void set_image_axes(const std::array<Point3, 3>& steps,
                    const Point3& origin,
                    const std::array<bool, 3>& is_negated,
                    Grid& grid);

/// Makes a header that of a series, whose times begin at `first` and are `interval` apart.
/// @param first, interval  0 and 1 are taken where they are not finite or, the interval, not above
/// 0
/// @throws std::invalid_argument  when the count is not from 1 to 2^31
void set_image_steps(double count, double first, double interval, ImageHeader& header);

/// The shortest text of a number that is read as the same one.
std::string shortest_text(double value);

/// A file in the folder of another one, unless its path is absolute.
std::string beside(const std::string& file, const std::string& name);

}  // namespace tetwarp
