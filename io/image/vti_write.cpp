/// @file vti_write.cpp
/// The header with the places of the arrays, and the samples behind it.
#include "io/image/vti_write.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <bit>
#include <cstdint>
#include <span>
#include <stdexcept>

#include "io/files/extension.hpp"
#include "io/files/finished_file.hpp"
#include "io/files/scratch_file.hpp"
#include "io/files/sink_checks.hpp"
#include "io/files/xml_text.hpp"
#include "io/image/image_header.hpp"
#include "io/nifti/nifti_runs.hpp"

namespace tetwarp {
namespace {
const char* vtk_type_of(PixelType type) {
  switch (type) {
    case PixelType::int8:
      return "Int8";
    case PixelType::uint8:
      return "UInt8";
    case PixelType::int16:
      return "Int16";
    case PixelType::uint16:
      return "UInt16";
    case PixelType::int32:
      return "Int32";
    case PixelType::uint32:
      return "UInt32";
    case PixelType::int64:
      return "Int64";
    case PixelType::uint64:
      return "UInt64";
    case PixelType::float32:
      return "Float32";
    case PixelType::float64:
      return "Float64";
  }
  return "";
}

std::string listed_numbers(std::span<const double> numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : " ") + shortest_text(number);
  return text;
}

class VtiSink : public VolumeSink {
 public:
  VtiSink(const std::string& path,
          const Grid& grid,
          const std::vector<ArrayHeader>& arrays,
          const VolumeWriteOptions& options)
      : path_(path), grid_(grid), arrays_(arrays), file_(path) {
    descriptor_ = open(file_.temporary().c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) throw_disk_error(path_);
    std::int64_t offset = 0;
    for (const ArrayHeader& array : arrays_) {
      offsets_.push_back(offset);
      offset += static_cast<std::int64_t>(sizeof(std::uint64_t)) + bytes_of(array);
    }
    const std::string text = header_text(options.scalars);
    start_ = std::ssize(text);
    put(text.data(), text.size(), 0);
    for (std::size_t a = 0; a < arrays_.size(); ++a) {
      const auto bytes = static_cast<std::uint64_t>(bytes_of(arrays_[a]));
      put(&bytes, sizeof bytes, start_ + offsets_[a]);
    }
    // Samples that nobody writes are zero.
    const std::string end = "\n  </AppendedData>\n</VTKFile>\n";
    put(end.data(), end.size(), start_ + offset);
  }
  ~VtiSink() override { close_file(); }

  void begin_step(double) override {}
  void repeat_step(double) override {}

  void write(std::size_t array, const Region& region, const void* samples) override {
    const auto* const in = static_cast<const std::byte*>(samples);
    const std::int64_t size = voxel_bytes(arrays_[array]);
    const std::int64_t start =
        start_ + offsets_[array] + static_cast<std::int64_t>(sizeof(std::uint64_t));
    for_each_run(grid_.dims, region, std::int64_t{1} << 20,
                 [&](std::int64_t in_grid, std::int64_t in_region, std::int64_t count) {
                   put(in + in_region * size, static_cast<std::size_t>(count * size),
                       start + in_grid * size);
                   return true;
                 });
  }

  WrittenFile finish() override {
    if (!close_file()) throw_disk_error(path_);
    WrittenFile written;
    written.bytes = file_.finish();
    return written;
  }

 private:
  static std::int64_t voxel_bytes(const ArrayHeader& array) {
    return array.components * static_cast<std::int64_t>(size_of(array.type));
  }
  std::int64_t bytes_of(const ArrayHeader& array) const {
    return grid_.voxel_count() * voxel_bytes(array);
  }

  std::string header_text(const std::string& scalars) const {
    std::string extent;
    for (const std::int64_t dim : grid_.dims) {
      extent += (extent.empty() ? "0 " : " 0 ") + std::to_string(dim - 1);
    }
    const bool is_little = std::endian::native == std::endian::little;
    std::string active = arrays_.front().name;
    for (const ArrayHeader& array : arrays_) {
      if (array.name == scalars) active = scalars;
    }
    std::string text =
        std::string("<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" ") +
        "byte_order=\"" + (is_little ? "LittleEndian" : "BigEndian") +
        "\" header_type=\"UInt64\">\n  <ImageData WholeExtent=\"" + extent + "\" Origin=\"" +
        listed_numbers(grid_.origin) + "\" Spacing=\"" + listed_numbers(grid_.spacing) +
        "\" Direction=\"" + listed_numbers(grid_.direction) + "\">\n    <Piece Extent=\"" + extent +
        "\">\n      <PointData Scalars=\"" + xml_text(active) + "\">\n";
    for (std::size_t a = 0; a < arrays_.size(); ++a) {
      text += std::string("        <DataArray type=\"") + vtk_type_of(arrays_[a].type) +
              "\" Name=\"" + xml_text(arrays_[a].name) + "\" NumberOfComponents=\"" +
              std::to_string(arrays_[a].components) + "\" format=\"appended\" offset=\"" +
              std::to_string(offsets_[a]) + "\"/>\n";
    }
    return text +
           "      </PointData>\n    </Piece>\n  </ImageData>\n  <AppendedData encoding=\"raw\">\n_";
  }

  void put(const void* bytes, std::size_t count, std::int64_t offset) const {
    if (!write_at(descriptor_, bytes, count, offset)) throw_disk_error(path_);
  }

  bool close_file() {
    if (descriptor_ < 0) return true;
    const bool is_closed = close(descriptor_) == 0;
    descriptor_ = -1;
    return is_closed;
  }

  std::string path_;
  Grid grid_;
  std::vector<ArrayHeader> arrays_;
  FinishedFile file_;
  int descriptor_ = -1;
  std::vector<std::int64_t> offsets_;  ///< of the arrays behind the header
  std::int64_t start_ = 0;             ///< of what is behind the header
};
}  // namespace

bool has_vtk_image_name(const std::string& path) {
  return has_extension(path, ".vti");
}

void check_vti(const std::string& path,
               const Grid& grid,
               const std::vector<ArrayHeader>& arrays,
               bool is_temporal) {
  if (is_temporal) {
    throw IoError(path, "",
                  "a .vti file holds one step; write .vtkhdf or .nii.gz, or steps in files of "
                  "their own (without --temporal, by --source-step)");
  }
  if (arrays.empty()) throw IoError(path, "", "needs an array");
  try {
    check_grid(grid, "grid");
  } catch (const std::invalid_argument& error) {
    throw IoError(path, "", error.what());
  }
}

std::unique_ptr<VolumeSink> make_vti_sink(const std::string& path,
                                          const Grid& grid,
                                          const std::vector<ArrayHeader>& arrays,
                                          const VolumeWriteOptions& options,
                                          bool is_temporal) {
  check_vti(path, grid, arrays, is_temporal);
  return std::make_unique<VtiSink>(path, grid, arrays, options);
}

}  // namespace tetwarp
