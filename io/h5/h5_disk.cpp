/// @file h5_disk.cpp
/// The functions of the driver, and files that use it.
#include "io/h5/h5_disk.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <new>
#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif

namespace tetwarp::h5 {
namespace {
/// HDF5 accesses the first member only.
struct DiskFile {
  H5FD_t base;
  int descriptor;
  haddr_t allocated;  // end of the address space that HDF5 has allocated
  haddr_t end;        // end of what was written
  Disk* disk;         // null: for reading only
};

DiskFile& disk_file(H5FD_t* file) {
  return *reinterpret_cast<DiskFile*>(file);
}
const DiskFile& disk_file(const H5FD_t* file) {
  return *reinterpret_cast<const DiskFile*>(file);
}

H5FD_t* open_disk(const char* name, unsigned flags, hid_t properties, haddr_t) {
  // Files behind external links come without it: they are read.
  const void* given = H5Pget_driver_info(properties);
  Disk* const disk = given == nullptr ? nullptr : *static_cast<Disk* const*>(given);
  if (disk == nullptr && (flags & H5F_ACC_RDWR) != 0) return nullptr;
  int mode = (flags & H5F_ACC_RDWR) != 0 ? O_RDWR : O_RDONLY;
  if ((flags & H5F_ACC_CREAT) != 0) mode |= O_CREAT;
  if ((flags & H5F_ACC_TRUNC) != 0) mode |= O_TRUNC;
  const int descriptor = open(name, mode | O_CLOEXEC, 0666);
  if (descriptor < 0) return nullptr;
  auto* file = new (std::nothrow) DiskFile{};
  if (file == nullptr) {
    close(descriptor);
    return nullptr;
  }
  file->descriptor = descriptor;
  file->end = static_cast<haddr_t>(std::max<off_t>(0, lseek(descriptor, 0, SEEK_END)));
  file->disk = disk;
  return &file->base;
}

herr_t close_disk(H5FD_t* base) {
  DiskFile& file = disk_file(base);
  if (close(file.descriptor) != 0 && file.disk != nullptr && file.disk->error == 0)
    file.disk->error = errno;
  delete &file;
  return 0;
}

herr_t query_disk(const H5FD_t* file, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_AGGREGATE_SMALLDATA |
           H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  if (file != nullptr && disk_file(file).disk != nullptr) *flags |= H5FD_FEAT_ACCUMULATE_METADATA;
  return 0;
}

haddr_t get_allocated(const H5FD_t* file, H5FD_mem_t) {
  return disk_file(file).allocated;
}

herr_t set_allocated(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  disk_file(file).allocated = end;
  return 0;
}

haddr_t get_end(const H5FD_t* file, H5FD_mem_t) {
  return disk_file(file).end;
}

herr_t read_disk(H5FD_t* base, H5FD_mem_t, hid_t, haddr_t begin, std::size_t bytes, void* out) {
  if (out == nullptr) return -1;
  auto* to = static_cast<char*>(out);
  while (bytes > 0) {
    const ssize_t got = pread(disk_file(base).descriptor, to, bytes, static_cast<off_t>(begin));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return -1;
    if (got == 0) break;
    to += got;
    begin += static_cast<haddr_t>(got);
    bytes -= static_cast<std::size_t>(got);
  }
  std::memset(to, 0, bytes);  // HDF5 may read what it has allocated but not yet written
  return 0;
}

herr_t write_disk(
    H5FD_t* base, H5FD_mem_t, hid_t, haddr_t begin, std::size_t bytes, const void* in) {
  DiskFile& file = disk_file(base);
  if (file.disk == nullptr) return -1;
  const auto* from = static_cast<const char*>(in);
  file.end = std::max(file.end, begin + bytes);
  while (bytes > 0 && file.disk->error == 0) {
    const ssize_t put = pwrite(file.descriptor, from, bytes, static_cast<off_t>(begin));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) {
      file.disk->error = errno;
      break;
    }
    from += put;
    begin += static_cast<haddr_t>(put);
    bytes -= static_cast<std::size_t>(put);
  }
  return 0;
}

herr_t truncate_disk(H5FD_t* base, hid_t, hbool_t) {
  DiskFile& file = disk_file(base);
  if (file.disk == nullptr || file.end == file.allocated) return 0;
  if (file.disk->error == 0 &&
      ftruncate(file.descriptor, static_cast<off_t>(file.allocated)) != 0) {
    file.disk->error = errno;
  }
  file.end = file.allocated;
  return 0;
}

H5FD_class_t disk_class() {
  constexpr H5FD_mem_t free_lists[] = H5FD_FLMAP_DICHOTOMY;
  H5FD_class_t driver{};
#if H5_VERSION_GE(1, 13, 0)
  driver.version = H5FD_CLASS_VERSION;
  driver.value = H5_VFD_RESERVED;  // the first one that is not the library's own
#endif
  driver.name = "tetwarp_disk";
  driver.maxaddr = static_cast<haddr_t>(-1) >> 2;
  driver.fc_degree = H5F_CLOSE_WEAK;
  driver.fapl_size = sizeof(void*);  // of the Disk
  driver.open = open_disk;
  driver.close = close_disk;
  driver.query = query_disk;
  driver.get_eoa = get_allocated;
  driver.set_eoa = set_allocated;
  driver.get_eof = get_end;
  driver.read = read_disk;
  driver.write = write_disk;
  driver.truncate = truncate_disk;
  std::copy(std::begin(free_lists), std::end(free_lists), driver.fl_map);
  return driver;
}
/// Stays registered: with the last file of a driver HDF5 1.10 frees the driver's class before it
/// calls the class's function that closes the file.
hid_t disk_driver() {
  static const H5FD_class_t driver_class = disk_class();  // HDF5 keeps pointers to its strings
  static hid_t driver = H5I_INVALID_HID;
  if (driver < 0 || H5Iget_type(driver) != H5I_VFL) driver = H5FDregister(&driver_class);
  return driver;
}
}  // namespace

void Disk::check(const Object& object) const {
  if (error != 0) object.fail(std::string("cannot be written: ") + std::strerror(error));
}

Handle disk_access(Disk* disk) {
  const hid_t driver = disk_driver();
  Handle properties(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (driver < 0 || H5Pset_driver(properties.id(), driver, &disk) < 0) return {};
  return properties;
}

Object create_file(const std::string& path, const std::string& temporary, Disk& disk) {
  Object file{path, "", {}};
  const Handle access = disk_access(&disk);
  file.handle =
      Handle(H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose);
  if (!file.handle) file.fail_with_reason("cannot be created");
  return file;
}

}  // namespace tetwarp::h5
