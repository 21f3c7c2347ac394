# All tests, run by ctest: `ctest -L parity` and so on chooses by label.
find_package(GTest REQUIRED)
include(GoogleTest)

# What several programs share: synthetic inputs, and headers parsed once for all of them.
add_library(tetwarp_scenes STATIC
  tests/scenes/contact_scenes.cpp
  tests/scenes/contact_scenes_slab.cpp
  tests/scenes/contact_transforms.cpp
  tests/scenes/elastic_block.cpp
  tests/scenes/rigid_bodies.cpp
  tests/scenes/scenes.cpp)
target_include_directories(tetwarp_scenes PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(tetwarp_scenes PRIVATE
  tetwarp tetwarp_openmp tetwarp_options Eigen3::Eigen GTest::gtest_main)
target_precompile_headers(tetwarp_scenes PRIVATE
  <gtest/gtest.h> <Eigen/Dense> <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream>
  <functional> <map> <numeric> <optional> <random> <span> <string> <tetwarp/tetwarp.hpp> <vector>)
# As programs are compiled, or they could not use its headers. What tests compute by themselves is
# little: -O3 would take longer to compile than it saves.
set_target_properties(tetwarp_scenes PROPERTIES POSITION_INDEPENDENT_CODE OFF)
set(tetwarp_test_options $<$<AND:$<CONFIG:Release>,$<COMPILE_LANGUAGE:CXX>>:-O1>)
target_compile_options(tetwarp_scenes PRIVATE ${tetwarp_test_options})

# tetwarp_add_tests(PROGRAM [LIBRARIES ...] SOURCES ...)
function(tetwarp_add_tests program)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "LIBRARIES;SOURCES")
  add_executable(${program} ${arg_SOURCES})
  target_include_directories(${program} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${program} PRIVATE tetwarp_scenes
    tetwarp ${arg_LIBRARIES} tetwarp_openmp tetwarp_options Eigen3::Eigen GTest::gtest_main)
  target_compile_options(${program} PRIVATE ${tetwarp_test_options})
  target_precompile_headers(${program} REUSE_FROM tetwarp_scenes)
  set_target_properties(${program} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
endfunction()

# tetwarp_discover(PROGRAM LABEL [FILTER gtest-filter] [PROPERTIES ...])
function(tetwarp_discover program label)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "FILTER" "PROPERTIES")
  gtest_discover_tests(${program} TEST_FILTER "${arg_FILTER}" DISCOVERY_TIMEOUT 120
    NO_PRETTY_TYPES NO_PRETTY_VALUES PROPERTIES LABELS ${label} TIMEOUT 300 ${arg_PROPERTIES})
endfunction()

# ---- stages and whole warps. They reach private code, which a shared library hides ------------
if(NOT BUILD_SHARED_LIBS)
  set(tetwarp_stage_tests
    tests/base/test_exec.cpp
    tests/warp/test_node_quantize.cpp
    tests/warp/test_tet_setup.cpp
    tests/warp/test_corner_mask.cpp
    tests/warp/test_cell_cull.cpp
    tests/warp/test_cell_pairs.cpp
    tests/warp/test_cell_merge.cpp
    tests/warp/test_cell_work.cpp
    tests/warp/test_tet_moved.cpp
    tests/warp/test_volume_prefilter.cpp
    tests/warp/test_volume_range.cpp
    tests/warp/test_volume_uniform.cpp)
  # By nvcc they also run on a device, which takes it a minute: where there is one, or will be.
  set(TETWARP_DEVICE_TESTS AUTO CACHE STRING "stages on a CUDA device: AUTO, ON or OFF")
  set(tetwarp_stage_kind cpp)
  if(TETWARP_HAS_CUDA)
    execute_process(COMMAND nvidia-smi -L RESULT_VARIABLE no_device OUTPUT_QUIET ERROR_QUIET)
    if(TETWARP_DEVICE_TESTS STREQUAL "ON" OR TETWARP_BUNDLE OR
       (TETWARP_DEVICE_TESTS STREQUAL "AUTO" AND "${no_device}" STREQUAL "0"))
      set(tetwarp_stage_kind cu)
    else()
      add_test(NAME stages_on_device COMMAND ${CMAKE_COMMAND} -E echo
        "skipped: no CUDA device answered when the build was configured (TETWARP_DEVICE_TESTS=ON)")
      set_tests_properties(stages_on_device PROPERTIES LABELS unit SKIP_REGULAR_EXPRESSION skipped)
    endif()
  endif()
  # Two units of six files: nvcc parses GoogleTest thrice per unit, for seconds.
  foreach(first 0 6)
    list(SUBLIST tetwarp_stage_tests ${first} 6 unit)
    list(TRANSFORM unit REPLACE "(.+)" "#include \"\\1\"")
    list(JOIN unit "\n" TETWARP_UNIT)
    set(file ${PROJECT_BINARY_DIR}/test_stages_${first}.${tetwarp_stage_kind})
    file(CONFIGURE OUTPUT ${file} CONTENT "@TETWARP_UNIT@\n" @ONLY)
    list(APPEND tetwarp_stage_units ${file})
  endforeach()
  set(tetwarp_stage_tests ${tetwarp_stage_units})
  # Compiled once for two programs; in one of them cuda is emulated. Of loops over the back ends that
  # answer that one is run by ctest, the other is for devices.
  add_library(tetwarp_backend_tests OBJECT
    tests/warp/test_blocks.cpp
    tests/warp/test_parity.cpp
    tests/warp/test_warp_antialias.cpp
    tests/warp/test_warp_fields.cpp
    tests/warp/test_warp_hexahedra.cpp
    tests/warp/test_warp_in_flight.cpp
    tests/warp/test_warp_intensity.cpp
    tests/warp/test_warp_quantities.cpp)
  target_include_directories(tetwarp_backend_tests PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(tetwarp_backend_tests PRIVATE
    tetwarp tetwarp_openmp tetwarp_options Eigen3::Eigen GTest::gtest_main)
  target_compile_options(tetwarp_backend_tests PRIVATE ${tetwarp_test_options})
  target_precompile_headers(tetwarp_backend_tests REUSE_FROM tetwarp_scenes)
  set_target_properties(tetwarp_backend_tests PROPERTIES POSITION_INDEPENDENT_CODE OFF)

  tetwarp_add_tests(tetwarp_tests LIBRARIES nlohmann_json::nlohmann_json SOURCES
    ${tetwarp_stage_tests}
    tests/warp/test_convex_part.cpp
    tests/warp/test_face_sign.cpp
    tests/warp/test_hex_split.cpp
    tests/warp/test_volume_filter.cpp
    tests/warp/test_volume_label.cpp
    tests/warp/test_volume_sample.cpp
    tests/make/test_lattice_mesh.cpp
    tests/make/test_deform_mesh.cpp
    tests/warp/test_output_edges.cpp
    tests/make/test_phantom.cpp
    tests/make/test_render_volume.cpp
    tests/base/test_report.cpp
    tests/warp/test_skip_constant.cpp
    tests/warp/test_skip_far_memory.cpp
    tests/warp/test_source_end.cpp
    tests/warp/test_skip_unchanged.cpp
    tests/warp/test_warp.cpp
    tests/warp/test_warp_arguments.cpp
    tests/warp/test_warp_filters.cpp
    tests/warp/test_warp_invariance.cpp
    tests/warp/test_warp_values.cpp
    tests/warp/test_coverage.cpp
    $<TARGET_OBJECTS:tetwarp_backend_tests>)
  if(TETWARP_HAS_CUDA)
    target_link_libraries(tetwarp_tests PRIVATE CUDA::cudart_static)
  endif()
  tetwarp_discover(tetwarp_tests unit FILTER "-*cuda*:*Cuda*:*Parity*:*Coverage*:WarpAntialias*:WarpIntensity*:WarpQuantities*")
  tetwarp_discover(tetwarp_tests unit FILTER "*cuda*:*Cuda*:-*Parity*:*Coverage*"
    PROPERTIES RESOURCE_LOCK gpu)
  tetwarp_discover(tetwarp_tests parity FILTER "*Parity*" PROPERTIES RESOURCE_LOCK gpu)
  tetwarp_discover(tetwarp_tests reference FILTER "*Coverage*")

  tetwarp_add_tests(tetwarp_stress_tests SOURCES
    tests/warp/test_warp_error.cpp
    tests/warp/test_warp_stress.cpp
    tests/warp/test_warp_stress_data.cpp
    tests/warp/test_warp_stress_grids.cpp
    tests/warp/test_warp_stress_size.cpp)
  tetwarp_discover(tetwarp_stress_tests stress FILTER "-*/cuda")
  tetwarp_discover(tetwarp_stress_tests stress FILTER "*/cuda" PROPERTIES RESOURCE_LOCK gpu)

  tetwarp_add_tests(tetwarp_contact_tests SOURCES
    tests/contact/test_body_relax.cpp
    tests/contact/test_contact.cpp
    tests/contact/test_contact_acceptance.cpp
    tests/contact/test_contact_adhesion.cpp
    tests/contact/test_contact_bad_options.cpp
    tests/contact/test_contact_bound.cpp
    tests/contact/test_contact_color.cpp
    tests/contact/test_contact_coupled.cpp
    tests/contact/test_contact_cuda.cpp
    tests/contact/test_contact_law.cpp
    tests/contact/test_contact_limits.cpp
    tests/contact/test_contact_linear.cpp
    tests/contact/test_contact_associated.cpp
    tests/contact/test_contact_newton.cpp
    tests/contact/test_lorentz_cone.cpp
    tests/contact/test_contact_outer.cpp
    tests/contact/test_contact_problem.cpp
    tests/contact/test_contact_reference.cpp
    tests/contact/test_contact_reference_limits.cpp
    tests/contact/test_contact_report.cpp
    tests/contact/test_contact_residual.cpp
    tests/contact/test_contact_skip.cpp
    tests/contact/test_contact_solver.cpp
    tests/contact/test_contact_sweep.cpp
    tests/contact/test_contact_threads.cpp
    tests/contact/test_contact_tracker.cpp)
  # Four files at a time: what they include and instantiate costs more than they do.
  set_target_properties(tetwarp_contact_tests PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 4)
  tetwarp_discover(tetwarp_contact_tests unit FILTER "-*Cuda*")
  tetwarp_discover(tetwarp_contact_tests unit FILTER "*Cuda*" PROPERTIES RESOURCE_LOCK gpu)

  tetwarp_add_tests(tetwarp_contact_stress_tests SOURCES
    tests/contact/test_contact_stress.cpp
    tests/contact/test_contact_stress_invariance.cpp
    tests/contact/test_contact_stress_stacks.cpp)
  tetwarp_discover(tetwarp_contact_stress_tests stress)

  add_executable(example_contact tests/example_contact.cpp)
  target_include_directories(example_contact PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(example_contact PRIVATE
    tetwarp_scenes tetwarp tetwarp_options Eigen3::Eigen)
  add_test(NAME example_contact COMMAND example_contact)
  set_tests_properties(example_contact PROPERTIES LABELS unit)

  # A program of its own: the emulation defines CUDA's names.
  tetwarp_add_tests(tetwarp_simt_tests SOURCES
    tests/emu/test_affine_simt.cpp
    tests/emu/test_simt.cpp
    tests/emu/test_cell_raster_simt.cpp
    tests/emu/test_contact_simt.cpp)
  tetwarp_discover(tetwarp_simt_tests simt)

  # Back end cuda on an emulated device: whole warps and contacts through the public calls.
  tetwarp_add_tests(tetwarp_emulated_tests SOURCES
    tests/emu/emulated_backend.cpp
    tests/emu/emulated_contact.cpp
    tests/emu/test_contact_emulated.cpp
    tests/contact/test_contact_cuda.cpp
    tests/emu/test_warp_emulated.cpp
    tests/emu/test_warp_emulated_overlap.cpp
    $<TARGET_OBJECTS:tetwarp_backend_tests>)
  tetwarp_discover(tetwarp_emulated_tests simt
    FILTER "*Emulated*:WarpAntialias*:WarpIntensity*:WarpQuantities*:*ContactCuda*:*InFlight*/cuda:*Hexahedra*/cuda:*Blocks*/cuda:*WarpFields*/cuda:*Parity.Owners*:*Parity.Steps*/waved*:*Parity.Filters*/waved*")

  # The parts of the benchmarks that decide: floors, the truth for checks, which times count.
  find_package(fmt REQUIRED)
  tetwarp_add_tests(tetwarp_bench_tests LIBRARIES tetwarp_hwy fmt::fmt SOURCES
    bench/measure/floors.cpp
    bench/measure/timing.cpp
    bench/warp/truth.cpp
    bench/warp/workloads.cpp
    tests/bench/test_bench.cpp)
  tetwarp_discover(tetwarp_bench_tests unit)
endif()

# ---- every public header compiles alone, without CUDA ------------------------------------------
set(tetwarp_public_headers backend blocks choices contact contact_problem contact_tracker error make mesh names page_lock report tetwarp version volume warp)
if(TETWARP_IO)
  list(APPEND tetwarp_public_headers io mesh_import)
endif()
foreach(TETWARP_HEADER IN LISTS tetwarp_public_headers)
  configure_file(tests/base/test_headers.cpp.in test_headers/${TETWARP_HEADER}.cpp @ONLY)
  list(APPEND tetwarp_header_sources ${PROJECT_BINARY_DIR}/test_headers/${TETWARP_HEADER}.cpp)
endforeach()
add_library(tetwarp_header_tests OBJECT ${tetwarp_header_sources})
target_compile_features(tetwarp_header_tests PRIVATE cxx_std_20)
target_include_directories(tetwarp_header_tests PRIVATE host kernels/base io)
target_link_libraries(tetwarp_header_tests PRIVATE tetwarp_options)

if(TETWARP_IO)
  include(cmake/FileTests.cmake)
endif()

# ---- a stranger's project finds and links what was installed ----------------------------------
if(NOT TETWARP_BUNDLE)
  add_test(NAME install COMMAND ${CMAKE_COMMAND}
    -DBUILD=${PROJECT_BINARY_DIR} -DCONFIG=$<CONFIG> -DWITH_IO=${TETWARP_IO}
    -DGENERATOR=${CMAKE_GENERATOR} -DCXX=${CMAKE_CXX_COMPILER} "-DCXX_FLAGS=${CMAKE_CXX_FLAGS}"
    -DCUDA_ROOT=${CUDAToolkit_TARGET_DIR}
    -P ${PROJECT_SOURCE_DIR}/tests/install/run_install_test.cmake)
  set_tests_properties(install PROPERTIES LABELS install TIMEOUT 300)
endif()
