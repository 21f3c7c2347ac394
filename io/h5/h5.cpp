/// @file h5.cpp
/// Error texts, types and the check of memory.
#include "io/h5/h5.hpp"

#include <tetwarp/error.hpp>

#include "io/files/memory.hpp"

namespace tetwarp::h5 {
namespace {
herr_t keep_first(unsigned depth, const H5E_error2_t* error, void* text) {
  // Upward, the first entry is that of the innermost call.
  if (depth == 0 && error->desc != nullptr) *static_cast<std::string*>(text) = error->desc;
  return 0;
}
}  // namespace

Silence::Silence() {
  H5Eget_auto2(H5E_DEFAULT, &print_, &argument_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Silence::~Silence() {
  H5Eset_auto2(H5E_DEFAULT, print_, argument_);
}

std::string last_reason() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &text);
  // Of failed system calls only the error message is kept, without times and addresses.
  const std::string marker = "error message = '";
  if (const std::size_t begin = text.find(marker); begin != std::string::npos) {
    text = text.substr(begin + marker.size());
    text = text.substr(0, text.find('\''));
  }
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  }
  return text;
}

void Object::fail(const std::string& problem) const {
  throw IoError(file, name, problem);
}

void Object::fail_with_reason(const std::string& problem) const {
  const std::string reason = last_reason();
  fail(reason.empty() ? problem : problem + " (" + reason + ")");
}

void check_memory(const std::string& file, const std::string& name, double bytes) {
  const double available = available_memory();
  if (bytes <= available) return;
  throw IoError(file, name,
                "needs " + bytes_text(bytes) + " of memory, this machine has " +
                    bytes_text(available) +
                    " left; crop or resample the data, or correct the sizes "
                    "if they are wrong");
}

hid_t file_type_of(PixelType type) {
  switch (type) {
    case PixelType::uint8:
      return H5T_STD_U8LE;
    case PixelType::int8:
      return H5T_STD_I8LE;
    case PixelType::uint16:
      return H5T_STD_U16LE;
    case PixelType::int16:
      return H5T_STD_I16LE;
    case PixelType::uint32:
      return H5T_STD_U32LE;
    case PixelType::int32:
      return H5T_STD_I32LE;
    case PixelType::uint64:
      return H5T_STD_U64LE;
    case PixelType::int64:
      return H5T_STD_I64LE;
    case PixelType::float32:
      return H5T_IEEE_F32LE;
    case PixelType::float64:
      return H5T_IEEE_F64LE;
  }
  return H5I_INVALID_HID;
}

hid_t memory_type_of(PixelType type) {
  switch (type) {
    case PixelType::uint8:
      return H5T_NATIVE_UINT8;
    case PixelType::int8:
      return H5T_NATIVE_INT8;
    case PixelType::uint16:
      return H5T_NATIVE_UINT16;
    case PixelType::int16:
      return H5T_NATIVE_INT16;
    case PixelType::uint32:
      return H5T_NATIVE_UINT32;
    case PixelType::int32:
      return H5T_NATIVE_INT32;
    case PixelType::uint64:
      return H5T_NATIVE_UINT64;
    case PixelType::int64:
      return H5T_NATIVE_INT64;
    case PixelType::float32:
      return H5T_NATIVE_FLOAT;
    case PixelType::float64:
      return H5T_NATIVE_DOUBLE;
  }
  return H5I_INVALID_HID;
}

}  // namespace tetwarp::h5
