# Tests of files, of the command and of the benchmarks; needs tetwarp::io.
# ---- files, private code included -------------------------------------------------------------
if(NOT BUILD_SHARED_LIBS)
  tetwarp_add_tests(tetwarp_io_tests UNITY 8 LIBRARIES tetwarp_io tetwarp_hdf5 tetwarp_nifti tetwarp_png
    SOURCES
    tests/io/test_io_arrays.cpp
    tests/io/test_io_axes.cpp
    tests/io/test_dicom_stack.cpp
    tests/io/test_io_blocks.cpp
    tests/io/test_io_images.cpp
    tests/io/test_io_vtkhdf_volume.cpp
    tests/io/test_io_vtkhdf_mesh.cpp
    tests/io/test_io_nifti.cpp
    tests/io/test_io_nifti_files.cpp
    tests/io/test_io_png.cpp
    tests/io/test_io_points.cpp
    tests/io/test_io_simulation.cpp
    tests/io/test_io_bad_files.cpp
    tests/io/test_mesh_arrays.cpp
    tests/io/test_mesh_import.cpp
    tests/io/test_numbered_files.cpp
    tests/io/test_contact_certified.cpp
    tests/io/test_contact_reference_certified.cpp
    tests/io/test_io_checkpoint.cpp
    tests/io/test_io_fclib.cpp
    tests/io/test_io_fclib_bad.cpp
    tests/io/test_io_fclib_rows.cpp
    tests/io/test_io_fclib_solution.cpp
    tests/io/test_skip_chunks.cpp
    tests/io/test_mesh_child.cpp
    tests/io/test_left_out.cpp
    tests/io/test_surface_files.cpp
    io/image/dicom_stack.cpp
    io/reader/surface_seams.cpp
    tests/io/test_mesh_import_gmsh.cpp
    tests/io/test_mesh_import_vtk.cpp)
  # In place of tetwarp-read: ends as the tests want.
  add_executable(fake_reader tests/io/fake_reader.cpp)
  target_link_libraries(fake_reader PRIVATE tetwarp_reader tetwarp_options)
  target_compile_definitions(tetwarp_io_tests PRIVATE
    TETWARP_FAKE_READER="$<TARGET_FILE:fake_reader>")
  add_dependencies(tetwarp_io_tests fake_reader tetwarp_read)
  tetwarp_discover(tetwarp_io_tests io)
  include(cmake/ItkTests.cmake)
endif()

# The check of results in the contact benchmark, and the names of its rows.
tetwarp_add_tests(tetwarp_bench_contact_tests LIBRARIES tetwarp_io fmt::fmt SOURCES
  bench/contact/cases.cpp
  bench/contact/solution_check.cpp
  tests/bench/test_bench_contact.cpp)
tetwarp_discover(tetwarp_bench_contact_tests unit)

add_executable(fuzz_io tests/io/fuzz_io.cpp tests/io/fuzz_memory.cpp)
target_include_directories(fuzz_io PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(fuzz_io PRIVATE tetwarp_io tetwarp_hdf5 tetwarp_options)
add_test(NAME fuzz_io COMMAND fuzz_io 5 1)
set_tests_properties(fuzz_io PROPERTIES LABELS io)
add_executable(fuzz_mesh_reader tests/io/fuzz_mesh_reader.cpp)
target_link_libraries(fuzz_mesh_reader PRIVATE tetwarp_reader tetwarp_options)
add_executable(fuzz_mesh tests/io/fuzz_mesh.cpp)
target_include_directories(fuzz_mesh PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(fuzz_mesh PRIVATE tetwarp_io tetwarp_hdf5 tetwarp_options)
target_compile_definitions(fuzz_mesh PRIVATE FUZZ_MESH_READER="$<TARGET_FILE:fuzz_mesh_reader>")
add_dependencies(fuzz_mesh fuzz_mesh_reader)
add_test(NAME fuzz_mesh COMMAND fuzz_mesh 2 1)
set_tests_properties(fuzz_mesh PROPERTIES LABELS io)

# The distribution's interpreter first: its VTK is what the packages in ./dev install.
find_program(TETWARP_PYTHON3 python3 PATHS /usr/bin NO_DEFAULT_PATH)
find_program(TETWARP_PYTHON3 python3)
if(TETWARP_PYTHON3)
  add_test(NAME vtk_reader COMMAND ${TETWARP_PYTHON3}
    ${PROJECT_SOURCE_DIR}/tests/io/check_vtk_reader.py $<TARGET_FILE:tetwarp_command>)
  # Of the 48 orientations of a grid every nth by its share; all as `long`.
  set(checks axes dicom fields images transforms)
  set(shares 5 7 24 5 5)
  foreach(check every IN ZIP_LISTS checks shares)
    set(run ${TETWARP_PYTHON3} ${PROJECT_SOURCE_DIR}/tests/io/check_${check}.py
      $<TARGET_FILE:tetwarp_command>)
    add_test(NAME ${check} COMMAND ${run} ${every})
    add_test(NAME ${check}_of_all_orientations COMMAND ${run})
    set_tests_properties(${check} PROPERTIES LABELS io SKIP_RETURN_CODE 77)
    set_tests_properties(${check}_of_all_orientations PROPERTIES LABELS long SKIP_RETURN_CODE 77)
  endforeach()
  add_test(NAME foreign_meshes COMMAND ${TETWARP_PYTHON3}
    ${PROJECT_SOURCE_DIR}/tests/io/check_foreign_meshes.py $<TARGET_FILE:tetwarp_command>)
  add_test(NAME itk_spaces COMMAND ${TETWARP_PYTHON3}
    ${PROJECT_SOURCE_DIR}/tests/io/check_itk_spaces.py $<TARGET_FILE:tetwarp_command>)
  add_test(NAME labels COMMAND ${TETWARP_PYTHON3}
    ${PROJECT_SOURCE_DIR}/tests/io/check_labels.py $<TARGET_FILE:tetwarp_command>)
  add_test(NAME walk COMMAND ${TETWARP_PYTHON3}
    ${PROJECT_SOURCE_DIR}/tests/io/check_walk.py $<TARGET_FILE:tetwarp_command>)
  add_test(NAME simulation COMMAND ${TETWARP_PYTHON3}
    ${PROJECT_SOURCE_DIR}/tests/io/check_simulation.py $<TARGET_FILE:tetwarp_command>)
  add_test(NAME film COMMAND ${TETWARP_PYTHON3}
    ${PROJECT_SOURCE_DIR}/tests/io/check_film.py $<TARGET_FILE:tetwarp_command>)
  set_tests_properties(vtk_reader foreign_meshes itk_spaces labels walk simulation film PROPERTIES
    LABELS io SKIP_RETURN_CODE 77)
  add_test(NAME bench_report COMMAND ${TETWARP_PYTHON3}
    ${PROJECT_SOURCE_DIR}/bench/report self-test)
  set_tests_properties(bench_report PROPERTIES
    LABELS unit ENVIRONMENT PYTHONDONTWRITEBYTECODE=1)
endif()

include(cmake/DocTests.cmake)

# ---- the command ------------------------------------------------------------------------------
# tetwarp_add_cli_tests(PROGRAM SOURCE...): tests that start the command.
function(tetwarp_add_cli_tests program)
  tetwarp_add_tests(${program} UNITY 8
    LIBRARIES tetwarp_io tetwarp_hdf5 tetwarp_nifti nlohmann_json::nlohmann_json SOURCES ${ARGN})
  target_compile_definitions(${program} PRIVATE
    TETWARP_COMMAND="$<TARGET_FILE:tetwarp_command>"
    TETWARP_MPIRUN="$<$<BOOL:${TETWARP_HAS_MPI}>:${MPIEXEC_EXECUTABLE}>")
  add_dependencies(${program} tetwarp_command)
endfunction()
tetwarp_add_cli_tests(tetwarp_cli_tests
  tests/cli/test_cli.cpp
  tests/cli/test_cli_arrays.cpp
  tests/cli/test_cli_curved.cpp
  tests/cli/test_cli_mesh.cpp
  tests/cli/test_cli_axes.cpp
  tests/cli/test_cli_bad_formats.cpp
  tests/cli/test_cli_bad_images.cpp
  tests/cli/test_cli_bad_input.cpp
  tests/cli/test_cli_bad_layouts.cpp
  tests/cli/test_cli_batch.cpp
  tests/cli/test_cli_batch_defaults.cpp
  tests/cli/test_cli_batch_order.cpp
  tests/cli/test_cli_field_batch.cpp
  tests/cli/test_cli_certify.cpp
  tests/cli/test_cli_contact.cpp
  tests/cli/test_cli_contact_usage.cpp
  tests/cli/test_cli_fields.cpp
  tests/cli/test_cli_interrupt.cpp
  tests/cli/test_cli_grid.cpp
  tests/cli/test_cli_outputs.cpp
  tests/cli/test_cli_pair.cpp
  tests/cli/test_cli_plot.cpp
  tests/cli/test_cli_points.cpp
  tests/cli/test_cli_ranks.cpp
  tests/cli/test_cli_resume.cpp
  tests/cli/test_cli_rules.cpp
  tests/cli/test_cli_simulate.cpp
  tests/cli/test_cli_simulate_contact.cpp
  tests/cli/test_cli_simulate_ends.cpp
  tests/cli/test_cli_skip.cpp
  tests/cli/test_cli_straight.cpp
  tests/cli/test_cli_tools.cpp
  tests/cli/test_cli_transforms.cpp
  tests/cli/test_cli_warnings.cpp
  host/cli/tools/chart.cpp
  tests/cli/test_cli_render.cpp
  tests/cli/test_cli_simulate_surfaces.cpp
  tests/cli/test_cli_simulate_volumes.cpp
  tests/cli/test_cli_field_memory.cpp
  tests/cli/test_cli_refusals.cpp
  tests/cli/test_cli_steps.cpp)
target_link_libraries(tetwarp_cli_tests PRIVATE $<LINK_ONLY:fmt::fmt>)  # of chart.cpp
tetwarp_discover(tetwarp_cli_tests cli)
if(TETWARP_LONG_TESTS)
  tetwarp_add_cli_tests(tetwarp_cli_memory_tests
    tests/cli/test_cli_memory.cpp
    tests/cli/test_cli_memory_peak.cpp)
  tetwarp_discover(tetwarp_cli_memory_tests long)
endif()

# ---- live windows -------------------------------------------------------------------------------
set(tetwarp_link_tests "")
if(TETWARP_HAS_SCREENS)
  set(tetwarp_link_tests tests/view/test_screen_link.cpp)
endif()
set(tetwarp_input_tests "")
set(tetwarp_input_libraries "")
if(TETWARP_HAS_VIEW AND TARGET SDL2::SDL2)
  list(APPEND tetwarp_input_tests tests/view/test_gamepad.cpp)
  list(APPEND tetwarp_input_libraries tetwarp_view_devices SDL2::SDL2)
endif()
if(TETWARP_HAS_VIEW AND TETWARP_SPNAV_INCLUDE AND TETWARP_SPNAV_LIBRARY)
  list(APPEND tetwarp_input_tests tests/view/test_space_mouse.cpp)
  list(APPEND tetwarp_input_libraries tetwarp_view_devices)
endif()
tetwarp_add_cli_tests(tetwarp_view_tests
  ${tetwarp_link_tests} ${tetwarp_input_tests}
  tests/view/test_device_hand.cpp
  tests/view/test_live_simulation.cpp
  tests/view/test_look_surfaces.cpp
  tests/view/test_screen_messages.cpp
  tests/view/test_screens.cpp
  tests/view/test_view_colors.cpp
  tests/view/test_view_devices.cpp
  tests/view/test_view_keys.cpp
  tests/view/test_view_parts.cpp)
target_link_libraries(tetwarp_view_tests PRIVATE tetwarp_view_parts ${tetwarp_input_libraries})
if(TETWARP_HAS_SCREENS)
  target_link_libraries(tetwarp_view_tests PRIVATE tetwarp_view_link)
endif()
tetwarp_discover(tetwarp_view_tests unit)
if(TETWARP_HAS_VRPN)
  find_library(TETWARP_VRPN_SERVER_LIBRARY vrpnserver HINTS ${TETWARP_VRPN_INCLUDE}/../lib)
endif()
if(TETWARP_HAS_VRPN AND TETWARP_VRPN_SERVER_LIBRARY)
  add_executable(tetwarp_tracking_server tests/view/tracking_server.cpp)
  target_include_directories(tetwarp_tracking_server SYSTEM PRIVATE ${TETWARP_VRPN_INCLUDE})
  target_link_libraries(tetwarp_tracking_server PRIVATE
    ${TETWARP_VRPN_SERVER_LIBRARY} ${TETWARP_QUAT_LIBRARY} Threads::Threads tetwarp_options)
  tetwarp_add_tests(tetwarp_tracked_tests
    LIBRARIES tetwarp_view_devices SOURCES tests/view/test_tracked_device.cpp)
  target_compile_definitions(tetwarp_tracked_tests PRIVATE
    TETWARP_TRACKING_SERVER="$<TARGET_FILE:tetwarp_tracking_server>")
  add_dependencies(tetwarp_tracked_tests tetwarp_tracking_server)
  tetwarp_discover(tetwarp_tracked_tests unit)
endif()
if(TETWARP_PYTHON3 AND TETWARP_HAS_VIEW)
  add_test(NAME window COMMAND ${TETWARP_PYTHON3} -B
    ${PROJECT_SOURCE_DIR}/tests/view/check_window.py $<TARGET_FILE:tetwarp_command>)
  add_test(NAME window_keys COMMAND ${TETWARP_PYTHON3} -B
    ${PROJECT_SOURCE_DIR}/tests/view/check_keys.py $<TARGET_FILE:tetwarp_command>)
  # One at a time: displays in several namespaces may get the same number.
  set_tests_properties(window window_keys PROPERTIES LABELS cli SKIP_RETURN_CODE 77 TIMEOUT 300
    RESOURCE_LOCK display)
  if(TARGET tetwarp_tracking_server)
    add_test(NAME window_wand COMMAND ${TETWARP_PYTHON3} -B ${PROJECT_SOURCE_DIR}/tests/view/check_wand.py
      $<TARGET_FILE:tetwarp_command> $<TARGET_FILE:tetwarp_tracking_server>)
    set_tests_properties(window_wand PROPERTIES LABELS cli SKIP_RETURN_CODE 77 TIMEOUT 300
      RESOURCE_LOCK display)
  endif()
  if(TETWARP_HAS_SCREENS)
    add_test(NAME screens COMMAND ${TETWARP_PYTHON3} -B
      ${PROJECT_SOURCE_DIR}/tests/view/check_screens.py $<TARGET_FILE:tetwarp_command>)
    add_test(NAME network COMMAND ${TETWARP_PYTHON3} -B
      ${PROJECT_SOURCE_DIR}/tests/view/check_network.py $<TARGET_FILE:tetwarp_command>)
    add_test(NAME stereo COMMAND ${TETWARP_PYTHON3} -B
      ${PROJECT_SOURCE_DIR}/tests/view/check_stereo.py $<TARGET_FILE:tetwarp_command>)
    set_tests_properties(screens network stereo PROPERTIES LABELS cli SKIP_RETURN_CODE 77 TIMEOUT 300
      RESOURCE_LOCK display)
    set_tests_properties(stereo PROPERTIES LABELS long)
  endif()
endif()

# ---- the Python package -------------------------------------------------------------------------
if(TETWARP_HAS_PYTHON)
  add_test(NAME python COMMAND ${Python_EXECUTABLE} ${PROJECT_SOURCE_DIR}/python/tests/run.py)
  set_tests_properties(python PROPERTIES LABELS python SKIP_RETURN_CODE 77 TIMEOUT 300
    ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1;TETWARP_COMMAND=$<TARGET_FILE:tetwarp_command>"
    ENVIRONMENT_MODIFICATION "PYTHONPATH=path_list_prepend:${PROJECT_BINARY_DIR}/python")
  if(NOT BUILD_SHARED_LIBS)
    include(cmake/EmulatedPython.cmake)
  endif()
else()
  add_test(NAME python COMMAND ${CMAKE_COMMAND} -E echo
    "skipped: the Python package was not built: there is no ${tetwarp_python_missing}")
  set_tests_properties(python PROPERTIES LABELS python SKIP_REGULAR_EXPRESSION skipped)
endif()
