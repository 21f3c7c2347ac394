# Sources of the simulator, by folder.
set(tetwarp_geometry_sources   # host/scene: bodies of a scene as nodes and triangles
  host/scene/body_geometry.cpp
  host/scene/cage.cpp
  host/scene/check_body.cpp
  host/scene/check_geometry.cpp
  host/scene/check_motion.cpp
  host/scene/check_scene.cpp
  host/scene/image_lattice.cpp
  host/scene/isosurface.cpp
  host/scene/lattice.cpp
  host/scene/lattice_search.cpp
  host/scene/marching_tets.cpp
  host/scene/ring_surface.cpp
  host/scene/scene_checks.cpp
  host/scene/scene_geometry.cpp
  host/scene/selection.cpp
  host/scene/shape.cpp
  host/scene/shape_fraction.cpp
  host/scene/shape_lattice.cpp
  host/scene/shape_surface.cpp
  host/scene/sheet.cpp
  host/scene/surface.cpp
  host/scene/surface_lattice.cpp
  host/scene/voxel_owner.cpp)
# host/simulate/model: masses, elements, springs
set(tetwarp_model_sources
  host/simulate/body_points.cpp
  host/simulate/material_finder.cpp
  host/simulate/motion.cpp
  host/simulate/nearest.cpp
  host/simulate/surface_mesh.cpp
  host/simulate/model/cloth.cpp
  host/simulate/model/fem.cpp
  host/simulate/model/image_materials.cpp
  host/simulate/model/model.cpp
  host/simulate/model/rigid.cpp
  host/simulate/model/springs.cpp
  host/simulate/model/triangle_cloth.cpp)
set(tetwarp_step_sources        # host/simulate: the steps, on the cpu and on cuda
  host/simulate/cell_fields.cpp
  host/simulate/cpu/rest_factor.cpp
  host/simulate/cpu/rest_factors.cpp
  host/simulate/cpu/rest_gradients.cpp
  host/simulate/cpu/rest_matrix.cpp
  host/simulate/cpu/stepper_cpu.cpp
  host/simulate/cpu/vector_stages.cpp
  host/simulate/cpu/vector_stages_base.cpp
  host/simulate/cuda/stepper_$<IF:$<BOOL:${TETWARP_HAS_CUDA}>,cuda.cu,nocuda.cpp>
  host/simulate/run/fingerprint.cpp
  host/simulate/reference_rows.cpp
  host/simulate/reference_stepper.cpp
  host/simulate/scene_drive.cpp
  host/simulate/scene_loads.cpp
  host/simulate/scene_record.cpp
  host/simulate/run/island_lists.cpp
  host/simulate/run/island_sleep.cpp
  host/simulate/run/simulator.cpp
  host/simulate/run/simulator_impl.cpp
  host/simulate/run/simulator_step.cpp
  host/simulate/step_sums.cpp
  host/simulate/system_pattern.cpp)
set(tetwarp_simulate_reference_sources  # host/reference/simulate
  host/reference/simulate/assemble.cpp
  host/reference/simulate/bodies.cpp
  host/reference/simulate/bodies_record.cpp
  host/reference/simulate/cloth_body.cpp
  host/reference/simulate/elements.cpp
  host/reference/simulate/energy.cpp
  host/reference/simulate/exact_sign.cpp
  host/reference/simulate/fem_body.cpp
  host/reference/simulate/forces.cpp
  host/reference/simulate/image_material.cpp
  host/reference/simulate/intersecting_triangles.cpp
  host/reference/simulate/interval_ccd.cpp
  host/reference/simulate/make_system.cpp
  host/reference/simulate/material_point.cpp
  host/reference/simulate/motion.cpp
  host/reference/simulate/named.cpp
  host/reference/simulate/nearest_material.cpp
  host/reference/simulate/prescribed.cpp
  host/reference/simulate/rigid_mass.cpp
  host/reference/simulate/shares.cpp
  host/reference/simulate/springs.cpp
  host/reference/simulate/step_system.cpp
  host/reference/simulate/system.cpp
  host/reference/simulate/triangle_intersection.cpp)
set(tetwarp_collide_sources  # host/collide: which features touch during a motion
  host/collide/body_partners.cpp
  host/collide/collide_items.cpp
  host/collide/cpu/detector_cpu.cpp
  host/collide/cuda/detector_$<IF:$<BOOL:${TETWARP_HAS_CUDA}>,cuda.cu,nocuda.cpp>
  host/collide/grid_plan.cpp
  host/collide/touch_areas.cpp)
set(tetwarp_touch_sources    # host/simulate/contact: surfaces, contacts, their solution
  host/simulate/contact/cage_growth.cpp
  host/simulate/contact/cage_pose.cpp
  host/simulate/contact/contact_constants.cpp
  host/simulate/contact/contact_islands.cpp
  host/simulate/contact/contact_laws.cpp
  host/simulate/contact/contact_rows.cpp
  host/simulate/contact/contact_sides.cpp
  host/simulate/contact/contact_shares.cpp
  host/simulate/contact/contact_system.cpp
  host/simulate/contact/contact_thickness.cpp
  host/simulate/contact/elastic_groups.cpp
  host/simulate/contact/two_level_on_device.cpp
  host/simulate/contact/compliant_list_maker.cpp
  host/simulate/contact/elastic_space.cpp
  host/simulate/contact/flat_edges.cpp
  host/simulate/contact/kept_places.cpp
  host/simulate/contact/medial_node.cpp
  host/simulate/contact/near_pair.cpp
  host/simulate/contact/pair_contacts.cpp
  host/simulate/contact/pair_materials.cpp
  host/simulate/contact/patch_moments.cpp
  host/simulate/contact/patch_supports.cpp
  host/simulate/contact/prepare_start.cpp
  host/simulate/contact/rest_growth.cpp
  host/simulate/contact/rigid_patches.cpp
  host/simulate/contact/round_shape.cpp
  host/simulate/contact/scene_surfaces.cpp
  host/simulate/contact/soft_islands.cpp
  host/simulate/contact/solved_islands.cpp
  host/simulate/contact/solver_islands.cpp
  host/simulate/contact/start_check.cpp
  host/simulate/contact/start_shrink.cpp
  host/simulate/contact/step_laws.cpp
  host/simulate/contact/step_problem.cpp
  host/simulate/contact/step_rows.cpp
  host/simulate/contact/surface_motion.cpp
  host/simulate/contact/touching_blocks.cpp
  host/simulate/contact/touching_groups.cpp
  host/simulate/contact/touching_sweeps.cpp
  host/simulate/contact/triangle_tree.cpp
  host/simulate/contact/two_level_solver.cpp
  host/simulate/contact/two_level_step.cpp
  host/simulate/contact/two_level_sweeps.cpp)
set(tetwarp_contact_step_sources  # host/simulate: the step with contact
  host/simulate/run/contact_step.cpp
  host/simulate/run/contact_step_end.cpp
  host/simulate/run/contact_step_sleep.cpp
  host/simulate/run/expected_motion.cpp
  host/simulate/run/simulator_checkpoint.cpp
  host/simulate/run/simulator_record.cpp
  host/simulate/run/simulator_sleep.cpp
  host/simulate/run/simulator_state.cpp
  host/simulate/run/step_groups.cpp
  host/simulate/run/tet_energies.cpp)
target_sources(tetwarp PRIVATE ${tetwarp_collide_sources} ${tetwarp_touch_sources}
  ${tetwarp_contact_step_sources})
target_sources(tetwarp PRIVATE ${tetwarp_geometry_sources} ${tetwarp_model_sources}
  ${tetwarp_step_sources} ${tetwarp_simulate_reference_sources})

# Each compiled for one instruction set, chosen at run time. Square roots do not set errno, so that
# they can be vectors.
set(tetwarp_vector_options_base -fno-math-errno)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(tetwarp_vector_options_avx2 -fno-math-errno -mavx2)
  set(tetwarp_vector_options_avx512
    -fno-math-errno -mavx2 -mavx512f -mavx512vl -mavx512dq -mprefer-vector-width=512)
  target_sources(tetwarp PRIVATE
    host/simulate/cpu/vector_stages_avx2.cpp host/simulate/cpu/vector_stages_avx512.cpp)
endif()
foreach(set base avx2 avx512)
  set_source_files_properties(host/simulate/cpu/vector_stages_${set}.cpp PROPERTIES
    COMPILE_OPTIONS "${tetwarp_vector_options_${set}}" SKIP_PRECOMPILE_HEADERS ON)
endforeach()
