# All tests, run by ctest: `ctest -L parity` and so on chooses by label.
find_package(GTest REQUIRED)
include(GoogleTest)

# What several programs share: synthetic inputs, and headers parsed once for all of them.
add_library(tetwarp_scenes STATIC
  tests/contact_scenes.cpp
  tests/contact_scenes_slab.cpp
  tests/contact_transforms.cpp
  tests/elastic_block.cpp
  tests/rigid_bodies.cpp
  tests/scenes.cpp)
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
    tests/test_exec.cpp
    tests/test_node_quantize.cpp
    tests/test_tet_setup.cpp
    tests/test_corner_mask.cpp
    tests/test_cell_cull.cpp
    tests/test_cell_pairs.cpp
    tests/test_cell_merge.cpp
    tests/test_cell_work.cpp
    tests/test_tet_moved.cpp
    tests/test_volume_prefilter.cpp
    tests/test_volume_range.cpp
    tests/test_volume_uniform.cpp)
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
    tests/test_blocks.cpp
    tests/test_parity.cpp
    tests/test_warp_antialias.cpp
    tests/test_warp_fields.cpp
    tests/test_warp_hexahedra.cpp
    tests/test_warp_in_flight.cpp
    tests/test_warp_intensity.cpp
    tests/test_warp_quantities.cpp)
  target_include_directories(tetwarp_backend_tests PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(tetwarp_backend_tests PRIVATE
    tetwarp tetwarp_openmp tetwarp_options Eigen3::Eigen GTest::gtest_main)
  target_compile_options(tetwarp_backend_tests PRIVATE ${tetwarp_test_options})
  target_precompile_headers(tetwarp_backend_tests REUSE_FROM tetwarp_scenes)
  set_target_properties(tetwarp_backend_tests PROPERTIES POSITION_INDEPENDENT_CODE OFF)

  tetwarp_add_tests(tetwarp_tests LIBRARIES nlohmann_json::nlohmann_json SOURCES
    ${tetwarp_stage_tests}
    tests/test_convex_part.cpp
    tests/test_face_sign.cpp
    tests/test_hex_split.cpp
    tests/test_volume_filter.cpp
    tests/test_volume_label.cpp
    tests/test_volume_sample.cpp
    tests/test_lattice_mesh.cpp
    tests/test_deform_mesh.cpp
    tests/test_output_edges.cpp
    tests/test_phantom.cpp
    tests/test_render_volume.cpp
    tests/test_report.cpp
    tests/test_skip_constant.cpp
    tests/test_skip_far_memory.cpp
    tests/test_source_end.cpp
    tests/test_skip_unchanged.cpp
    tests/test_warp.cpp
    tests/test_warp_arguments.cpp
    tests/test_warp_filters.cpp
    tests/test_warp_invariance.cpp
    tests/test_warp_values.cpp
    tests/test_coverage.cpp
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
    tests/test_warp_error.cpp
    tests/test_warp_stress.cpp
    tests/test_warp_stress_data.cpp
    tests/test_warp_stress_grids.cpp
    tests/test_warp_stress_size.cpp)
  tetwarp_discover(tetwarp_stress_tests stress FILTER "-*/cuda")
  tetwarp_discover(tetwarp_stress_tests stress FILTER "*/cuda" PROPERTIES RESOURCE_LOCK gpu)

  tetwarp_add_tests(tetwarp_contact_tests SOURCES
    tests/test_body_relax.cpp
    tests/test_contact.cpp
    tests/test_contact_acceptance.cpp
    tests/test_contact_adhesion.cpp
    tests/test_contact_bad_options.cpp
    tests/test_contact_bound.cpp
    tests/test_contact_color.cpp
    tests/test_contact_coupled.cpp
    tests/test_contact_cuda.cpp
    tests/test_contact_law.cpp
    tests/test_contact_limits.cpp
    tests/test_contact_linear.cpp
    tests/test_contact_associated.cpp
    tests/test_contact_newton.cpp
    tests/test_lorentz_cone.cpp
    tests/test_contact_outer.cpp
    tests/test_contact_problem.cpp
    tests/test_contact_reference.cpp
    tests/test_contact_reference_limits.cpp
    tests/test_contact_report.cpp
    tests/test_contact_residual.cpp
    tests/test_contact_skip.cpp
    tests/test_contact_solver.cpp
    tests/test_contact_sweep.cpp
    tests/test_contact_threads.cpp
    tests/test_contact_tracker.cpp)
  # Four files at a time: what they include and instantiate costs more than they do.
  set_target_properties(tetwarp_contact_tests PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 4)
  tetwarp_discover(tetwarp_contact_tests unit FILTER "-*Cuda*")
  tetwarp_discover(tetwarp_contact_tests unit FILTER "*Cuda*" PROPERTIES RESOURCE_LOCK gpu)

  tetwarp_add_tests(tetwarp_contact_stress_tests SOURCES
    tests/test_contact_stress.cpp
    tests/test_contact_stress_invariance.cpp
    tests/test_contact_stress_stacks.cpp)
  tetwarp_discover(tetwarp_contact_stress_tests stress)

  add_executable(example_contact tests/example_contact.cpp)
  target_include_directories(example_contact PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(example_contact PRIVATE
    tetwarp_scenes tetwarp tetwarp_options Eigen3::Eigen)
  add_test(NAME example_contact COMMAND example_contact)
  set_tests_properties(example_contact PROPERTIES LABELS unit)

  # A program of its own: the emulation defines CUDA's names.
  tetwarp_add_tests(tetwarp_simt_tests SOURCES
    tests/test_affine_simt.cpp
    tests/test_simt.cpp
    tests/test_cell_raster_simt.cpp
    tests/test_contact_simt.cpp)
  tetwarp_discover(tetwarp_simt_tests simt)

  # Back end cuda on an emulated device: whole warps and contacts through the public calls.
  tetwarp_add_tests(tetwarp_emulated_tests SOURCES
    tests/emulated_backend.cpp
    tests/emulated_contact.cpp
    tests/test_contact_emulated.cpp
    tests/test_contact_cuda.cpp
    tests/test_warp_emulated.cpp
    tests/test_warp_emulated_overlap.cpp
    $<TARGET_OBJECTS:tetwarp_backend_tests>)
  tetwarp_discover(tetwarp_emulated_tests simt
    FILTER "*Emulated*:WarpAntialias*:WarpIntensity*:WarpQuantities*:*ContactCuda*:*InFlight*/cuda:*Hexahedra*/cuda:*Blocks*/cuda:*WarpFields*/cuda:*Parity.Owners*:*Parity.Steps*/waved*:*Parity.Filters*/waved*")

  # What benchmarks rest on: floors, the truth they check against, the judgement of times.
  find_package(fmt REQUIRED)
  tetwarp_add_tests(tetwarp_bench_tests LIBRARIES tetwarp_hwy fmt::fmt SOURCES
    bench/floors.cpp
    bench/timing.cpp
    bench/truth.cpp
    bench/workloads.cpp
    tests/test_bench.cpp)
  tetwarp_discover(tetwarp_bench_tests unit)
endif()

# ---- every public header compiles alone, without CUDA ------------------------------------------
set(tetwarp_public_headers backend blocks contact contact_problem contact_tracker error make mesh page_lock report tetwarp version volume warp)
if(TETWARP_IO)
  list(APPEND tetwarp_public_headers io mesh_import)
endif()
foreach(TETWARP_HEADER IN LISTS tetwarp_public_headers)
  configure_file(tests/test_headers.cpp.in test_headers/${TETWARP_HEADER}.cpp @ONLY)
  list(APPEND tetwarp_header_sources ${PROJECT_BINARY_DIR}/test_headers/${TETWARP_HEADER}.cpp)
endforeach()
add_library(tetwarp_header_tests OBJECT ${tetwarp_header_sources})
target_compile_features(tetwarp_header_tests PRIVATE cxx_std_20)
target_include_directories(tetwarp_header_tests PRIVATE host io)
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
