# All dependencies are packages of the distribution or the CUDA toolkit; nothing is downloaded.
# The apt names are in ./dev.

# ---- CUDA: language and toolkit, or neither -----------------------------------
set(TETWARP_HAS_CUDA FALSE)
if(NOT TETWARP_CUDA STREQUAL "OFF")
  if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
    set(CMAKE_CUDA_ARCHITECTURES "75-real;80-real;90-real;120-real;90-virtual" CACHE STRING "CUDA targets")
  endif()
  include(CheckLanguage)
  find_package(CUDAToolkit 12.0 QUIET)
  if(CUDAToolkit_FOUND AND NOT CMAKE_CUDA_COMPILER AND NOT DEFINED ENV{CUDACXX} AND CUDAToolkit_NVCC_EXECUTABLE)
    set(CMAKE_CUDA_COMPILER "${CUDAToolkit_NVCC_EXECUTABLE}" CACHE FILEPATH "")  # toolkit not on PATH
  endif()
  check_language(CUDA)
  if(CMAKE_CUDA_COMPILER AND CUDAToolkit_FOUND)
    enable_language(CUDA)
    if(CMAKE_VERSION VERSION_LESS 3.26)  # which lacks nvcc's option for C++20
      set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION "-std=c++20")
      set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION "-std=c++20")
    endif()
    set(TETWARP_HAS_CUDA TRUE)
  elseif(TETWARP_CUDA STREQUAL "ON")
    message(FATAL_ERROR "TETWARP_CUDA=ON, but no CUDA compiler and toolkit >= 12.0 were found; "
      "install the CUDA toolkit or set TETWARP_CUDA=OFF")
  endif()
endif()
message(STATUS "tetwarp: CUDA back end: ${TETWARP_HAS_CUDA}")

# ---- compiler flags of all files of the project; not exported -------------------
# No contraction: results must not depend on the processor that runs them.
# g++ 12 reports false overlaps inside std::string (-Wrestrict).
# x86-64-v2 (2009) is the minimum for Highway's narrowest vectors; wider ones are chosen at run time.
add_library(tetwarp_options INTERFACE)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_options(tetwarp_options INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-march=x86-64-v2>)
endif()
target_compile_options(tetwarp_options INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall;-Wextra;-Wconversion;-ffp-contract=off>
  $<$<AND:$<COMPILE_LANG_AND_ID:CXX,GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>
  $<$<COMPILE_LANGUAGE:CUDA>:-Xcompiler=-Wall,-Wextra,-ffp-contract=off;$<$<BOOL:${TETWARP_STRICT_FP}>:-fmad=false;-DTETWARP_STRICT_FP>>)
# g++ collects its garbage less often: a tenth less time to compile for a quarter more memory.
target_compile_options(tetwarp_options INTERFACE
  $<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=1048576>)
# Eigen would split products by the number of OpenMP threads, so that bits would depend on it;
# for matrices of a few hundred rows on a busy machine this was also 100 times slower.
target_compile_definitions(tetwarp_options INTERFACE EIGEN_DONT_PARALLELIZE)

find_package(Eigen3 3.3 REQUIRED NO_MODULE)
find_package(nlohmann_json 3.2 REQUIRED)

# ---- one target per library, installed as plain paths, so that users need no find modules for them
function(tetwarp_wrap name)  # tetwarp_wrap(NAME build-time targets... INSTALLED installed libraries...)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "INSTALLED")
  add_library(${name} INTERFACE)
  foreach(item IN LISTS arg_UNPARSED_ARGUMENTS)
    target_link_libraries(${name} INTERFACE $<BUILD_INTERFACE:${item}>)
  endforeach()
  target_link_libraries(${name} INTERFACE "$<INSTALL_INTERFACE:${arg_INSTALLED}>")
endfunction()

set(THREADS_PREFER_PTHREAD_FLAG OFF)
find_package(Threads REQUIRED)
tetwarp_wrap(tetwarp_threads Threads::Threads INSTALLED ${CMAKE_THREAD_LIBS_INIT})

find_path(TETWARP_HWY_INCLUDE hwy/highway.h REQUIRED)
find_library(TETWARP_HWY_LIBRARY hwy REQUIRED)
tetwarp_wrap(tetwarp_hwy ${TETWARP_HWY_LIBRARY} INSTALLED ${TETWARP_HWY_LIBRARY})
target_include_directories(tetwarp_hwy SYSTEM INTERFACE $<BUILD_INTERFACE:${TETWARP_HWY_INCLUDE}>)

if(TETWARP_IO)
  find_package(CLI11 REQUIRED)
  find_package(fmt REQUIRED)
  set(HDF5_PREFER_PARALLEL OFF)
  if(TETWARP_BUNDLE)
    include(cmake/StaticHdf5.cmake)
  else()
    find_package(HDF5 REQUIRED COMPONENTS C)
    tetwarp_wrap(tetwarp_hdf5 hdf5::hdf5 INSTALLED ${HDF5_C_LIBRARIES})
  endif()
  set(TETWARP_HAS_MPI FALSE)
  if(NOT TETWARP_MPI STREQUAL "OFF" AND NOT TETWARP_BUNDLE)
    set(MPI_CXX_SKIP_MPICXX TRUE)
    if(TETWARP_MPI STREQUAL "ON")
      find_package(MPI REQUIRED COMPONENTS CXX)
    else()
      # FindMPI stops the configuration where the run-time package is installed without headers.
      find_path(TETWARP_MPI_HEADER mpi.h PATH_SUFFIXES openmpi/include openmpi mpich mpi
        PATHS /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE} /usr/include/${CMAKE_LIBRARY_ARCHITECTURE})
      if(TETWARP_MPI_HEADER)
        find_package(MPI QUIET COMPONENTS CXX)
      endif()
    endif()
    set(TETWARP_HAS_MPI ${MPI_CXX_FOUND})
  endif()
  message(STATUS "tetwarp: ranks of mpirun: ${TETWARP_HAS_MPI}")
  find_package(PNG REQUIRED)
  tetwarp_wrap(tetwarp_png PNG::PNG INSTALLED ${PNG_LIBRARIES})
  set(TETWARP_HAS_GIF FALSE)
  add_library(tetwarp_gif INTERFACE)
  if(NOT TETWARP_GIF STREQUAL "OFF" AND NOT TETWARP_BUNDLE)
    find_package(GIF 5.1 QUIET)
    set(TETWARP_HAS_GIF ${GIF_FOUND})
    if(TETWARP_GIF STREQUAL "ON" AND NOT GIF_FOUND)
      message(FATAL_ERROR "TETWARP_GIF=ON, but giflib 5.1 was not found; install libgif-dev")
    endif()
  endif()
  if(TETWARP_HAS_GIF)
    target_include_directories(tetwarp_gif SYSTEM INTERFACE $<BUILD_INTERFACE:${GIF_INCLUDE_DIRS}>)
    target_link_libraries(tetwarp_gif INTERFACE ${GIF_LIBRARIES})
  endif()
  message(STATUS "tetwarp: films: ${TETWARP_HAS_GIF}")
  find_path(TETWARP_NIFTI_INCLUDE nifti1_io.h PATH_SUFFIXES nifti REQUIRED)
  find_library(TETWARP_NIFTI_LIBRARY niftiio REQUIRED)
  find_library(TETWARP_ZNZ_LIBRARY znz REQUIRED)
  tetwarp_wrap(tetwarp_nifti ${TETWARP_NIFTI_LIBRARY} ${TETWARP_ZNZ_LIBRARY}
    INSTALLED ${TETWARP_NIFTI_LIBRARY} ${TETWARP_ZNZ_LIBRARY})
  target_include_directories(tetwarp_nifti SYSTEM INTERFACE $<BUILD_INTERFACE:${TETWARP_NIFTI_INCLUDE}>)
endif()
