# Tests of the simulator; they reach private code, which a shared library hides.
if(NOT BUILD_SHARED_LIBS)
  set(tetwarp_scene_tests       # files, shapes, lattices, surfaces, selections
    tests/scene/test_cage.cpp
    tests/scene/test_image_lattice.cpp
    tests/scene/test_isosurface.cpp
    tests/scene/test_scene_geometry.cpp
    tests/scene/test_shape.cpp
    tests/scene/test_shape_lattice.cpp
    tests/scene/test_shape_surface.cpp
    tests/scene/test_surface_lattice.cpp)
  set(tetwarp_model_tests       # masses, elements, springs, the Simulator
    tests/simulate/test_model_cloth.cpp
    tests/simulate/test_model_couplings.cpp
    tests/simulate/test_model_masses.cpp
    tests/simulate/test_model_rigid.cpp
    tests/simulate/test_simulator_drive.cpp
    tests/simulate/test_simulator_laws.cpp
    tests/simulate/test_simulator_records.cpp
    tests/simulate/test_simulator_state.cpp)
  set(tetwarp_body_tests        # kernels of bodies, emulated cuda
    tests/simulate/body_measures.cpp
    tests/simulate/body_models.cpp
    tests/simulate/test_tet_rotation.cpp
    tests/simulate/test_elastic_forces.cpp
    tests/simulate/test_edge_spring.cpp
    tests/simulate/test_stepper_bodies.cpp
    tests/simulate/test_stepper_options.cpp
    tests/simulate/test_vector_stages.cpp
    tests/emu/emulated_stepper.cpp
    tests/emu/test_stepper_emulated.cpp
    tests/simulate/test_parity_cuda.cpp
    tests/simulate/test_stepper_parity.cpp
    tests/scenes/parity_scenes.cpp)
  set(tetwarp_reference_twin_tests  # closed forms on the reference, parity with it
    tests/scenes/parity_scenes.cpp
    tests/simulate/test_reference_cantilever.cpp
    tests/simulate/test_reference_elements.cpp
    tests/simulate/test_reference_hanging.cpp
    tests/simulate/test_reference_image.cpp
    tests/simulate/test_reference_motion.cpp
    tests/simulate/test_reference_parity.cpp
    tests/simulate/test_reference_recovery.cpp)
  foreach(name scene model body reference_twin)
    if(tetwarp_${name}_tests)
      tetwarp_add_tests(tetwarp_${name}_tests UNITY 3 LIBRARIES nlohmann_json::nlohmann_json
        SOURCES ${tetwarp_${name}_tests})
      tetwarp_discover(tetwarp_${name}_tests unit)
    endif()
  endforeach()
  if(tetwarp_device_tests)  # without the emulated stepper: on a device
    tetwarp_add_tests(tetwarp_device_simulate_tests SOURCES
      tests/simulate/body_measures.cpp
      tests/simulate/body_models.cpp
      tests/simulate/test_device.cpp
      tests/simulate/test_parity_cuda.cpp
      tests/simulate/test_stepper_parity.cpp
      tests/scenes/parity_scenes.cpp)
    gtest_discover_tests(tetwarp_device_simulate_tests DISCOVERY_TIMEOUT 120
      PROPERTIES LABELS parity TIMEOUT 300 RESOURCE_LOCK gpu)
  endif()
  tetwarp_add_tests(tetwarp_simulate_large_tests SOURCES tests/simulate/test_simulator_large.cpp)
  tetwarp_discover(tetwarp_simulate_large_tests long)
  if(TETWARP_IO)
    tetwarp_add_tests(tetwarp_scene_file_tests UNITY 4
      LIBRARIES tetwarp_io tetwarp_hdf5 nlohmann_json::nlohmann_json SOURCES
      tests/scene/test_scene_bad.cpp
      tests/scene/test_scene_check.cpp
      tests/scene/test_scene_files.cpp
      tests/scene/test_scene_fuzz.cpp
      tests/scene/test_scene_keys.cpp
      tests/scene/test_scene_page.cpp
      tests/scene/test_scene_phantoms.cpp
      tests/scene/test_scene_shipped.cpp)
    target_compile_definitions(tetwarp_scene_file_tests PRIVATE
      TETWARP_SCENE_PAGE="${PROJECT_SOURCE_DIR}/docs/scenes.md")
    tetwarp_discover(tetwarp_scene_file_tests io)
  endif()
endif()
