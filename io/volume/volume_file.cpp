/// @file volume_file.cpp
/// Readers of volume files. The content of a file, not its name, decides its format.
#include <tetwarp/io.hpp>

#include "io/child/foreign_source.hpp"
#include "io/child/image_kind.hpp"
#include "io/files/volume_source.hpp"
#include "io/h5/h5.hpp"
#include "io/h5/h5_attribute.hpp"
#include "io/h5/h5_read.hpp"
#include "io/image/image_volume.hpp"
#include "io/nifti/nifti_header.hpp"
#include "io/nifti/nifti_volume.hpp"
#include "io/volume/label_source.hpp"
#include "io/vtkhdf/vtkhdf_volume.hpp"

namespace tetwarp {
namespace {
bool is_nifti(const std::string& path) {
  return read_nifti_start(nifti_header_path(path)).fields.has_value();
}
}  // namespace

VolumeHeader read_volume_header(const std::string& path, const VolumeReadOptions& options) {
  const h5::Silence silence;
  VolumeHeader header = is_foreign_image(path) ? read_foreign_volume_header(path, options)
                        : is_nifti(path)       ? read_nifti_volume_header(path, options)
                        : is_image(path)       ? read_image_volume_header(path, options.axes)
                                               : read_vtkhdf_header(path);
  for (ArrayHeader& array : header.arrays) {
    if (options.are_labels && !is_integer(array.type)) array.type = PixelType::int32;
  }
  return header;
}

struct VolumeReader::State {
  std::unique_ptr<VolumeSource> source;
};

VolumeReader::VolumeReader(const std::string& path,
                           const std::string& array,
                           std::int64_t step,
                           const VolumeReadOptions& options) {
  const h5::Silence silence;
  state_.reset(new State{is_foreign_image(path) ? open_foreign_source(path, array, step, options)
                         : is_nifti(path)       ? open_nifti_source(path, array, step, options)
                         : is_image(path)       ? open_image_source(path, array, step, options)
                                                : open_vtkhdf_source(path, array, step)});
  std::unique_ptr<VolumeSource>& source = state_->source;
  if (options.are_labels && !is_integer(source->array().type)) {
    source = std::make_unique<LabelSource>(path, std::move(source));
  }
}

VolumeReader::VolumeReader(VolumeReader&&) noexcept = default;
VolumeReader::~VolumeReader() = default;

const Grid& VolumeReader::grid() const {
  return state_->source->grid();
}

const ArrayHeader& VolumeReader::array() const {
  return state_->source->array();
}

std::vector<std::string> VolumeReader::array_names() const {
  const h5::Silence silence;
  return state_->source->array_names();
}

double VolumeReader::chunk_bytes() const {
  return state_->source->chunk_bytes();
}

double VolumeReader::unpacked_bytes() const {
  return state_->source->unpacked_bytes();
}

void VolumeReader::read(const Region& region, void* samples) const {
  const h5::Silence silence;
  state_->source->read(region, samples);
}

Volume read_volume(const std::string& path,
                   const std::string& array,
                   std::int64_t step,
                   const VolumeReadOptions& options) {
  const VolumeReader reader(path, array, step, options);
  const ArrayHeader& header = reader.array();
  h5::check_memory(path, header.name,
                   static_cast<double>(reader.grid().voxel_count()) * header.components *
                       static_cast<double>(size_of(header.type)));
  Volume volume = make_volume(reader.grid(), header.type, header.components, header.name);
  reader.read({{0, 0, 0}, reader.grid().dims}, volume.data.data());
  return volume;
}

std::optional<std::string> read_fingerprint(const std::string& path) {
  const h5::Silence silence;
  try {
    if (is_foreign_image(path)) return std::nullopt;
    if (is_nifti(path)) {
      const std::string fingerprint = read_nifti_header(path).fingerprint;
      return fingerprint.empty() ? std::nullopt : std::optional(fingerprint);
    }
    const h5::Object file = h5::open_file(path);
    return h5::read_text_attribute(h5::open_group(file, "VTKHDF"), "tetwarp_fingerprint");
  } catch (const IoError&) {
    return std::nullopt;
  }
}

}  // namespace tetwarp
