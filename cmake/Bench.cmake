# tetwarp_bench: the measured rows, one program for all back ends.
find_package(benchmark REQUIRED)
find_package(fmt REQUIRED)

# What results are worth nothing without: the commit and the flags that change code.
execute_process(COMMAND git describe --always --dirty --abbrev=12 --exclude=*
  WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE TETWARP_COMMIT
  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
get_target_property(tetwarp_own_flags tetwarp_options INTERFACE_COMPILE_OPTIONS)
string(REGEX MATCHALL "-(march|ffp-contract)=[a-z0-9-]+" tetwarp_own_flags "${tetwarp_own_flags}")
list(REMOVE_DUPLICATES tetwarp_own_flags)
list(JOIN tetwarp_own_flags " " tetwarp_own_flags)
string(TOUPPER "${CMAKE_BUILD_TYPE}" tetwarp_build_type)
string(STRIP "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${tetwarp_build_type}} ${tetwarp_own_flags}"
  TETWARP_FLAGS)
configure_file(bench/build_info.hpp.in bench_info/bench/build_info.hpp @ONLY)

add_executable(tetwarp_bench
  bench/analytic.cpp
  bench/bench_warp.cpp
  bench/fields.cpp
  bench/floors.cpp
  bench/features.cpp
  bench/labels.cpp
  bench/measure.cpp
  bench/overlap.cpp
  bench/program.cpp
  bench/region.cpp
  bench/series.cpp
  bench/timed_row.cpp
  bench/timing.cpp
  bench/truth.cpp
  bench/warp_cases.cpp
  bench/workloads.cpp
  tests/scenes/scenes.cpp)
if(TETWARP_HAS_CUDA)
  target_sources(tetwarp_bench PRIVATE bench/device_floors.cu)
  target_link_libraries(tetwarp_bench PRIVATE CUDA::cudart_static)
else()
  target_sources(tetwarp_bench PRIVATE bench/device_floors_nocuda.cpp)
endif()
if(TETWARP_IO)
  target_sources(tetwarp_bench PRIVATE bench/chunks.cpp)
  target_link_libraries(tetwarp_bench PRIVATE tetwarp_io)
else()
  target_sources(tetwarp_bench PRIVATE bench/chunks_noio.cpp)
endif()
target_include_directories(tetwarp_bench PRIVATE
  ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/bench_info)
target_link_libraries(tetwarp_bench PRIVATE
  tetwarp tetwarp_hwy tetwarp_openmp tetwarp_options
  benchmark::benchmark Eigen3::Eigen fmt::fmt)

# tetwarp_bench_contact: the contact solver's; it reads recorded problems.
if(TETWARP_IO)
  add_executable(tetwarp_bench_contact
    bench/bench_contact.cpp
    bench/contact_cases.cpp
    bench/contact_judge.cpp
    bench/contact_measure.cpp
    bench/program.cpp
    bench/timed_row.cpp
    bench/timing.cpp
    tests/scenes/contact_scenes.cpp
    tests/scenes/contact_scenes_slab.cpp
    tests/scenes/scenes.cpp)
  target_include_directories(tetwarp_bench_contact PRIVATE
    ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/bench_info)
  target_link_libraries(tetwarp_bench_contact PRIVATE
    tetwarp_io tetwarp_options benchmark::benchmark fmt::fmt)
endif()
