/// @file nifti_header.cpp
/// Reads a header, checks each field, and compares the file's size with it.
#include "io/nifti/nifti_header.hpp"

#include <nifti1_io.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <tetwarp/error.hpp>

#include "io/files/extension.hpp"
#include "io/files/memory.hpp"
#include "io/nifti/nifti_extension.hpp"
#include "io/nifti/nifti_grid.hpp"

namespace tetwarp {
namespace {
constexpr std::pair<int, PixelType> datatypes[] = {
    {NIFTI_TYPE_UINT8, PixelType::uint8},     {NIFTI_TYPE_INT8, PixelType::int8},
    {NIFTI_TYPE_UINT16, PixelType::uint16},   {NIFTI_TYPE_INT16, PixelType::int16},
    {NIFTI_TYPE_UINT32, PixelType::uint32},   {NIFTI_TYPE_INT32, PixelType::int32},
    {NIFTI_TYPE_UINT64, PixelType::uint64},   {NIFTI_TYPE_INT64, PixelType::int64},
    {NIFTI_TYPE_FLOAT32, PixelType::float32}, {NIFTI_TYPE_FLOAT64, PixelType::float64}};

struct stat status_of(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    throw IoError(path, "", std::string("cannot be opened: ") + std::strerror(errno));
  }
  if (!S_ISREG(status.st_mode)) throw IoError(path, "", "is not a plain file");
  return status;
}

bool is_gzip(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return file.get() == 0x1f && file.get() == 0x8b;
}

/// NAME.img or NAME.img.gz for NAME.hdr or NAME.hdr.gz.
std::string sample_path(const std::string& header) {
  for (const std::string end : {".hdr", ".hdr.gz"}) {
    if (!has_extension(header, end)) continue;
    const std::string stem = header.substr(0, header.size() - end.size());
    for (const char* const other : {".img", ".img.gz", ".IMG", ".IMG.GZ"}) {
      if (std::filesystem::is_regular_file(stem + other)) return stem + other;
    }
    throw IoError(header, "", "has no file of samples beside it; copy '" + stem + ".img', too");
  }
  throw IoError(header, "", "is half of a pair, whose name ends in .hdr; rename it");
}

/// Checks the axes and makes those that the header does not have 1.
void check_dims(const std::string& path, NiftiFields& fields) {
  auto& dim = fields.dim;
  if (dim[0] < 1 || dim[0] > 7) {
    throw IoError(path, "dim[0]", "is " + std::to_string(dim[0]) + " axes, expected 1 to 7");
  }
  for (std::size_t axis = 1; axis < 8; ++axis) {
    if (static_cast<std::int64_t>(axis) > dim[0]) dim[axis] = 1;
    const auto refuse = [&](const std::string& problem) {
      throw IoError(path, "dim[" + std::to_string(axis) + "]",
                    "is " + std::to_string(dim[axis]) + problem);
    };
    if (dim[axis] < 1) refuse(", expected 1 or more; correct the header");
    if (axis < 4 && dim[axis] > 1 << 30) refuse(" voxels, expected at most 2^30");
    if (axis == 4 && dim[axis] > 0x7fffffff) refuse(" steps, expected at most 2147483647");
    if (axis == 5 && dim[axis] > 9) refuse(" components, expected 1 to 9");
    if (axis > 5 && dim[axis] != 1) {
      refuse(", expected 1: only volumes and their series are read");
    }
  }
}

/// Bytes of a color; 0: the samples are numbers.
int color_bytes(const NiftiFields& fields) {
  return fields.datatype == NIFTI_TYPE_RGB24 ? 3 : fields.datatype == NIFTI_TYPE_RGBA32 ? 4 : 0;
}

/// Makes colors components, for which NIfTI has intents of their own.
void set_colors(const std::string& path, const NiftiFields& fields, NiftiHeader& header) {
  const int bytes = color_bytes(fields);
  if (bytes == 0) return;
  if (header.components != 1) {
    throw IoError(path, "dim[5]",
                  "is " + std::to_string(header.components) +
                      " colors per voxel, expected 1; correct the header");
  }
  header.components = bytes;
  header.is_interleaved = true;
  header.facts.intent_code = bytes == 3 ? NIFTI_INTENT_RGB_VECTOR : NIFTI_INTENT_RGBA_VECTOR;
}

PixelType checked_type(const std::string& path, const NiftiFields& fields) {
  if (const int bytes = color_bytes(fields); bytes > 0) {
    if (fields.bitpix == 8 * bytes) return PixelType::uint8;
    throw IoError(path, "bitpix",
                  "is " + std::to_string(fields.bitpix) + ", but colors have " +
                      std::to_string(8 * bytes) + "; correct the header");
  }
  const auto found =
      std::ranges::find(datatypes, fields.datatype, [](const auto& entry) { return entry.first; });
  if (found == std::end(datatypes)) {
    const char* const name = nifti_datatype_string(static_cast<int>(fields.datatype));
    throw IoError(path, "datatype",
                  "is " + std::to_string(fields.datatype) + " (" + name +
                      "), expected integers or floats of 1 to 8 bytes; convert the samples");
  }
  const auto bits = static_cast<std::int64_t>(8 * size_of(found->second));
  if (fields.bitpix != bits) {
    throw IoError(path, "bitpix",
                  "is " + std::to_string(fields.bitpix) + ", but samples of datatype " +
                      std::to_string(fields.datatype) + " (" + name_of(found->second) + ") have " +
                      std::to_string(bits) + "; correct the header");
  }
  return found->second;
}

/// Vectors and tensors have as many components as their intent says, along axis 5; a series has
/// none of these intents.
void check_intent(const std::string& path, const NiftiFields& fields) {
  const bool has_components = fields.intent_code == NIFTI_INTENT_SYMMATRIX ||
                              fields.intent_code == NIFTI_INTENT_DISPVECT ||
                              fields.intent_code == NIFTI_INTENT_VECTOR;
  if (!has_components) return;
  const std::int64_t components = fields.dim[5];
  const bool is_tensor = fields.intent_code == NIFTI_INTENT_SYMMATRIX;
  const bool has_intent = is_tensor ? components == 1 || components == 3 || components == 6
                                    : fields.intent_code == NIFTI_INTENT_VECTOR || components < 4;
  if (!has_intent) {
    throw IoError(path, "dim[5]",
                  "is " + std::to_string(components) + " components, but intent_code " +
                      std::to_string(fields.intent_code) +
                      (is_tensor ? ", symmetric matrices, has 6 (3 of 2 x 2, 1 of 1 x 1)"
                                 : ", displacements, has 3") +
                      "; correct the header");
  }
  if (fields.dim[4] == 1 || components > 1) return;
  throw IoError(path, "intent_code",
                "is " + std::to_string(fields.intent_code) +
                    ", vectors or tensors, whose components lie along dim[5], but dim[5] is 1 and "
                    "dim[4] is " +
                    std::to_string(fields.dim[4]) + "; move the components to dim[5]");
}

std::vector<double> times_of(const std::string& path, const NiftiFields& fields) {
  if (fields.dim[4] == 1) return {};
  const double step = fields.pixdim[4] == 0 ? 1 : fields.pixdim[4];
  if (!std::isfinite(step) || step < 0 || !std::isfinite(fields.toffset)) {
    throw IoError(
        path, std::isfinite(step) && step >= 0 ? "toffset" : "pixdim[4]",
        "gives no times to the " + std::to_string(fields.dim[4]) + " steps; correct the header");
  }
  const double unit = nifti_time_unit(fields.xyzt_units);
  std::vector<double> times;
  for (std::int64_t s = 0; s < fields.dim[4]; ++s) {
    times.push_back(unit * (fields.toffset + static_cast<double>(s) * step));
  }
  return times;
}

/// Numbers of NIfTI-2 that NIfTI-1 has no place for are left out.
bool is_kept(double value) {
  return std::isfinite(static_cast<float>(value));
}

NiftiFacts facts_of(const NiftiFields& fields, const Grid& grid) {
  const auto code = [](std::int64_t value) {
    return static_cast<int>(std::clamp<std::int64_t>(value, 0, 32767));
  };
  NiftiFacts facts;
  facts.sform_code = code(fields.sform_code);
  facts.qform_code = code(fields.qform_code);
  if (facts.sform_code > 0 && facts.qform_code > 0 && !forms_agree(fields, grid)) {
    facts.qform_code = 0;
  }
  facts.xyzt_units = static_cast<int>(fields.xyzt_units & 255);
  facts.intent_code = code(fields.intent_code);
  if (std::ranges::all_of(fields.intent_p, is_kept)) facts.intent_p = fields.intent_p;
  facts.intent_name = fields.intent_name;
  facts.description = fields.descrip;
  if (is_kept(fields.cal_min)) facts.cal_min = fields.cal_min;
  if (is_kept(fields.cal_max)) facts.cal_max = fields.cal_max;
  if (is_kept(fields.pixdim[4]) && static_cast<float>(fields.pixdim[4]) > 0) {
    facts.time_step = fields.pixdim[4];
  }
  return facts;
}

/// Names what the header says and NiftiHeader does not hold.
std::vector<std::string> left_out_of(const NiftiFields& fields, const NiftiFacts& facts) {
  std::vector<std::string> names;
  if (fields.qform_code > 0 && facts.qform_code == 0) {
    names.emplace_back("qform, which differs from the sform");
  }
  if (!std::ranges::all_of(fields.intent_p, is_kept)) names.emplace_back("intent_p1 to 3");
  if (!is_kept(fields.cal_min)) names.emplace_back("cal_min");
  if (!is_kept(fields.cal_max)) names.emplace_back("cal_max");
  if (fields.dim_info != 0) names.emplace_back("dim_info");
  if (fields.slice_code != 0 || fields.slice_duration != 0 || fields.slice_end != 0) {
    names.emplace_back("times of slices (slice_code, slice_duration, slice_start, slice_end)");
  }
  if (fields.dim[4] == 1 && fields.toffset != 0) names.emplace_back("toffset");
  if (!fields.aux_file.empty()) names.emplace_back("aux_file");
  return names;
}

/// The first sample of a single file [byte]. Some programs leave vox_offset 0.
double offset_of(const std::string& path, const NiftiFields& fields, bool has_extensions) {
  const auto least = static_cast<double>(fields.header_bytes() + 4);
  if (fields.is_pair || fields.vox_offset >= least) return fields.vox_offset;
  if (fields.vox_offset == 0 && !has_extensions) return least;
  throw IoError(path, "vox_offset",
                "is " + std::to_string(fields.vox_offset) + ", expected at least " +
                    std::to_string(fields.header_bytes() + 4) +
                    (fields.vox_offset == 0 ? " and the end of the extensions" : "") +
                    "; correct the header");
}

/// Checks that the file of samples can hold them. @param offset  of the first one
void check_size(const std::string& path, const NiftiHeader& header, double offset) {
  const double bytes = static_cast<double>(header.grid.voxel_count()) * header.components *
                       static_cast<double>(header.steps) *
                       static_cast<double>(size_of(header.type));
  const auto file_bytes = static_cast<double>(status_of(header.samples).st_size);
  // Deflate cannot shrink data to less than 1/1032.
  const double most = header.is_gzip ? 1032 * file_bytes : file_bytes;
  if (offset >= 0 && offset + bytes <= most) return;
  throw IoError(path, "",
                "the header declares " + bytes_text(bytes) + " of samples from byte " +
                    std::to_string(offset) + " on, but " +
                    (header.samples == path ? "the file" : "'" + header.samples + "'") +
                    " is too small: truncated or damaged, copy it again");
}
}  // namespace

NiftiStart read_nifti_start(const std::string& path) {
  status_of(path);
  NiftiStream stream(path, "rb", true);  // plain files pass through unchanged
  if (!stream) throw IoError(path, "", std::string("cannot be opened: ") + std::strerror(errno));
  std::vector<char> bytes(544);
  bytes.resize(stream.read_some(bytes.data(), bytes.size()));
  return decode_nifti(bytes);
}

std::string nifti_header_path(const std::string& path) {
  for (const std::string end : {".img", ".img.gz"}) {
    if (!has_extension(path, end)) continue;
    const std::string stem = path.substr(0, path.size() - end.size());
    for (const char* const other : {".hdr", ".hdr.gz", ".HDR", ".HDR.GZ"}) {
      if (std::filesystem::is_regular_file(stem + other)) return stem + other;
    }
  }
  return path;
}

NiftiHeader read_nifti_header(const std::string& path) {
  const std::string header_path = nifti_header_path(path);
  NiftiStart start = read_nifti_start(header_path);
  if (!start.fields) {
    throw IoError(path, "",
                  start.is_analyze ? "is an Analyze 7.5 image, which has no orientation; convert "
                                     "it to NIfTI"
                                   : "has no NIfTI header: damaged, or another format");
  }
  NiftiFields& fields = *start.fields;
  check_dims(path, fields);
  NiftiHeader header;
  header.type = checked_type(path, fields);
  check_intent(path, fields);
  header.components = static_cast<int>(fields.dim[5]);
  header.steps = fields.dim[4];
  header.grid = grid_of(path, fields);
  header.is_swapped = start.is_swapped;
  header.facts = facts_of(fields, header.grid);
  set_colors(path, fields, header);
  if (std::isfinite(fields.scl_slope) && fields.scl_slope != 0 && !header.is_interleaved) {
    if (!std::isfinite(fields.scl_inter)) {
      throw IoError(path, "scl_inter",
                    "is " + std::to_string(fields.scl_inter) +
                        ", expected a finite number beside the scl_slope; correct the header");
    }
    header.slope = fields.scl_slope;
    header.intercept = fields.scl_inter;
  }
  header.samples = fields.is_pair ? sample_path(header_path) : path;
  header.is_gzip = is_gzip(header.samples);
  const double offset = offset_of(path, fields, start.has_extensions);
  check_size(path, header, offset);
  header.times = times_of(path, fields);
  header.data_offset = static_cast<std::int64_t>(offset);
  const NiftiExtensions extensions = read_extensions(
      header_path, start.is_swapped, fields.header_bytes(),
      fields.is_pair ? std::numeric_limits<std::int64_t>::max() : header.data_offset);
  if (!fields.is_pair) header.fingerprint = extensions.fingerprint;
  header.left_out = left_out_of(fields, header.facts);
  header.left_out.insert(header.left_out.end(), extensions.others.begin(), extensions.others.end());
  return header;
}

int nifti_datatype_of(PixelType type) {
  const auto found =
      std::ranges::find(datatypes, type, [](const auto& entry) { return entry.second; });
  return found->first;
}

double nifti_length_unit(std::int64_t xyzt_units) {
  switch (XYZT_TO_SPACE(xyzt_units)) {
    case NIFTI_UNITS_METER:
      return 1e3;
    case NIFTI_UNITS_MICRON:
      return 1e-3;
    default:
      return 1;
  }
}

double nifti_time_unit(std::int64_t xyzt_units) {
  switch (XYZT_TO_TIME(xyzt_units)) {
    case NIFTI_UNITS_MSEC:
      return 1e-3;
    case NIFTI_UNITS_USEC:
      return 1e-6;
    default:
      return 1;
  }
}

}  // namespace tetwarp
