# All tests, run by ctest: `ctest -L parity` and so on chooses by label. All tests of a program have one:
#   unit       functions, stages, whole warps and contact problems
#   reference  coverage and values against back end reference
#   parity     back end cuda, emulated or on a device, against cpu
#   simt       kernels on the emulated device
#   io, cli    files, the command
#   docs       commands, code and links of the documentation
#   install    the examples, built with an installed tree
#   long       inputs at the limits, large volumes: left out by `./dev test`, run by `./dev check`
find_package(GTest REQUIRED)
include(GoogleTest)
include(cmake/OpenMp.cmake)

# Shared by several programs: synthetic inputs, oracles, and precompiled headers.
add_library(tetwarp_support STATIC
  tests/oracles/exact_sign.cpp
  tests/oracles/intersecting_triangles.cpp
  tests/oracles/interval_ccd.cpp
  tests/oracles/triangle_intersection.cpp
  tests/support/contact/contact_samples.cpp
  tests/support/contact/contact_scenes.cpp
  tests/support/contact/contact_scenes_lattice.cpp
  tests/support/contact/contact_scenes_slab.cpp
  tests/support/contact/contact_scenes_tray.cpp
  tests/support/contact/contact_transforms.cpp
  tests/support/elastic_block.cpp
  tests/support/rigid_bodies.cpp
  tests/support/scenes.cpp)
target_precompile_headers(tetwarp_support PRIVATE
  <gtest/gtest.h> <Eigen/Dense> <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream>
  <functional> <map> <numeric> <optional> <random> <span> <string> <tetwarp/tetwarp.hpp> <vector>)

# Compile options of all programs. Tests compute little themselves: -O3 would take longer to compile
# than it saves.
function(tetwarp_test_target target)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}
    $<$<COMPILE_LANGUAGE:CXX>:${PROJECT_SOURCE_DIR}/tests/emulator/include>)
  target_link_libraries(${target} PRIVATE
    tetwarp ${ARGN} tetwarp_openmp tetwarp_options Eigen3::Eigen GTest::gtest_main)
  target_compile_options(${target} PRIVATE
    $<$<AND:$<CONFIG:Release>,$<COMPILE_LANGUAGE:CXX>>:-O1>)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  if(NOT target STREQUAL tetwarp_support)
    target_precompile_headers(${target} REUSE_FROM tetwarp_support)
  endif()
endfunction()
tetwarp_test_target(tetwarp_support)

# tetwarp_add_tests(PROGRAM [UNITY count] [LIBRARIES ...] SOURCES ...)
# UNITY: number of files per unit, which share the parsing and instantiation of headers.
function(tetwarp_add_tests program)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "UNITY" "LIBRARIES;SOURCES")
  add_executable(${program} ${arg_SOURCES})
  tetwarp_test_target(${program} tetwarp_support ${arg_LIBRARIES})
  if(arg_UNITY)
    set_target_properties(${program} PROPERTIES
      UNITY_BUILD ${TETWARP_UNITY} UNITY_BUILD_BATCH_SIZE ${arg_UNITY})
  endif()
endfunction()

# tetwarp_discover(PROGRAM LABEL): all tests of a program carry the same label, except those of suites
# named Long..., which have that label. Where they run on a device, those named after back end cuda
# run one at a time.
function(tetwarp_discover program label)
  set(options DISCOVERY_TIMEOUT 120 NO_PRETTY_TYPES NO_PRETTY_VALUES PROPERTIES TIMEOUT 300 LABELS)
  gtest_discover_tests(${program} TEST_FILTER "Long*" ${options} long)
  if(tetwarp_device_tests)
    gtest_discover_tests(${program} TEST_FILTER "-Long*:*/cuda*:*_cuda" ${options} ${label})
    gtest_discover_tests(${program} TEST_FILTER "*/cuda*:*_cuda:-Long*" ${options} ${label}
      RESOURCE_LOCK gpu)
  else()
    gtest_discover_tests(${program} TEST_FILTER "-Long*" ${options} ${label})
  endif()
endfunction()

# ---- stages and whole warps. They reach private code, which a shared library hides ------------
if(NOT BUILD_SHARED_LIBS)
  # With nvcc the tests of stages are also compiled for a device, which takes a minute.
  set(TETWARP_DEVICE_TESTS AUTO CACHE STRING "tests on a CUDA device: AUTO, ON or OFF")
  set(tetwarp_device_tests OFF)
  if(TETWARP_HAS_CUDA)
    execute_process(COMMAND nvidia-smi -L RESULT_VARIABLE no_device OUTPUT_QUIET ERROR_QUIET)
    if(TETWARP_DEVICE_TESTS STREQUAL "ON" OR TETWARP_BUNDLE OR
       (TETWARP_DEVICE_TESTS STREQUAL "AUTO" AND "${no_device}" STREQUAL "0"))
      set(tetwarp_device_tests ON)
    else()
      add_test(NAME tests_on_device COMMAND ${CMAKE_COMMAND} -E echo
        "skipped: no usable CUDA device when the build was configured (TETWARP_DEVICE_TESTS=ON)")
      set_tests_properties(tests_on_device PROPERTIES LABELS parity SKIP_REGULAR_EXPRESSION skipped)
    endif()
  endif()
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
  if(TETWARP_UNITY OR tetwarp_device_tests)
    # Units of six files: nvcc parses GoogleTest three times per unit, which takes seconds.
    list(LENGTH tetwarp_stage_tests count)
    math(EXPR last "${count} - 1")
    foreach(first RANGE 0 ${last} 6)
      list(SUBLIST tetwarp_stage_tests ${first} 6 unit)
      list(TRANSFORM unit REPLACE "(.+)" "#include \"\\1\"")
      list(JOIN unit "\n" TETWARP_UNIT)
      set(file ${PROJECT_BINARY_DIR}/test_stages_${first}.cpp)
      if(tetwarp_device_tests)
        set(file ${PROJECT_BINARY_DIR}/test_stages_${first}.cu)
      endif()
      file(CONFIGURE OUTPUT ${file} CONTENT "@TETWARP_UNIT@\n" @ONLY)
      list(APPEND tetwarp_stage_units ${file})
    endforeach()
  else()
    set(tetwarp_stage_units ${tetwarp_stage_tests})
  endif()
  set_source_files_properties(${tetwarp_stage_units} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)

  tetwarp_add_tests(tetwarp_tests UNITY 8 LIBRARIES nlohmann_json::nlohmann_json SOURCES
    ${tetwarp_stage_units}
    tests/base/test_parallel.cpp
    tests/base/test_repeated_cells.cpp
    tests/base/test_report.cpp
    tests/base/test_staging.cpp
    tests/make/test_deform_mesh.cpp
    tests/make/test_lattice_mesh.cpp
    tests/make/test_phantom.cpp
    tests/make/test_render_surfaces.cpp
    tests/make/test_render_volume.cpp
    tests/warp/test_backend_choice.cpp
    tests/warp/test_convex_part.cpp
    tests/warp/test_curve_map.cpp
    tests/warp/test_face_neighbors.cpp
    tests/warp/test_facet_parts.cpp
    tests/warp/test_source_shares.cpp
    tests/warp/test_voxel_bodies.cpp
    tests/warp/test_face_sign.cpp
    tests/warp/test_field_inverse.cpp
    tests/warp/test_hex_split.cpp
    tests/warp/test_output_edges.cpp
    tests/warp/test_resample.cpp
    tests/warp/test_row_vectors.cpp
    tests/warp/test_skip_constant.cpp
    tests/warp/test_skip_unchanged.cpp
    tests/warp/test_source_end.cpp
    tests/warp/test_volume_filter.cpp
    tests/warp/test_volume_label.cpp
    tests/warp/test_volume_sample.cpp
    tests/warp/test_warp.cpp
    tests/warp/test_warp_arguments.cpp
    tests/warp/test_warp_filters.cpp
    tests/warp/test_warp_invariance.cpp
    tests/make/test_cast_volumes.cpp
    tests/warp/test_resample_blocks.cpp)
  target_link_libraries(tetwarp_tests PRIVATE tetwarp_hwy)
  if(TETWARP_HAS_CUDA)
    target_link_libraries(tetwarp_tests PRIVATE CUDA::cudart_static)
  endif()
  tetwarp_discover(tetwarp_tests unit)

  tetwarp_add_tests(tetwarp_reference_tests UNITY 8 SOURCES
    tests/warp/test_conservative_operator.cpp
    tests/warp/test_coverage.cpp
    tests/warp/test_warp_operator.cpp
    tests/warp/test_warp_values.cpp)
  tetwarp_discover(tetwarp_reference_tests reference)

  if(TETWARP_LONG_TESTS)
    tetwarp_add_tests(tetwarp_stress_tests SOURCES
      tests/warp/test_warp_error.cpp
      tests/warp/test_warp_stress.cpp
      tests/warp/test_warp_stress_data.cpp
      tests/warp/test_warp_stress_grids.cpp
      tests/warp/test_warp_stress_size.cpp)
    tetwarp_discover(tetwarp_stress_tests long)
    tetwarp_add_tests(tetwarp_contact_stress_tests SOURCES
      tests/contact/test_contact_stress.cpp
      tests/contact/test_contact_stress_choice.cpp
      tests/contact/test_contact_stress_invariance.cpp
      tests/contact/test_contact_stress_stacks.cpp
      tests/contact/test_contact_stress_truth.cpp)
    tetwarp_discover(tetwarp_contact_stress_tests long)
  endif()

  # Those that include kernels are last, so that a change of a kernel
  # recompiles few units.
  tetwarp_add_tests(tetwarp_contact_tests UNITY 8 LIBRARIES nlohmann_json::nlohmann_json SOURCES
    tests/contact/test_contact_acceptance.cpp
    tests/contact/test_contact_associated.cpp tests/contact/test_contact_pivoting.cpp
    tests/contact/test_contact_bad_options.cpp tests/contact/test_contact_budget.cpp
    tests/contact/test_contact_truth.cpp
    tests/contact/test_contact_coupled.cpp
    tests/contact/test_contact_limits.cpp
    tests/contact/test_contact_moving.cpp
    tests/contact/test_contact_newton.cpp
    tests/contact/test_contact_reference.cpp
    tests/contact/test_contact_tracker_misuse.cpp
    tests/contact/test_contact_threads.cpp
    tests/contact/test_contact.cpp
    tests/contact/test_contact_reference_limits.cpp
    tests/contact/test_contact_tracker.cpp
    tests/contact/test_contact_tracker_threads.cpp
    tests/contact/test_contact_report.cpp
    tests/contact/test_body_relax.cpp
    tests/contact/test_contact_adhesion.cpp
    tests/contact/test_lorentz_cone.cpp
    tests/contact/test_contact_bound.cpp
    tests/contact/test_contact_choice.cpp
    tests/contact/test_contact_color.cpp
    tests/contact/test_contact_law.cpp
    tests/contact/test_contact_linear.cpp
    tests/contact/test_contact_outer.cpp
    tests/contact/test_contact_problem.cpp
    tests/contact/test_contact_residual.cpp
    tests/contact/test_contact_skip.cpp
    tests/contact/test_contact_solver.cpp
    tests/contact/test_contact_sweep.cpp
    tests/contact/test_contact_analysis.cpp tests/contact/test_contact_bilateral.cpp
    tests/contact/test_contact_ellipse.cpp tests/contact/test_contact_rolling.cpp
    tests/contact/test_coupled_iteration.cpp tests/contact/test_contact_multipliers.cpp)
  tetwarp_discover(tetwarp_contact_tests unit)

  # A separate program, because the emulation defines CUDA's names.
  tetwarp_add_tests(tetwarp_simt_tests UNITY 5 SOURCES
    tests/emulated/test_affine_simt.cpp tests/emulated/test_anderson_simt.cpp
    tests/emulated/test_cell_group_simt.cpp tests/emulated/test_cell_raster_simt.cpp
    tests/emulated/test_contact_grid_simt.cpp tests/emulated/test_contact_simt.cpp
    tests/emulated/test_each_shape.cpp tests/emulated/test_grouped_scan_simt.cpp
    tests/emulated/test_island_team_simt.cpp tests/emulated/test_simt.cpp)
  tetwarp_discover(tetwarp_simt_tests simt)

  # The thread sanitizer finds races of kernels on the emulated device.
  include(CheckCXXSourceRuns)
  set(CMAKE_REQUIRED_FLAGS -fsanitize=thread)
  check_cxx_source_runs("#include <sanitizer/tsan_interface.h>
    int main() { __tsan_destroy_fiber(__tsan_create_fiber(0)); }" TETWARP_HAS_THREAD_SANITIZER)
  unset(CMAKE_REQUIRED_FLAGS)
  if(TETWARP_HAS_THREAD_SANITIZER)
    tetwarp_add_tests(tetwarp_race_tests SOURCES tests/emulated/test_races_simt.cpp)
    target_compile_options(tetwarp_race_tests PRIVATE -fsanitize=thread)
    target_link_options(tetwarp_race_tests PRIVATE -fsanitize=thread)
    set_target_properties(tetwarp_race_tests PROPERTIES
      DISABLE_PRECOMPILE_HEADERS ON POSITION_INDEPENDENT_CODE ON)
    tetwarp_discover(tetwarp_race_tests simt)
  endif()

  # Kernels whose basic blocks and accesses are counted (tests/emulator/launch_counter.hpp), compiled
  # to the instructions that have most in common with a device's.
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    find_package(fmt REQUIRED)
    add_library(tetwarp_counted INTERFACE)  # linked last: its options come after all others
    target_compile_options(tetwarp_counted INTERFACE -O3 -g1 -march=x86-64-v3 -ffp-contract=fast
      --param=max-completely-peeled-insns=1000 -fno-tree-vectorize -fno-tree-slp-vectorize
      -fsanitize-coverage=trace-pc -fsanitize=kernel-address -U__SANITIZE_ADDRESS__
      --param=asan-instrumentation-with-call-threshold=0 --param=asan-stack=0
      --param=asan-globals=0)
    target_link_options(tetwarp_counted INTERFACE -no-pie)
    add_library(tetwarp_launch_counter OBJECT tests/emulator/launch_counter.cpp)
    tetwarp_test_target(tetwarp_launch_counter)
    add_library(tetwarp_workloads OBJECT EXCLUDE_FROM_ALL bench/measure/floors.cpp
      bench/warp/truth.cpp bench/warp/warp_job.cpp bench/warp/workloads.cpp)
    tetwarp_test_target(tetwarp_workloads tetwarp_hwy fmt::fmt)
    tetwarp_add_tests(tetwarp_count_tests SOURCES
      tests/emulated/test_launch_counter.cpp $<TARGET_OBJECTS:tetwarp_launch_counter>)
    tetwarp_add_tests(tetwarp_step_counts LIBRARIES tetwarp_hwy fmt::fmt SOURCES
      tests/emulated/step_counts.cpp tests/emulated/emulated_backend.cpp
      tests/emulated/emulated_primitives.cpp
      $<TARGET_OBJECTS:tetwarp_launch_counter> $<TARGET_OBJECTS:tetwarp_workloads>)
    set_target_properties(tetwarp_step_counts PROPERTIES EXCLUDE_FROM_ALL ON)
    foreach(program tetwarp_count_tests tetwarp_step_counts)
      target_link_libraries(${program} PRIVATE tetwarp_counted)
      set_target_properties(${program} PROPERTIES DISABLE_PRECOMPILE_HEADERS ON)
    endforeach()
    tetwarp_discover(tetwarp_count_tests simt)
  endif()

  # Every back end through the public calls, compiled once for two programs: in one of them back end
  # cuda is the emulated device, in the other a real one.
  add_library(tetwarp_backend_tests OBJECT
    tests/contact/test_contact_cuda.cpp
    tests/warp/test_blocks.cpp tests/warp/test_grid_point_masks.cpp tests/warp/test_label_rules.cpp
    tests/warp/test_map_points.cpp tests/warp/test_map_points_curved.cpp
    tests/warp/test_parity.cpp
    tests/warp/test_warp_antialias.cpp tests/warp/test_warp_fields.cpp
    tests/warp/test_warp_curved.cpp tests/warp/test_warp_hexahedra.cpp tests/warp/test_warp_in_flight.cpp
    tests/warp/test_warp_intensity.cpp tests/warp/test_warp_outside.cpp
    tests/warp/test_warp_quantities.cpp
    tests/warp/test_warp_rounding.cpp)
  tetwarp_test_target(tetwarp_backend_tests)
  set_target_properties(tetwarp_backend_tests PROPERTIES UNITY_BUILD ${TETWARP_UNITY} UNITY_BUILD_BATCH_SIZE 8)
  if(TETWARP_FUSED_EMULATION)
    set_source_files_properties(tests/emulated/emulated_backend.cpp tests/emulated/emulated_contact.cpp
      PROPERTIES COMPILE_OPTIONS "-march=x86-64-v3;-ffp-contract=fast" SKIP_PRECOMPILE_HEADERS ON)
  endif()
  foreach(part backend contact detector primitives start stepper)  # compiled once for several programs
    add_library(tetwarp_emulated_${part} OBJECT tests/emulated/emulated_${part}.cpp)
    tetwarp_test_target(tetwarp_emulated_${part})
  endforeach()
  # Also in a module of Python: position independent, unlike the precompiled headers.
  set_target_properties(tetwarp_emulated_backend tetwarp_emulated_primitives tetwarp_emulated_start
    PROPERTIES POSITION_INDEPENDENT_CODE ON DISABLE_PRECOMPILE_HEADERS ON)
  tetwarp_add_tests(tetwarp_emulated_tests UNITY 7 SOURCES
    $<TARGET_OBJECTS:tetwarp_emulated_backend> $<TARGET_OBJECTS:tetwarp_emulated_contact>
    $<TARGET_OBJECTS:tetwarp_emulated_primitives> $<TARGET_OBJECTS:tetwarp_emulated_start>
    tests/emulated/test_backend_choice_emulated.cpp tests/emulated/test_cell_list_emulated.cpp
    tests/emulated/test_contact_arrays_emulated.cpp tests/emulated/test_contact_emulated.cpp
    tests/emulated/test_device_errors.cpp tests/emulated/test_staging_ring_emulated.cpp
    tests/emulated/test_step_operations.cpp
    tests/emulated/test_warp_emulated.cpp tests/emulated/test_warp_emulated_copies.cpp
    tests/emulated/test_warp_emulated_memory.cpp tests/emulated/test_warp_emulated_overlap.cpp
    tests/emulated/test_paper_emulated.cpp bench/peers/paper_method.cpp bench/peers/peer.cpp
    $<TARGET_OBJECTS:tetwarp_backend_tests>)
  target_link_libraries(tetwarp_emulated_tests PRIVATE tetwarp_openmp)
  tetwarp_discover(tetwarp_emulated_tests parity)
  if(tetwarp_device_tests)
    tetwarp_add_tests(tetwarp_device_tests SOURCES
      tests/device/test_contact_arrays_device.cu
      $<TARGET_OBJECTS:tetwarp_backend_tests>)
    target_link_libraries(tetwarp_device_tests PRIVATE CUDA::cudart_static)
    gtest_discover_tests(tetwarp_device_tests DISCOVERY_TIMEOUT 120 NO_PRETTY_TYPES
      NO_PRETTY_VALUES PROPERTIES LABELS parity TIMEOUT 300 RESOURCE_LOCK gpu)
  endif()

  # Parts of the benchmarks: floors, the truth for checks, the selection of repetitions.
  find_package(fmt REQUIRED)
  tetwarp_add_tests(tetwarp_bench_tests LIBRARIES tetwarp_hwy fmt::fmt SOURCES
    bench/measure/floors.cpp
    bench/measure/timing.cpp
    bench/warp/truth.cpp
    bench/warp/workloads.cpp
    tests/bench/test_bench.cpp)
  tetwarp_discover(tetwarp_bench_tests unit)
endif()

# ---- every public header compiles alone, without CUDA, where every file does ---------------------
if(NOT TETWARP_UNITY)
  set(tetwarp_public_headers backend blocks camera cast certify choices contact contact_adhesion
    contact_analysis contact_arrays contact_problem contact_tracker curved_mesh error loft make
    map_points mesh names
    page_lock report resample scene scene_parts simulate surface tetwarp version volume warp warp_operator)
  if(TETWARP_IO)
    list(APPEND tetwarp_public_headers axes contact_io film io mesh_array mesh_import nifti point_file
      scene_io surface_reader transfer_file transform_file)
  endif()
  foreach(TETWARP_HEADER IN LISTS tetwarp_public_headers)
    configure_file(tests/base/test_headers.cpp.in test_headers/${TETWARP_HEADER}.cpp @ONLY)
    list(APPEND tetwarp_header_sources ${PROJECT_BINARY_DIR}/test_headers/${TETWARP_HEADER}.cpp)
  endforeach()
  add_library(tetwarp_header_tests OBJECT ${tetwarp_header_sources})
  target_compile_features(tetwarp_header_tests PRIVATE cxx_std_20)
  target_include_directories(tetwarp_header_tests PRIVATE host kernels/base io ${PROJECT_BINARY_DIR}/include)
  target_link_libraries(tetwarp_header_tests PRIVATE tetwarp_options)
endif()

if(TETWARP_IO)
  include(cmake/FileTests.cmake)
endif()

include(cmake/SimulateTests.cmake)

# ---- includes between folders have one direction; source files lie beside their headers ---------
find_program(TETWARP_PYTHON3 python3 PATHS /usr/bin NO_DEFAULT_PATH)
find_program(TETWARP_PYTHON3 python3)
if(TETWARP_PYTHON3)
  foreach(lint folders sources)
    add_test(NAME lint_${lint} COMMAND ${TETWARP_PYTHON3}
      ${PROJECT_SOURCE_DIR}/tests/lint/${lint}.py --test)
    set_tests_properties(lint_${lint} PROPERTIES LABELS unit ENVIRONMENT PYTHONDONTWRITEBYTECODE=1)
  endforeach()
endif()

# ---- the cost model of a device's kernels --------------------------------------------------------
if(TETWARP_PYTHON3)
  add_test(NAME cost_model
    COMMAND ${TETWARP_PYTHON3} ${PROJECT_SOURCE_DIR}/bench/sass/cost_model.py --test)
  set_tests_properties(cost_model PROPERTIES LABELS unit ENVIRONMENT PYTHONDONTWRITEBYTECODE=1)
endif()

# ---- the examples build and run with what was installed ---------------------------------------
if(NOT TETWARP_BUNDLE)
  add_test(NAME install COMMAND ${CMAKE_COMMAND}
    -DBUILD=${PROJECT_BINARY_DIR} -DEXAMPLES=${PROJECT_SOURCE_DIR}/examples -DCONFIG=$<CONFIG>
    -DWITH_IO=${TETWARP_IO} -DGENERATOR=${CMAKE_GENERATOR} -DCXX=${CMAKE_CXX_COMPILER}
    "-DCXX_FLAGS=${CMAKE_CXX_FLAGS}" -DCUDA_ROOT=${CUDAToolkit_TARGET_DIR}
    -P ${PROJECT_SOURCE_DIR}/tests/install/run_install_test.cmake)
  set_tests_properties(install PROPERTIES LABELS install TIMEOUT 300 COST 20)  # starts early
endif()
