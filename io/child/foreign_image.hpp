/// @file foreign_image.hpp
/// Images that the program tetwarp-read reads by libraries: DICOM series and VTK's .vti.
#pragma once
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include <tetwarp/volume.hpp>

namespace tetwarp {

/// An array of such an image.
struct ForeignArray {
  std::string name;
  PixelType type = PixelType::uint8;
  int components = 1;

  bool operator==(const ForeignArray&) const = default;
};

/// What tetwarp-read tells of an image.
struct ForeignImage {
  Grid grid;
  std::vector<ForeignArray> arrays;   ///< at least one
  std::string active;                 ///< the array that is read when none is named
  std::vector<std::string> not_read;  ///< as VolumeHeader::not_read
  std::vector<std::string> left_out;  ///< as VolumeHeader::left_out
  std::vector<std::string> notes;     ///< as VolumeHeader::notes
};

/// Called with an image, before its samples.
using TakeImage = std::function<void(const ForeignImage& image)>;

/// Called with the samples of one slice after the other.
using TakeSlice = std::function<void(const void* samples, std::size_t bytes)>;

/// Has the program read an image, and checks what it sends.
/// @param series  of DICOM: the UID of the series; empty: the only one
/// @throws IoError  as run_reader()
ForeignImage read_image_in_child(const std::string& path, const std::string& series);

/// Has the program read the samples of an array.
/// @param image  what read_image_in_child() returned
/// @param array  its name
/// @throws IoError  as run_reader(); grid or arrays are no more those of `image`
void read_samples_in_child(const std::string& path,
                           const std::string& series,
                           const ForeignImage& image,
                           const std::string& array,
                           const TakeSlice& take);

/// Sends or reads all members of an array.
/// @param message  a MessageWriter or a MessageReader
/// @param value    const for a MessageWriter
template <class Message, class Value>
requires std::is_same_v<std::remove_const_t<Value>, ForeignArray>
void exchange_members(Message& message, Value& value) {
  auto& [name, type, components] = value;
  message(name, type, components);
}

/// Sends or reads all members of an image.
template <class Message, class Value>
requires std::is_same_v<std::remove_const_t<Value>, ForeignImage>
void exchange_members(Message& message, Value& value) {
  // All members: a new one does not compile.
  auto& [grid, arrays, active, not_read, left_out, notes] = value;
  message(grid, arrays, active, not_read, left_out, notes);
}

}  // namespace tetwarp
