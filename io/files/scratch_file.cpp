/// @file scratch_file.cpp
/// Opens a file and removes it from its folder; reads and writes at offsets.
#include "io/files/scratch_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <tetwarp/error.hpp>

#include "io/files/finished_file.hpp"

namespace tetwarp {

ScratchFile::ScratchFile(const std::string& beside) {
  // Removed from its folder at the end of this function, while it is open.
  const FinishedFile named(beside);
  descriptor_ = open(named.temporary().c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor_ < 0) {
    throw IoError(beside, "",
                  std::string("its temporary file cannot be opened: ") + std::strerror(errno));
  }
}

ScratchFile::~ScratchFile() {
  close(descriptor_);
}

std::string ScratchFile::path() const {
  return "/proc/" + std::to_string(getpid()) + "/fd/" + std::to_string(descriptor_);
}

bool read_at(int descriptor, void* out, std::size_t bytes, std::int64_t offset) {
  auto* to = static_cast<std::byte*>(out);
  while (bytes > 0) {
    const ssize_t got = pread(descriptor, to, bytes, offset);
    if (got < 0 && errno == EINTR) continue;
    if (got == 0) errno = 0;
    if (got <= 0) return false;
    to += got;
    offset += got;
    bytes -= static_cast<std::size_t>(got);
  }
  return true;
}

bool write_at(int descriptor, const void* in, std::size_t bytes, std::int64_t offset) {
  const auto* from = static_cast<const std::byte*>(in);
  while (bytes > 0) {
    const ssize_t put = pwrite(descriptor, from, bytes, offset);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    from += put;
    offset += put;
    bytes -= static_cast<std::size_t>(put);
  }
  return true;
}

}  // namespace tetwarp
