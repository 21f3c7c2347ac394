# tetwarp_hdf5 from static archives: only the object files in use are linked, so that the programs
# do not need libcurl and OpenSSL as the shared libhdf5 does.
find_path(TETWARP_HDF5_INCLUDE hdf5.h PATH_SUFFIXES hdf5/serial REQUIRED)
find_library(TETWARP_HDF5_ARCHIVE NAMES libhdf5_serial.a libhdf5.a PATH_SUFFIXES hdf5/serial REQUIRED)
find_library(TETWARP_SZ_ARCHIVE libsz.a REQUIRED)
find_library(TETWARP_AEC_ARCHIVE libaec.a REQUIRED)
find_library(TETWARP_Z_ARCHIVE libz.a REQUIRED)
set(tetwarp_hdf5_archives ${TETWARP_HDF5_ARCHIVE} ${TETWARP_SZ_ARCHIVE} ${TETWARP_AEC_ARCHIVE}
  ${TETWARP_Z_ARCHIVE} m ${CMAKE_DL_LIBS} pthread)
tetwarp_wrap(tetwarp_hdf5 ${tetwarp_hdf5_archives} INSTALLED ${tetwarp_hdf5_archives})
target_include_directories(tetwarp_hdf5 SYSTEM INTERFACE $<BUILD_INTERFACE:${TETWARP_HDF5_INCLUDE}>)
