# Tests of the simulator; they reach private code, which a shared library hides.
if(NOT BUILD_SHARED_LIBS)
  set(tetwarp_scene_tests       # files, shapes, lattices, surfaces, selections
    tests/scene/test_cage.cpp
    tests/scene/test_image_lattice.cpp
    tests/scene/test_voxel_shares.cpp
    tests/scene/test_isosurface.cpp
    tests/scene/test_loft.cpp
    tests/scene/test_scene_geometry.cpp
    tests/scene/test_shape.cpp
    tests/scene/test_shape_lattice.cpp
    tests/scene/test_shape_surface.cpp
    tests/scene/test_surface_lattice.cpp
    tests/scene/test_surface_solid.cpp)
  set(tetwarp_model_tests       # masses, elements, springs, the Simulator
    tests/simulate/step/test_model_cloth.cpp
    tests/simulate/step/test_model_couplings.cpp
    tests/simulate/step/test_model_masses.cpp
    tests/simulate/step/test_model_rigid.cpp
    tests/simulate/state/test_added_handles.cpp
    tests/simulate/state/test_checkpoint_bytes.cpp
    tests/simulate/state/test_simulator_drive.cpp
    tests/simulate/laws/test_simulator_laws.cpp
    tests/simulate/state/test_simulator_records.cpp
    tests/simulate/state/test_simulator_state.cpp)
  set(tetwarp_body_tests        # kernels of bodies, emulated cuda
    tests/simulate/body_measures.cpp
    tests/simulate/body_models.cpp
    tests/simulate/step/test_block_lu.cpp
    tests/simulate/step/test_island_factors.cpp
    tests/simulate/step/test_tet_rotation.cpp
    tests/simulate/step/test_elastic_forces.cpp
    tests/simulate/step/test_edge_spring.cpp
    tests/simulate/step/test_stepper_bodies.cpp
    tests/simulate/step/test_stepper_move.cpp
    tests/simulate/step/test_rest_gradients.cpp
    tests/simulate/step/test_stepper_options.cpp
    tests/simulate/step/test_vector_assembly.cpp
    tests/simulate/step/test_vector_stages.cpp
    $<TARGET_OBJECTS:tetwarp_emulated_primitives>
    $<TARGET_OBJECTS:tetwarp_emulated_stepper>
    tests/emulated/test_stepper_emulated.cpp
    tests/simulate/step/test_parity_cuda.cpp
    tests/simulate/step/test_stepper_parity.cpp
    tests/support/parity_scenes.cpp)
  set(tetwarp_reference_twin_tests  # closed forms on the reference, parity with it
    tests/support/parity_scenes.cpp
    tests/simulate/reference/test_reference_cantilever.cpp
    tests/simulate/reference/test_reference_elements.cpp
    tests/simulate/reference/test_reference_hanging.cpp
    tests/simulate/reference/test_reference_image.cpp
    tests/simulate/reference/test_reference_motion.cpp
    tests/simulate/reference/test_reference_parity.cpp
    tests/simulate/reference/test_reference_recovery.cpp)
  set(tetwarp_ccd_tests         # distances and times of pairs of features, the interval reference
    tests/collide/constructed_hits.cpp
    tests/collide/cubic_ccd.cpp
    tests/collide/test_ccd_mutants.cpp
    tests/collide/test_ccd_turns.cpp
    tests/collide/test_pair_apart.cpp
    tests/collide/test_pair_ccd.cpp
    tests/collide/test_interval_ccd.cpp
    tests/collide/test_pair_distance.cpp
    tests/collide/test_triangle_intersection.cpp
    tests/collide/test_certify.cpp)
  set(tetwarp_detector_tests    # broad phase, detector, emulated cuda
    tests/collide/brute_force_pairs.cpp
    tests/collide/collide_scenes.cpp
    tests/collide/counted_memory.cpp
    tests/collide/test_detector_closest.cpp
    tests/collide/test_detector_counts.cpp
    tests/collide/test_detector_extremes.cpp
    tests/collide/test_detector_pairs.cpp
    tests/collide/test_detector_steps.cpp
    tests/collide/test_self_clearance.cpp
    tests/collide/test_step_touches.cpp
    tests/collide/test_detector_turns.cpp
    $<TARGET_OBJECTS:tetwarp_emulated_detector>
    $<TARGET_OBJECTS:tetwarp_emulated_primitives>
    tests/emulated/test_detector_emulated.cpp)
  # Replaces the allocation functions of the program: not to be inlined into other files.
  set_source_files_properties(tests/collide/counted_memory.cpp PROPERTIES
    SKIP_UNITY_BUILD_INCLUSION ON)
  set(tetwarp_surfaces_tests    # surfaces of scenes, their motion, starts without collisions
    tests/simulate/touch/test_pair_materials.cpp
    tests/simulate/touch/test_rest_growth.cpp
    tests/simulate/touch/test_scene_surfaces.cpp
    tests/simulate/touch/test_start_cages.cpp
    tests/simulate/touch/test_start_check.cpp
    tests/simulate/touch/test_start_push.cpp
    tests/simulate/touch/test_surface_motion.cpp
    tests/simulate/touch/test_untangle_run.cpp
    )
  set(tetwarp_pair_contact_tests  # contacts of pairs, reduction, tracker of deformable bodies
    tests/simulate/pair_scene.cpp
    tests/simulate/touch/test_contact_names.cpp
    tests/simulate/touch/test_flat_edges.cpp
    tests/simulate/touch/test_pair_contacts.cpp
    tests/simulate/touch/test_pressing_impulses.cpp
    tests/simulate/touch/test_rigid_patches.cpp
    tests/simulate/touch/test_tracker_places.cpp
    tests/simulate/touch/test_vertex_contacts.cpp
    )
  set(tetwarp_contact_system_tests  # contact problems of steps and their solutions
    tests/simulate/body_measures.cpp
    tests/simulate/body_models.cpp
    tests/simulate/hand_contacts.cpp
    tests/simulate/mixed_contacts.cpp
    tests/simulate/stack_scenes.cpp
    tests/simulate/stack_steps.cpp
    tests/simulate/solve/test_condensed.cpp
    tests/simulate/solve/test_contact_bonds.cpp
    tests/simulate/solve/test_contact_system.cpp
    tests/simulate/solve/test_contact_system_blocks.cpp
    tests/simulate/solve/test_following_motion.cpp
    tests/simulate/solve/test_proximal_steps.cpp
    tests/simulate/solve/test_residual_check.cpp
    tests/simulate/solve/test_two_level.cpp
    tests/simulate/solve/test_touch_lists.cpp
    tests/simulate/solve/test_two_level_stages.cpp
    tests/simulate/solve/test_contact_tangent.cpp
    )
  set(tetwarp_touch_tests       # whole steps with contact
    tests/simulate/body_models.cpp
    tests/simulate/touch/test_expected_motion.cpp
    tests/simulate/touch/test_step_failures.cpp
    tests/simulate/touch/test_touch_capsules.cpp
    tests/simulate/touch/test_touch_edges.cpp
    tests/simulate/touch/test_touch_fall.cpp
    tests/simulate/touch/test_touch_records.cpp
    tests/simulate/touch/test_touch_self.cpp
    tests/simulate/touch/test_touch_sleep.cpp
    tests/simulate/touch/test_touch_state.cpp
    tests/simulate/touch/test_touch_throw.cpp
    )
  set(tetwarp_contact_law_tests  # closed forms of contact, through the Simulator
    tests/simulate/laws/test_law_adhesion.cpp
    tests/simulate/laws/test_law_balances.cpp
    tests/simulate/laws/test_law_budget.cpp
    tests/simulate/laws/test_law_flat_floors.cpp
    tests/simulate/laws/test_law_repeats.cpp
    tests/simulate/laws/test_law_slopes.cpp
    tests/simulate/laws/test_law_soft.cpp
    tests/simulate/laws/test_law_throws.cpp
    )
  set(tetwarp_emulated_simulator_tests  # the Simulator on emulated cuda, its detector and a Warper
    $<TARGET_OBJECTS:tetwarp_emulated_backend>
    $<TARGET_OBJECTS:tetwarp_emulated_contact>
    $<TARGET_OBJECTS:tetwarp_emulated_detector>
    $<TARGET_OBJECTS:tetwarp_emulated_primitives>
    $<TARGET_OBJECTS:tetwarp_emulated_start>
    $<TARGET_OBJECTS:tetwarp_emulated_stepper>
    tests/emulated/test_contact_system_emulated.cpp
    tests/emulated/test_residual_check_emulated.cpp
    tests/emulated/test_two_level_emulated.cpp
    tests/emulated/test_simulator_emulated.cpp
    tests/emulated/test_surfaces_emulated.cpp
    tests/simulate/body_models.cpp
    tests/simulate/hand_contacts.cpp
    tests/simulate/mixed_contacts.cpp
    tests/simulate/stack_scenes.cpp
    tests/simulate/stack_steps.cpp
    tests/simulate/solve/test_contact_cuda.cpp)
  foreach(name scene model body emulated_simulator reference_twin ccd detector surfaces
               pair_contact contact_system touch contact_law)
    if(tetwarp_${name}_tests)
      tetwarp_add_tests(tetwarp_${name}_tests UNITY 8 LIBRARIES nlohmann_json::nlohmann_json
        SOURCES ${tetwarp_${name}_tests})
      tetwarp_discover(tetwarp_${name}_tests unit)
    endif()
  endforeach()
  if(tetwarp_device_tests)  # without the emulated stepper: on a device
    tetwarp_add_tests(tetwarp_device_simulate_tests SOURCES
      tests/simulate/body_measures.cpp
      tests/simulate/body_models.cpp
      tests/simulate/solve/test_contact_cuda.cpp
      tests/simulate/step/test_device.cpp
      tests/simulate/step/test_parity_cuda.cpp
      tests/simulate/step/test_stepper_parity.cpp
      tests/support/parity_scenes.cpp)
    gtest_discover_tests(tetwarp_device_simulate_tests DISCOVERY_TIMEOUT 120
      PROPERTIES LABELS parity TIMEOUT 300 RESOURCE_LOCK gpu)
  endif()
  # Pairs of features with their answers, for comparison with ipctk; skipped where it is missing.
  add_executable(tetwarp_collision_pairs
    bench/peers/collision_pairs.cpp tests/collide/constructed_hits.cpp)
  target_include_directories(tetwarp_collision_pairs PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(tetwarp_collision_pairs PRIVATE tetwarp tetwarp_options)
  find_program(TETWARP_PYTHON3 python3 PATHS /usr/bin NO_DEFAULT_PATH)
  find_program(TETWARP_PYTHON3 python3)
  if(TETWARP_PYTHON3)
    add_test(NAME collision_ipctk COMMAND ${TETWARP_PYTHON3}
      ${PROJECT_SOURCE_DIR}/bench/peers/collision_ipctk.py
      $<TARGET_FILE:tetwarp_collision_pairs> 10 500)
    set_tests_properties(collision_ipctk PROPERTIES LABELS unit TIMEOUT 300 SKIP_RETURN_CODE 77)
  endif()
  if(TETWARP_LONG_TESTS)
    tetwarp_add_tests(tetwarp_simulate_large_tests SOURCES
      tests/simulate/solve/test_contact_large.cpp
      tests/simulate/solve/test_contact_stress.cpp
      tests/simulate/laws/test_law_peel.cpp
      tests/simulate/state/test_simulator_large.cpp
      tests/simulate/laws/test_touch_energy.cpp)
    tetwarp_discover(tetwarp_simulate_large_tests long)
  endif()
  if(TETWARP_IO)
    tetwarp_add_tests(tetwarp_scene_file_tests UNITY 8
      LIBRARIES tetwarp_io tetwarp_hdf5 nlohmann_json::nlohmann_json SOURCES
      tests/scene/test_scene_bad.cpp
      tests/scene/test_scene_check.cpp
      tests/scene/test_scene_contact.cpp
      tests/scene/test_scene_files.cpp
      tests/scene/test_scene_fuzz.cpp
      tests/scene/test_scene_keys.cpp
      tests/scene/test_scene_page.cpp
      tests/scene/test_scene_phantoms.cpp
      tests/scene/test_scene_shipped.cpp
      tests/scene/test_scene_shipped_contact.cpp)
    target_compile_definitions(tetwarp_scene_file_tests PRIVATE
      TETWARP_SCENE_PAGE="${PROJECT_SOURCE_DIR}/docs/scenes.md")
    tetwarp_discover(tetwarp_scene_file_tests io)
    tetwarp_add_tests(tetwarp_short_scene_tests LIBRARIES tetwarp_io SOURCES
      tests/simulate/laws/test_scene_short.cpp)
    tetwarp_discover(tetwarp_short_scene_tests io)
    if(TETWARP_LONG_TESTS)
      tetwarp_add_tests(tetwarp_scene_law_tests LIBRARIES tetwarp_io SOURCES
        tests/simulate/laws/test_scene_bonds.cpp
        tests/simulate/laws/test_scene_laws.cpp
        tests/simulate/laws/test_scene_torso.cpp)
      tetwarp_discover(tetwarp_scene_law_tests long)
    endif()
  endif()
endif()
