#include "io/nifti_header.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <tetwarp/error.hpp>

namespace tetwarp {
namespace {
static_assert(sizeof(nifti_1_header) == 348);

constexpr std::pair<int, PixelType> datatypes[] = {
    {NIFTI_TYPE_UINT8, PixelType::uint8},     {NIFTI_TYPE_INT8, PixelType::int8},
    {NIFTI_TYPE_UINT16, PixelType::uint16},   {NIFTI_TYPE_INT16, PixelType::int16},
    {NIFTI_TYPE_UINT32, PixelType::uint32},   {NIFTI_TYPE_INT32, PixelType::int32},
    {NIFTI_TYPE_UINT64, PixelType::uint64},   {NIFTI_TYPE_INT64, PixelType::int64},
    {NIFTI_TYPE_FLOAT32, PixelType::float32}, {NIFTI_TYPE_FLOAT64, PixelType::float64}};

struct RawHeader {
  nifti_1_header values{};
  bool is_complete = false;
  bool is_swapped = false;
  bool is_gzip = false;

  bool is_nifti() const {
    return is_complete && values.sizeof_hdr == 348 && std::memcmp(values.magic, "n+1", 4) == 0;
  }
};

struct stat status_of(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    throw IoError(path, "", std::string("cannot be opened: ") + std::strerror(errno));
  }
  if (!S_ISREG(status.st_mode)) throw IoError(path, "", "is not a plain file");
  return status;
}

/// The header in this machine's byte order.
RawHeader read_raw(const std::string& path) {
  status_of(path);
  NiftiStream stream(path, "rb", true);  // plain files pass through unchanged
  if (!stream) throw IoError(path, "", std::string("cannot be opened: ") + std::strerror(errno));
  RawHeader raw;
  std::ifstream plain(path, std::ios::binary);
  raw.is_gzip = plain.get() == 0x1f && plain.get() == 0x8b;
  raw.is_complete = stream.read(&raw.values, sizeof raw.values);
  if (raw.is_complete && raw.values.sizeof_hdr != 348) {
    nifti_1_header swapped = raw.values;
    swap_nifti_header(&swapped, 1);
    if (swapped.sizeof_hdr == 348) {
      raw.values = swapped;
      raw.is_swapped = true;
    }
  }
  return raw;
}

void check_dims(const std::string& path, const nifti_1_header& raw) {
  if (raw.dim[0] < 1 || raw.dim[0] > 7) {
    throw IoError(path, "dim", "has " + std::to_string(raw.dim[0]) + " axes, expected 1 to 7");
  }
  for (int axis = 1; axis <= raw.dim[0]; ++axis) {
    const std::string name = "dim[" + std::to_string(axis) + "]";
    const std::string value = std::to_string(raw.dim[axis]);
    if (raw.dim[axis] < 1) throw IoError(path, name, "is " + value + ", expected 1 or more");
    if (axis == 4 && raw.dim[axis] != 1) {
      throw IoError(path, name, "is " + value + " times, expected 1; split the series into files");
    }
    if (axis == 5 && raw.dim[axis] > 9) {
      throw IoError(path, name, "is " + value + " components, expected 1 to 9");
    }
    if (axis > 5 && raw.dim[axis] != 1) {
      throw IoError(path, name, "is " + value + ", expected 1: only 3-D volumes are read");
    }
  }
}

Grid grid_of(const std::string& path, const nifti_image& image) {
  const bool has_sform = image.sform_code > 0;
  const mat44& world = has_sform ? image.sto_xyz : image.qto_xyz;
  Grid grid;
  grid.dims = {image.nx, image.ny, image.nz};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double x = world.m[0][axis], y = world.m[1][axis], z = world.m[2][axis];
    grid.spacing[axis] = std::sqrt(x * x + y * y + z * z);
    grid.origin[axis] = world.m[axis][3];
    for (std::size_t row = 0; row < 3; ++row) {
      grid.direction[3 * row + axis] = world.m[row][axis] / grid.spacing[axis];
    }
  }
  try {
    check_grid(grid, "grid");
  } catch (const std::invalid_argument& error) {
    throw IoError(path, has_sform ? "sform" : "qform", error.what());
  }
  return grid;
}

PixelType type_of(const std::string& path, int datatype) {
  for (const auto& [code, type] : datatypes) {
    if (code == datatype) return type;
  }
  throw IoError(path, "datatype",
                "is " + std::to_string(datatype) + " (" + nifti_datatype_string(datatype) +
                    "), expected integers or floats of 1 to 8 bytes; convert the samples");
}

/// True when both forms place the corners of the image within 0.01 voxel of each other.
bool forms_agree(const nifti_image& image, const Grid& grid) {
  const double tolerance = 0.01 * *std::ranges::min_element(grid.spacing);
  for (int corner = 0; corner < 8; ++corner) {
    const double index[4] = {corner & 1 ? image.nx - 1.0 : 0, corner & 2 ? image.ny - 1.0 : 0,
                             corner & 4 ? image.nz - 1.0 : 0, 1};
    for (int row = 0; row < 3; ++row) {
      double difference = 0;
      for (int axis = 0; axis < 4; ++axis) {
        difference +=
            (double{image.sto_xyz.m[row][axis]} - image.qto_xyz.m[row][axis]) * index[axis];
      }
      if (!(std::abs(difference) <= tolerance)) return false;
    }
  }
  return true;
}

/// A text of a header, which ends at its first zero byte or with the field.
template <std::size_t size>
std::string text_of(const char (&field)[size]) {
  return {field, std::find(field, field + size, '\0')};
}

/// Copies as much of a text as the field can hold with its zero byte.
template <std::size_t size>
void set_text(char (&field)[size], const std::string& text) {
  std::memcpy(field, text.data(), std::min(text.size(), size - 1));
}

NiftiFacts facts_of(const nifti_1_header& raw, const nifti_image& image, const Grid& grid) {
  NiftiFacts facts;
  facts.sform_code = std::max<int>(0, raw.sform_code);
  facts.qform_code = std::max<int>(0, raw.qform_code);
  if (facts.sform_code > 0 && facts.qform_code > 0 && !forms_agree(image, grid)) {
    facts.qform_code = 0;
  }
  facts.xyzt_units = static_cast<unsigned char>(raw.xyzt_units);
  facts.intent_code = std::max<int>(0, raw.intent_code);
  facts.intent_p = {raw.intent_p1, raw.intent_p2, raw.intent_p3};
  facts.intent_name = text_of(raw.intent_name);
  facts.description = text_of(raw.descrip);
  return facts;
}

/// True when voxel sizes alone give the grid: no form is needed.
bool is_plain(const Grid& grid) {
  return grid.origin == Point3{0, 0, 0} && grid.direction == Grid{}.direction;
}

bool is_orthonormal(const Grid& grid) {
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      double dot = 0;
      for (std::size_t row = 0; row < 3; ++row) {
        dot += grid.direction[3 * row + a] * grid.direction[3 * row + b];
      }
      if (std::abs(dot - (a == b ? 1.0 : 0.0)) > 1e-5) return false;
    }
  }
  return true;
}
}  // namespace

bool has_nifti_header(const std::string& path) {
  return read_raw(path).is_nifti();
}

NiftiHeader read_nifti_header(const std::string& path) {
  const RawHeader raw = read_raw(path);
  if (!raw.is_nifti()) {
    throw IoError(path, "", "is not a single-file NIfTI-1 (.nii, .nii.gz), convert it to one");
  }
  check_dims(path, raw.values);
  NiftiHeader header;
  header.type = type_of(path, raw.values.datatype);
  header.components = raw.values.dim[0] >= 5 ? raw.values.dim[5] : 1;
  header.is_swapped = raw.is_swapped;

  nifti_set_debug_level(0);  // else the library prints errors
  // The library requires a name with a NIfTI extension; it opens no file here.
  const std::unique_ptr<nifti_image, void (*)(nifti_image*)> image(
      nifti_convert_nhdr2nim(raw.values, "volume.nii"), nifti_image_free);
  if (!image) throw IoError(path, "", "damaged NIfTI header");
  header.grid = grid_of(path, *image);
  header.facts = facts_of(raw.values, *image, header.grid);
  if (image->scl_slope != 0) {
    header.slope = image->scl_slope;
    header.intercept = image->scl_inter;
  }

  const double samples = static_cast<double>(header.grid.voxel_count()) * header.components;
  const double bytes = samples * static_cast<double>(size_of(header.type));
  const auto file_bytes = static_cast<double>(status_of(path).st_size);
  const double offset = raw.values.vox_offset;
  // Deflate cannot shrink data to less than 1/1032.
  const double most = raw.is_gzip ? 1032 * file_bytes : file_bytes;
  if (!(offset >= 352) || offset + bytes > most) {
    throw IoError(path, "",
                  "the header declares " + std::to_string(static_cast<std::int64_t>(bytes)) +
                      " bytes of samples from byte " + std::to_string(offset) +
                      " on, but the file is too small: truncated or damaged, copy it again");
  }
  header.data_offset = static_cast<std::int64_t>(offset);
  return header;
}

nifti_1_header make_nifti_header(const std::string& path,
                                 const Volume& volume,
                                 const NiftiFacts& facts) {
  const Grid& grid = volume.grid;
  int dims[8] = {volume.components > 1 ? 5 : 3, 1, 1, 1, 1, volume.components, 1, 1};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (grid.dims[axis] > 32767) {
      throw IoError(path, "",
                    std::to_string(grid.dims[axis]) +
                        " voxels on an axis, NIfTI-1 allows 32767; write a smaller region");
    }
    dims[axis + 1] = static_cast<int>(grid.dims[axis]);
  }
  int datatype = 0;
  for (const auto& [code, type] : datatypes) {
    if (type == volume.type) datatype = code;
  }
  nifti_set_debug_level(0);
  const std::unique_ptr<nifti_1_header, void (*)(void*)> made(nifti_make_new_header(dims, datatype),
                                                              std::free);
  if (!made)
    throw IoError(path, "", "the NIfTI library has made no header for this size and sample type");
  nifti_1_header header = *made;
  std::memcpy(header.magic, "n+1", 4);
  header.vox_offset = 352;
  header.xyzt_units = static_cast<char>(facts.xyzt_units);
  header.intent_code = static_cast<short>(facts.intent_code);
  header.intent_p1 = static_cast<float>(facts.intent_p[0]);
  header.intent_p2 = static_cast<float>(facts.intent_p[1]);
  header.intent_p3 = static_cast<float>(facts.intent_p[2]);
  set_text(header.intent_name, facts.intent_name);
  set_text(header.descrip, facts.description);

  mat44 world{};
  world.m[3][3] = 1;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      world.m[row][axis] = static_cast<float>(grid.direction[3 * row + axis] * grid.spacing[axis]);
    }
    world.m[row][3] = static_cast<float>(grid.origin[row]);
    header.pixdim[row + 1] = static_cast<float>(grid.spacing[row]);
  }
  const bool has_qform = facts.qform_code > 0 && is_orthonormal(grid);
  int sform_code = facts.sform_code;
  if (sform_code == 0 && !has_qform && !is_plain(grid)) {
    sform_code = std::max<int>(facts.qform_code, NIFTI_XFORM_SCANNER_ANAT);
  }
  if (sform_code > 0) {
    header.sform_code = static_cast<short>(sform_code);
    std::memcpy(header.srow_x, world.m[0], sizeof header.srow_x);
    std::memcpy(header.srow_y, world.m[1], sizeof header.srow_y);
    std::memcpy(header.srow_z, world.m[2], sizeof header.srow_z);
  }
  if (!has_qform) return header;
  header.qform_code = static_cast<short>(facts.qform_code);
  nifti_mat44_to_quatern(world, &header.quatern_b, &header.quatern_c, &header.quatern_d,
                         &header.qoffset_x, &header.qoffset_y, &header.qoffset_z, &header.pixdim[1],
                         &header.pixdim[2], &header.pixdim[3], &header.pixdim[0]);
  return header;
}

}  // namespace tetwarp
