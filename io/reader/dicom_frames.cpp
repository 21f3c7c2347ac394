/// @file dicom_frames.cpp
/// Places of frames by offsets along the normal, or by functional groups.
#include "io/reader/dicom_frames.hpp"

#include <gdcmSequenceOfItems.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <tetwarp/error.hpp>

#include "host/base/point3.hpp"

namespace tetwarp {
namespace {
using Items = gdcm::SmartPointer<gdcm::SequenceOfItems>;

/// The items of a sequence; null if there is none.
Items items_of(const gdcm::DataSet& attributes, std::uint16_t group, std::uint16_t element) {
  const gdcm::Tag tag(group, element);
  if (!attributes.FindDataElement(tag)) return nullptr;
  return attributes.GetDataElement(tag).GetValueAsSQ();
}

/// Sets numbers from an attribute in the first item of a sequence of a functional group, if it is
/// there.
void set_from(const gdcm::DataSet& groups,
              const gdcm::Tag& sequence,
              const gdcm::Tag& attribute,
              std::vector<double>& numbers) {
  const Items items = items_of(groups, sequence.GetGroup(), sequence.GetElement());
  if (items == nullptr || items->GetNumberOfItems() == 0) return;
  const std::vector<double> found = decimals_of(items->GetItem(1).GetNestedDataSet(),
                                                attribute.GetGroup(), attribute.GetElement());
  if (!found.empty()) numbers = found;
}

/// Sets what functional groups, of all frames or of one, say of a slice.
void set_from_groups(const gdcm::DataSet& groups, DicomSlice& slice) {
  const gdcm::Tag measures(0x0028, 0x9110), values(0x0028, 0x9145);
  set_from(groups, {0x0020, 0x9113}, {0x0020, 0x0032}, slice.position);
  set_from(groups, {0x0020, 0x9116}, {0x0020, 0x0037}, slice.orientation);
  set_from(groups, measures, {0x0028, 0x0030}, slice.spacing);
  std::vector<double> thickness{slice.thickness}, slope{slice.slope}, intercept{slice.intercept};
  set_from(groups, measures, {0x0018, 0x0050}, thickness);
  set_from(groups, values, {0x0028, 0x1053}, slope);
  set_from(groups, values, {0x0028, 0x1052}, intercept);
  slice.thickness = thickness.front();
  slice.slope = slope.front();
  slice.intercept = intercept.front();
}

std::vector<DicomSlice> dose_slices(const std::vector<double>& offsets, const DicomSlice& first) {
  const auto& o = first.orientation;
  const Point3 normal = cross({o[0], o[1], o[2]}, {o[3], o[4], o[5]});
  std::vector<DicomSlice> slices(offsets.size(), first);
  for (std::size_t n = 0; n < slices.size(); ++n) {
    slices[n].frame = static_cast<int>(n);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      slices[n].position[axis] += (offsets[n] - offsets[0]) * normal[axis];
    }
  }
  return slices;
}
}  // namespace

std::vector<double> decimals_in(const std::string& text) {
  std::vector<double> found;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t past = std::min(text.find('\\', at), text.size());
    while (at < past && (text[at] == ' ' || text[at] == '+')) ++at;
    double number = 0;
    const auto end = std::from_chars(text.data() + at, text.data() + past, number);
    if (end.ec != std::errc() || !std::isfinite(number)) return {};
    found.push_back(number);
    at = past + 1;
  }
  return found;
}

std::vector<double> decimals_of(const gdcm::DataSet& attributes,
                                std::uint16_t group,
                                std::uint16_t element) {
  const gdcm::Tag tag(group, element);
  if (!attributes.FindDataElement(tag)) return {};
  const gdcm::ByteValue* const bytes = attributes.GetDataElement(tag).GetByteValue();
  if (bytes == nullptr) return {};
  return decimals_in({bytes->GetPointer(), static_cast<std::size_t>(bytes->GetLength())});
}

std::vector<DicomSlice> slices_of_frames(const gdcm::DataSet& attributes,
                                         const DicomSlice& first,
                                         int frames) {
  const std::vector<double> offsets = decimals_of(attributes, 0x3004, 0x000c);
  const bool has_place = first.orientation.size() == 6 && first.position.size() == 3;
  if (std::ssize(offsets) == frames && has_place) return dose_slices(offsets, first);
  const Items own = items_of(attributes, 0x5200, 0x9230);
  if (own == nullptr || own->GetNumberOfItems() != static_cast<std::size_t>(frames)) {
    if (frames == 1) return {first};
    const std::string name = std::filesystem::path(first.file).filename().string();
    throw IoError(first.file, name,
                  "holds " + std::to_string(frames) +
                      " frames, which are read of dose grids and enhanced images alone; convert it "
                      "to NIfTI, for example by dcm2niix");
  }
  DicomSlice common = first;
  const Items shared = items_of(attributes, 0x5200, 0x9229);
  if (shared != nullptr && shared->GetNumberOfItems() > 0) {
    set_from_groups(shared->GetItem(1).GetNestedDataSet(), common);
  }
  std::vector<DicomSlice> slices(static_cast<std::size_t>(frames), common);
  for (int n = 0; n < frames; ++n) {
    DicomSlice& slice = slices[static_cast<std::size_t>(n)];
    slice.frame = n;
    set_from_groups(own->GetItem(static_cast<std::size_t>(n) + 1).GetNestedDataSet(), slice);
  }
  return slices;
}

}  // namespace tetwarp
