/// @file h5_output.cpp
/// Creates or copies, closes and renames.
#include "io/h5/h5_output.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <tetwarp/error.hpp>

namespace tetwarp::h5 {
namespace {
void copy_bytes(const std::string& from, const FinishedFile& to) {
  std::ifstream in(from, std::ios::binary);
  std::ofstream out(to.temporary(), std::ios::binary);
  if (!(out << in.rdbuf()) || !out.flush()) {
    throw IoError(to.path(), "", std::string("cannot be written: ") + std::strerror(errno));
  }
}
}  // namespace

OutputFile::OutputFile(const std::string& path)
    : finished_(path), file_(create_file(path, finished_.temporary(), disk_)) {}

OutputFile::OutputFile(const std::string& path, const std::string& original)
    : finished_(path), file_{path, "", {}} {
  copy_bytes(original, finished_);
  const Handle access = disk_access(&disk_);
  file_.handle =
      Handle(H5Fopen(finished_.temporary().c_str(), H5F_ACC_RDWR, access.id()), H5Fclose);
  if (!file_.handle) file_.fail_with_reason("cannot be opened for writing");
}

void OutputFile::remove(const std::string& name) {
  if (H5Lexists(file_.id(), name.c_str(), H5P_DEFAULT) <= 0) return;
  if (H5Ldelete(file_.id(), name.c_str(), H5P_DEFAULT) < 0) {
    throw IoError(file_.file, "/" + name, "cannot be replaced: " + last_reason());
  }
}

std::int64_t OutputFile::finish() {
  if (!file_.handle.close()) file_.fail_with_reason("cannot be closed");
  disk_.check(file_);
  return finished_.finish();
}

}  // namespace tetwarp::h5
