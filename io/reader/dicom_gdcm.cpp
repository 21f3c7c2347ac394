/// @file dicom_gdcm.cpp
/// Headers and samples of DICOM files by GDCM, the library that ITK reads them with.
#include <gdcmImage.h>
#include <gdcmImageChangePlanarConfiguration.h>
#include <gdcmImageReader.h>
#include <gdcmReader.h>
#include <gdcmStringFilter.h>
#include <gdcmTrace.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>
#include <tetwarp/error.hpp>
#include <type_traits>

#include "host/base/pixel_dispatch.hpp"
#include "io/image/dicom_stack.hpp"
#include "io/reader/dicom_frames.hpp"
#include "io/reader/image_readers.hpp"

namespace tetwarp {
namespace {
namespace fs = std::filesystem;

const std::string dicom_array = Volume{}.name;

/// An error about a file of the folder that is read.
[[noreturn]] void fail_in(const std::string& file,
                          const std::string& attribute,
                          const std::string& problem) {
  const std::string name = fs::path(file).filename().string();
  throw IoError(file, attribute.empty() ? name : name + " " + attribute, problem);
}

/// The header of a file, up to its pixels.
class DicomHeader {
 public:
  explicit DicomHeader(const std::string& path) {
    const gdcm::Tag pixel_data(0x7fe0, 0x0010);
    reader_.SetFileName(path.c_str());
    is_read_ = reader_.ReadUpToTag(pixel_data);
    if (is_read_) filter_.SetFile(reader_.GetFile());
  }

  bool is_read() const { return is_read_; }
  const gdcm::DataSet& attributes() const { return reader_.GetFile().GetDataSet(); }
  bool has(std::uint16_t group, std::uint16_t element) const {
    return attributes().FindDataElement(gdcm::Tag(group, element));
  }
  /// Without blanks at its ends; empty where the header lacks it.
  std::string text(std::uint16_t group, std::uint16_t element) const {
    std::string value = filter_.ToString(gdcm::Tag(group, element));
    const std::string blanks(" \t\0", 3);
    value.erase(0, std::min(value.size(), value.find_first_not_of(blanks)));
    value.erase(value.find_last_not_of(blanks) + 1);
    return value;
  }
  std::vector<double> numbers(std::uint16_t group, std::uint16_t element) const {
    return decimals_in(text(group, element));
  }
  double number(std::uint16_t group, std::uint16_t element, double otherwise) const {
    const std::vector<double> found = numbers(group, element);
    return found.empty() ? otherwise : found.front();
  }
  int count(std::uint16_t group, std::uint16_t element, int otherwise) const {
    return static_cast<int>(std::clamp(number(group, element, otherwise), 0.0, 1e6));
  }

 private:
  gdcm::Reader reader_;
  gdcm::StringFilter filter_;
  bool is_read_ = false;
};

/// Throws IoError for images whose pixels are not values of a scale or colors.
void check_pixels(const std::string& path, const DicomHeader& header) {
  const std::string colors = header.text(0x0028, 0x0004);
  if (!colors.starts_with("MONOCHROME") && colors != "RGB") {
    fail_in(path, "PhotometricInterpretation",
            "is '" + colors + "', expected MONOCHROME or RGB; convert it to RGB");
  }
  if (header.has(0x0028, 0x3000)) {
    fail_in(path, "ModalityLUTSequence",
            "gives values by a table, expected a rescale slope; convert it to NIfTI");
  }
}

/// The slices of a file; none of a file that holds no image.
std::vector<DicomSlice> slices_of(const std::string& path, const DicomHeader& header) {
  DicomSlice slice;
  slice.file = path;
  slice.rows = header.count(0x0028, 0x0010, 0);
  slice.columns = header.count(0x0028, 0x0011, 0);
  if (slice.rows == 0 || slice.columns == 0) return {};
  slice.series = header.text(0x0020, 0x000e);
  slice.label = header.text(0x0008, 0x0060);
  const std::string description = header.text(0x0008, 0x103e);
  if (!description.empty()) slice.label += " '" + description + "'";
  slice.components = header.count(0x0028, 0x0002, 1);
  slice.bits = header.count(0x0028, 0x0101, 8);
  slice.is_signed = header.count(0x0028, 0x0103, 0) == 1;
  slice.colors = header.text(0x0028, 0x0004);
  slice.has_table = header.has(0x0028, 0x3000);
  slice.position = header.numbers(0x0020, 0x0032);
  slice.orientation = header.numbers(0x0020, 0x0037);
  slice.spacing = header.numbers(0x0028, 0x0030);
  slice.thickness = header.number(0x0018, 0x0088, header.number(0x0018, 0x0050, 0));
  slice.slope = header.number(0x0028, 0x1053, header.number(0x3004, 0x000e, 1));
  slice.intercept = header.number(0x0028, 0x1052, 0);
  const int frames = std::max(1, header.count(0x0028, 0x0008, 1));
  return slices_of_frames(header.attributes(), slice, frames);
}

struct DicomFiles {
  std::vector<DicomSlice> slices;
  int others = 0;  ///< files that hold no DICOM image
};

/// All slices in a file or in the files of a folder; those in folders of it are not read.
DicomFiles read_headers(const std::string& path) {
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  std::vector<std::string> files;
  if (fs::is_directory(path)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
      if (entry.is_regular_file()) files.push_back(entry.path().string());
    }
    std::ranges::sort(files);
  } else {
    files.push_back(path);
  }
  DicomFiles found;
  for (const std::string& file : files) {
    const DicomHeader header(file);
    const std::vector<DicomSlice> slices =
        header.is_read() ? slices_of(file, header) : std::vector<DicomSlice>();
    found.slices.insert(found.slices.end(), slices.begin(), slices.end());
    if (slices.empty()) ++found.others;
  }
  return found;
}

/// The pixels of a file as they are stored.
class DicomPixels {
 public:
  explicit DicomPixels(const std::string& path) : path_(path) {
    gdcm::ImageReader reader;
    reader.SetFileName(path.c_str());
    if (!reader.Read()) fail("its pixels cannot be read: damaged, or packed in a way that is not");
    gdcm::ImageChangePlanarConfiguration planes;  // components of a pixel beside each other
    planes.SetInput(reader.GetImage());
    planes.SetPlanarConfiguration(0);
    if (!planes.Change()) fail("its components cannot be sorted");
    const gdcm::Image& image = planes.GetOutput();
    format_ = image.GetPixelFormat();
    data_.resize(image.GetBufferLength());
    const gdcm::DataSet& attributes = reader.GetFile().GetDataSet();
    const gdcm::ByteValue* const stored =  // none of pixels that are packed
        attributes.GetDataElement(gdcm::Tag(0x7fe0, 0x0010)).GetByteValue();
    if (stored != nullptr && stored->GetLength() < data_.size()) {
      fail("is shorter than rows and columns");
    }
    if (!image.GetBuffer(data_.data())) fail("its pixels are damaged");
  }

  /// Converts a frame to values. @param values  out, of `type`
  void convert(const DicomSlice& slice, PixelType type, std::vector<std::byte>& values) const {
    switch (format_.GetScalarType()) {
      case gdcm::PixelFormat::UINT8:
        return convert_from<std::uint8_t>(slice, type, values);
      case gdcm::PixelFormat::INT8:
        return convert_from<std::int8_t>(slice, type, values);
      case gdcm::PixelFormat::UINT12:
      case gdcm::PixelFormat::UINT16:
        return convert_from<std::uint16_t>(slice, type, values);
      case gdcm::PixelFormat::INT12:
      case gdcm::PixelFormat::INT16:
        return convert_from<std::int16_t>(slice, type, values);
      case gdcm::PixelFormat::UINT32:
        return convert_from<std::uint32_t>(slice, type, values);
      case gdcm::PixelFormat::INT32:
        return convert_from<std::int32_t>(slice, type, values);
      default:
        fail("has pixels of " + std::to_string(format_.GetBitsAllocated()) +
             " bits, expected integers of 8, 16 or 32");
    }
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    fail_in(path_, "PixelData", problem + "; convert it to NIfTI, for example by dcm2niix");
  }

  template <class Stored>
  void convert_from(const DicomSlice& slice, PixelType type, std::vector<std::byte>& values) const {
    with_pixel_type(type, [&]<class Value>(Value) {
      const std::size_t count = values.size() / sizeof(Value);
      const std::size_t first = static_cast<std::size_t>(slice.frame) * count;
      if ((first + count) * sizeof(Stored) > data_.size()) fail("is shorter than rows and columns");
      for (std::size_t n = 0; n < count; ++n) {
        Stored stored;
        std::memcpy(&stored, data_.data() + (first + n) * sizeof stored, sizeof stored);
        const double value = slice.slope * static_cast<double>(stored) + slice.intercept;
        // Bits beyond BitsStored may hold what no value of the type is.
        if constexpr (std::is_integral_v<Value>) {
          using Limits = std::numeric_limits<Value>;
          if (!(value >= static_cast<double>(Limits::min()) &&
                value <= static_cast<double>(Limits::max()))) {
            fail("has bits beyond its BitsStored");
          }
        }
        const auto converted = static_cast<Value>(value);
        std::memcpy(values.data() + n * sizeof converted, &converted, sizeof converted);
      }
    });
  }

  std::string path_;
  gdcm::PixelFormat format_;
  std::vector<char> data_;
};

ForeignImage dicom_image_of(const DicomFiles& files, const DicomStack& stack) {
  const std::string& first = stack.slices.front().file;
  const DicomHeader header(first);
  check_pixels(first, header);
  ForeignImage image;
  image.grid = stack.grid;
  image.arrays = {{dicom_array, stack.type, stack.components}};
  image.active = dicom_array;
  image.notes = stack.notes;
  if (header.text(0x0028, 0x0004) == "MONOCHROME1") {
    image.notes.emplace_back(
        "MONOCHROME1: viewers show small values bright; values stay as stored");
  }
  image.left_out = {"attributes beside geometry and rescaling"};
  if (files.others > 0) {
    image.left_out.push_back(std::to_string(files.others) + " files that hold no DICOM image");
  }
  if (files.slices.size() > stack.slices.size()) {
    image.left_out.push_back(std::to_string(files.slices.size() - stack.slices.size()) +
                             " slices of other series");
  }
  return image;
}
}  // namespace

ForeignImage read_dicom_image(const std::string& path, const std::string& series) {
  const DicomFiles files = read_headers(path);
  return dicom_image_of(files, stack_of(path, files.slices, series));
}

void read_dicom_samples(const std::string& path,
                        const std::string& series,
                        const TakeImage& take_image,
                        const TakeSlice& take) {
  const DicomFiles files = read_headers(path);
  const DicomStack stack = stack_of(path, files.slices, series);
  take_image(dicom_image_of(files, stack));
  std::vector<std::byte> values(
      static_cast<std::size_t>(stack.grid.dims[0] * stack.grid.dims[1] * stack.components) *
      size_of(stack.type));
  std::optional<DicomPixels> pixels;
  std::string file;
  for (const DicomSlice& slice : stack.slices) {
    if (!pixels || slice.file != file) pixels.emplace(slice.file);
    file = slice.file;
    pixels->convert(slice, stack.type, values);
    take(values.data(), values.size());
  }
}

}  // namespace tetwarp
