# Benchmarks: tetwarp_bench times warps on all back ends, tetwarp_bench_contact contact solvers,
# tetwarp_bench_simulate steps of bodies, tetwarp_bench_collide collision detection.
find_package(benchmark REQUIRED)
find_package(fmt REQUIRED)
include(cmake/OpenMp.cmake)

# Written into every results file: the commit and the compiler flags that change code.
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
configure_file(bench/measure/build_info.hpp.in bench_info/bench/build_info.hpp @ONLY)

add_executable(tetwarp_bench
  bench/measure/floors.cpp
  bench/measure/program.cpp
  bench/measure/row.cpp
  bench/measure/timing.cpp
  bench/peers/paper_method.cpp
  bench/peers/peer.cpp
  bench/warp/analytic_rows.cpp
  bench/warp/copy_rows.cpp
  bench/warp/features_rows.cpp
  bench/warp/fields_rows.cpp
  bench/warp/figure_cases.cpp
  bench/warp/labels_rows.cpp
  bench/warp/main.cpp
  bench/warp/overlap_rows.cpp
  bench/warp/paper_rows.cpp
  bench/warp/points_rows.cpp
  bench/warp/region_rows.cpp
  bench/warp/resident_rows.cpp
  bench/warp/series_rows.cpp
  bench/warp/step_cases.cpp
  bench/warp/step_rows.cpp
  bench/warp/transform_rows.cpp
  bench/warp/truth.cpp
  bench/warp/warp_job.cpp
  bench/warp/workloads.cpp
  tests/support/scenes.cpp)
if(TETWARP_HAS_CUDA)
  target_sources(tetwarp_bench PRIVATE
    bench/measure/copy_ways.cu bench/measure/device_floors.cu bench/measure/device_memory.cu
    bench/peers/paper_device.cu)
  target_link_libraries(tetwarp_bench PRIVATE CUDA::cudart_static)
else()
  target_sources(tetwarp_bench PRIVATE
    bench/measure/copy_ways_nocuda.cpp bench/measure/device_floors_nocuda.cpp
    bench/measure/device_memory_nocuda.cpp bench/peers/paper_device_nocuda.cpp)
endif()
target_include_directories(tetwarp_bench PRIVATE
  ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/bench_info)
target_link_libraries(tetwarp_bench PRIVATE
  tetwarp tetwarp_hwy tetwarp_openmp tetwarp_options
  benchmark::benchmark Eigen3::Eigen fmt::fmt)

# These reach private code, which a shared library hides.
if(NOT BUILD_SHARED_LIBS)
  add_executable(tetwarp_bench_simulate
    bench/measure/program.cpp
    bench/measure/row.cpp
    bench/measure/timing.cpp
    bench/simulate/error_rows.cpp
    bench/simulate/main.cpp
    bench/simulate/rows.cpp
    bench/simulate/touch_rows.cpp
    tests/simulate/body_measures.cpp
    tests/simulate/body_models.cpp)
  target_include_directories(tetwarp_bench_simulate PRIVATE
    ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/bench_info)
  target_link_libraries(tetwarp_bench_simulate PRIVATE
    tetwarp tetwarp_options benchmark::benchmark Eigen3::Eigen)

  add_executable(tetwarp_step_traffic
    bench/simulate/step_traffic.cpp
    tests/simulate/body_models.cpp)
  target_include_directories(tetwarp_step_traffic PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(tetwarp_step_traffic PRIVATE tetwarp tetwarp_options Eigen3::Eigen)

  add_executable(tetwarp_bench_collide
    bench/collide/main.cpp
    bench/collide/rows.cpp
    bench/collide/sort_and_sweep.cpp
    bench/measure/program.cpp
    bench/measure/row.cpp
    bench/measure/timing.cpp
    tests/collide/collide_scenes.cpp)
  target_include_directories(tetwarp_bench_collide PRIVATE
    ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/bench_info)
  target_link_libraries(tetwarp_bench_collide PRIVATE
    tetwarp tetwarp_options benchmark::benchmark)
endif()

# Rows that read or write files.
if(TETWARP_IO)
  target_sources(tetwarp_bench PRIVATE bench/warp/chunks_rows.cpp)
  target_link_libraries(tetwarp_bench PRIVATE tetwarp_io)

  add_executable(tetwarp_bench_contact
    bench/contact/cases.cpp
    bench/contact/main.cpp
    bench/contact/rows.cpp
    bench/contact/solution_check.cpp
    bench/measure/program.cpp
    bench/measure/row.cpp
    bench/measure/timing.cpp
    tests/support/contact/contact_scenes.cpp
    tests/support/contact/contact_scenes_lattice.cpp
    tests/support/contact/contact_scenes_slab.cpp
    tests/support/contact/contact_scenes_tray.cpp
    tests/support/scenes.cpp)
  target_include_directories(tetwarp_bench_contact PRIVATE
    ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/bench_info)
  target_link_libraries(tetwarp_bench_contact PRIVATE
    tetwarp_io tetwarp_options benchmark::benchmark fmt::fmt)
else()
  target_sources(tetwarp_bench PRIVATE bench/warp/chunks_rows_noio.cpp)
endif()

# tetwarp_bench_peers: times other programs beside tetwarp. Floor and probe use AVX-512 intrinsics.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  find_package(nlohmann_json REQUIRED)
  find_package(VTK 9 QUIET COMPONENTS CommonCore CommonDataModel CommonExecutionModel FiltersCore
    ImagingCore)
  find_package(ITK 5 QUIET COMPONENTS ITKImageGrid)
  set(TETWARP_PEER_VTK false)
  set(TETWARP_PEER_ITK false)
  add_executable(tetwarp_bench_peers
    bench/measure/floors.cpp
    bench/measure/program.cpp
    bench/measure/row.cpp
    bench/measure/timing.cpp
    bench/peers/affine_floor.cpp
    bench/peers/main.cpp
    bench/peers/paper_method.cpp
    bench/peers/peer.cpp
    bench/peers/scanline_probe.cpp
    bench/warp/truth.cpp
    bench/warp/warp_job.cpp
    bench/warp/workloads.cpp
    tests/support/scenes.cpp)
  if(VTK_FOUND)
    set(TETWARP_PEER_VTK true)
    target_sources(tetwarp_bench_peers PRIVATE bench/peers/vtk_locator.cpp)
    target_link_libraries(tetwarp_bench_peers PRIVATE ${VTK_LIBRARIES})
  endif()
  if(ITK_FOUND)
    set(TETWARP_PEER_ITK true)
    target_sources(tetwarp_bench_peers PRIVATE bench/peers/itk_warp.cpp)
    target_include_directories(tetwarp_bench_peers SYSTEM PRIVATE ${ITK_INCLUDE_DIRS})
    target_link_libraries(tetwarp_bench_peers PRIVATE ${ITK_LIBRARIES})
  endif()
  configure_file(bench/peers/found.hpp.in bench_info/bench/found.hpp @ONLY)
  # g++ 12 reports its own AVX-512 intrinsics as uninitialized.
  set_source_files_properties(bench/peers/affine_floor.cpp bench/peers/scanline_probe.cpp
    PROPERTIES COMPILE_OPTIONS "-mavx512f;-mavx512dq;-mavx512vl;-mfma;-Wno-maybe-uninitialized")
  target_include_directories(tetwarp_bench_peers PRIVATE
    ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/bench_info)
  target_link_libraries(tetwarp_bench_peers PRIVATE tetwarp tetwarp_hwy tetwarp_openmp
    tetwarp_options benchmark::benchmark Eigen3::Eigen fmt::fmt nlohmann_json::nlohmann_json)
endif()
if(TETWARP_HAS_SCREENS)
  add_executable(tetwarp_bench_screens bench/view/screen_frames.cpp)
  target_link_libraries(tetwarp_bench_screens PRIVATE tetwarp_view_link tetwarp_options)
endif()
