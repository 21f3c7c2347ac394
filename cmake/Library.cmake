# tetwarp::tetwarp, the library
# Sources that exist twice, with CUDA and without.
if(TETWARP_HAS_CUDA)
  set(tetwarp_cuda cuda.cu)
else()
  set(tetwarp_cuda nocuda.cpp)
endif()
add_library(tetwarp)
tetwarp_sources(tetwarp host/base
  backend.cpp box_tree.cpp curved_mesh.cpp error.cpp host_tasks.cpp lattice_cells.cpp mesh.cpp names.cpp page_lock.cpp
  parallel.cpp repeated_cells.cpp report.cpp volume.cpp)
tetwarp_sources(tetwarp host/collide
  body_partners.cpp certify.cpp collide_items.cpp exact_integer.cpp grid_plan.cpp known_hits.cpp
  moving_triangles.cpp near_planes.cpp self_clearance.cpp touch_areas.cpp)
tetwarp_sources(tetwarp host/collide/cpu
  detector_cpu.cpp)
tetwarp_sources(tetwarp host/collide/cuda
  detector_${tetwarp_cuda})
tetwarp_sources(tetwarp host/contact
  adhesion.cpp contact_solver.cpp energy.cpp fill_report.cpp modes.cpp report.cpp solve_arrays.cpp)
tetwarp_sources(tetwarp host/contact/block_jacobi
  coupled_system.cpp)
tetwarp_sources(tetwarp host/contact/cuda
  contact_${tetwarp_cuda})
tetwarp_sources(tetwarp host/contact/newton
  associated.cpp augmented_lagrangian.cpp contact_assembly.cpp dense_bodies.cpp natural_map.cpp
  newton.cpp newton_system.cpp pivoting.cpp)
tetwarp_sources(tetwarp host/contact/problem
  budget.cpp checks.cpp delassus.cpp imbalance.cpp matrix.cpp measure.cpp problem.cpp residual.cpp
  row_blocks.cpp row_checks.cpp spring_offset.cpp)
tetwarp_sources(tetwarp host/contact/solve
  certificate.cpp condense.cpp coupled_islands.cpp engine.cpp feasibility.cpp island_attempt.cpp
  island_fallback.cpp island_restart.cpp island_solver.cpp method_choice.cpp status.cpp)
tetwarp_sources(tetwarp host/contact/structure
  color.cpp extract.cpp islands.cpp structure.cpp structure_global.cpp structure_local.cpp
  structure_parts.cpp system.cpp)
tetwarp_sources(tetwarp host/contact/sweeps
  run.cpp)
tetwarp_sources(tetwarp host/contact/tracker
  input_checks.cpp match.cpp record_update.cpp tracker.cpp)
tetwarp_sources(tetwarp host/make
  clear_blocks.cpp deform_mesh.cpp lattice_mesh.cpp phantom.cpp phantom_fish.cpp
  phantom_orange.cpp phantom_organs.cpp phantom_torso.cpp picture_view.cpp render_surfaces.cpp
  render_volume.cpp surface_picture.cpp surface_soup.cpp transfer.cpp volume_rays.cpp)
tetwarp_sources(tetwarp host/reference/contact
  bilateral.cpp contact.cpp dense.cpp enumerate.cpp feasible.cpp gauss_seidel.cpp local.cpp)
tetwarp_sources(tetwarp host/reference/linear
  least_norm.cpp polar_rotation.cpp)
tetwarp_sources(tetwarp host/reference/simulate
  assemble.cpp bodies.cpp body_motion.cpp cloth_body.cpp elements.cpp energy.cpp fem_body.cpp
  forces.cpp image_material.cpp make_system.cpp material_point.cpp motion.cpp
  nearest_material.cpp prescribed.cpp rigid_mass.cpp shares.cpp springs.cpp step_system.cpp
  system.cpp)
tetwarp_sources(tetwarp host/reference/warp
  backend_reference.cpp map_points_reference.cpp nearest_surface.cpp overlap.cpp sample.cpp
  sample_transform.cpp)
tetwarp_sources(tetwarp host/scene
  alike_bodies.cpp body_geometry.cpp image_lattice.cpp isosurface.cpp marching_tets.cpp
  scene_geometry.cpp selection.cpp voxel_owner.cpp voxel_shares.cpp)
tetwarp_sources(tetwarp host/scene/shapes
  cage.cpp lattice.cpp lattice_search.cpp loft.cpp loft_line.cpp ring_surface.cpp rings.cpp
  shape.cpp shape_fraction.cpp shape_lattice.cpp shape_surface.cpp sheet.cpp surface.cpp
  surface_lattice.cpp surface_solid.cpp)
tetwarp_sources(tetwarp host/scene/checks
  check_body.cpp check_geometry.cpp check_motion.cpp check_scene.cpp scene_checks.cpp)
tetwarp_sources(tetwarp host/simulate/contact_step
  adhesion_record.cpp contact_history.cpp contact_impulses.cpp contact_part.cpp contact_passes.cpp
  contact_points.cpp contact_rest.cpp contact_step.cpp end_check.cpp expected_motion.cpp
  part_motion.cpp pressing_impulses.cpp sleeping_contacts.cpp step_groups.cpp)
tetwarp_sources(tetwarp host/simulate/model
  body_points.cpp cloth.cpp fem.cpp image_materials.cpp material_finder.cpp model.cpp motion.cpp
  nearest.cpp rigid.cpp scalar_entries.cpp springs.cpp surface_mesh.cpp tet_materials.cpp
  triangle_cloth.cpp)
tetwarp_sources(tetwarp host/simulate/patches
  pair_contacts.cpp patch_moments.cpp patch_supports.cpp rigid_patches.cpp)
tetwarp_sources(tetwarp host/simulate/run
  body_places.cpp body_sleep.cpp divided_step.cpp fastest_body.cpp moving_bodies.cpp simulator.cpp
  step_records.cpp tet_energies.cpp turning_moments.cpp)
tetwarp_sources(tetwarp host/simulate/state
  added_handles.cpp checkpoint.cpp checkpoint_bytes.cpp fingerprint.cpp host_state.cpp
  island_lists.cpp island_sleep.cpp simulated_scene.cpp simulation_state.cpp step_attempt.cpp
  step_division.cpp)
tetwarp_sources(tetwarp host/simulate/solve/condensed
  condensed_choice.cpp condensed_island.cpp condensed_matrix.cpp condensed_solver.cpp
  system_islands.cpp)
tetwarp_sources(tetwarp host/simulate/solve
  contact_system.cpp deformable_solver.cpp general_solver.cpp)
tetwarp_sources(tetwarp host/simulate/solve/problem
  block_jacobian.cpp contact_constants.cpp contact_islands.cpp contact_laws.cpp contact_rows.cpp
  contact_shares.cpp contact_sides.cpp step_laws.cpp step_problem.cpp step_rows.cpp)
tetwarp_sources(tetwarp host/simulate/solve/two_level
  compliant_list_maker.cpp elastic_groups.cpp elastic_space.cpp group_matrices.cpp
  packed_contacts.cpp residual_check.cpp touching_blocks.cpp touching_matrix.cpp touching_newton.cpp
  touching_sweep.cpp two_level_solver.cpp two_level_start.cpp two_level_step.cpp
  two_level_sweeps.cpp unit_velocities.cpp)
tetwarp_sources(tetwarp host/simulate/start
  cage_growth.cpp cage_pose.cpp inset_places.cpp medial_node.cpp prepare_start.cpp rest_growth.cpp
  start_check.cpp start_movers.cpp start_push.cpp start_shrink.cpp)
tetwarp_sources(tetwarp host/simulate/step
  cell_fields.cpp scene_drive.cpp scene_loads.cpp scene_record.cpp step_sums.cpp system_pattern.cpp
  ALONE reference_rows.cpp reference_stepper.cpp)
tetwarp_sources(tetwarp host/simulate/step/cpu
  block_lu.cpp island_factors.cpp rest_factor.cpp rest_factors.cpp rest_gradients.cpp rest_matrix.cpp row_range_lu.cpp
  stepper_cpu.cpp system_blocks.cpp vector_stages.cpp ALONE vector_stages_base.cpp)
tetwarp_sources(tetwarp host/simulate/step/cuda
  stepper_${tetwarp_cuda})
tetwarp_sources(tetwarp host/simulate/surfaces
  contact_thickness.cpp flat_edges.cpp kept_places.cpp near_pair.cpp pair_materials.cpp
  round_shape.cpp scene_surfaces.cpp surface_motion.cpp)
tetwarp_sources(tetwarp host/warp
  backend_choice.cpp block_mesh.cpp blocks.cpp curve_checks.cpp geometry.cpp hex_split.cpp map_points.cpp
  outside_surface.cpp point_search.cpp step_queue.cpp transform_checks.cpp warper.cpp)
tetwarp_sources(tetwarp host/warp/compose
  compose.cpp field_inverse.cpp image_cells.cpp mesh_inverse.cpp position_bins.cpp)
tetwarp_sources(tetwarp host/warp/cpu
  backend_cpu.cpp cell_overlap.cpp face_neighbors.cpp map_points_cpu.cpp operator_plan.cpp
  operator_taps.cpp overlap_stage_cpu.cpp overlap_weights.cpp resample.cpp resample_blocks_cpu.cpp
  resample_part_cpu.cpp transform_links.cpp voxel_places.cpp warp_operator.cpp ALONE
  cell_cull_cpu.cpp cell_raster_cpu.cpp)
tetwarp_sources(tetwarp host/warp/cpu/rows
  ALONE row_label_cpu.cpp row_resample_cpu.cpp row_scalar.cpp row_transform_cpu.cpp)
tetwarp_sources(tetwarp host/warp/cuda
  backend_${tetwarp_cuda} device_start_${tetwarp_cuda} map_points_${tetwarp_cuda})
if(TETWARP_HAS_CUDA)
  tetwarp_sources(tetwarp kernels/exec
    primitives_cuda.cu)
  target_link_libraries(tetwarp PRIVATE CUDA::cudart_static)
endif()
add_library(tetwarp::tetwarp ALIAS tetwarp)
set_target_properties(tetwarp PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION 0
  UNITY_BUILD ${TETWARP_UNITY} UNITY_BUILD_MODE GROUP)
# Each compiled for one instruction set, chosen at run time. Square roots do not set errno, so that
# they can be vectors. No vector is passed between files, so that its way of passing may differ.
set(tetwarp_vector_options_base -fno-math-errno -Wno-psabi)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(tetwarp_vector_options_avx2 -fno-math-errno -mavx2)
  set(tetwarp_vector_options_avx512
    -fno-math-errno -mavx2 -mavx512f -mavx512vl -mavx512dq -mprefer-vector-width=512)
  tetwarp_sources(tetwarp host/simulate/step/cpu
    ALONE vector_stages_avx2.cpp vector_stages_avx512.cpp)
endif()
foreach(set base avx2 avx512)
  set_source_files_properties(host/simulate/step/cpu/vector_stages_${set}.cpp PROPERTIES
    COMPILE_OPTIONS "${tetwarp_vector_options_${set}}" SKIP_PRECOMPILE_HEADERS ON)
endforeach()
# Highway compiles these files once per vector instruction set. SSE4 is left out: its vectors are as
# wide as those of the baseline (SSSE3), and only processors without AVX2 would use it.
set_source_files_properties(host/warp/cpu/cell_cull_cpu.cpp host/warp/cpu/cell_raster_cpu.cpp
  host/warp/cpu/rows/row_label_cpu.cpp host/warp/cpu/rows/row_resample_cpu.cpp
  host/warp/cpu/rows/row_transform_cpu.cpp
  PROPERTIES COMPILE_DEFINITIONS HWY_DISABLED_TARGETS=HWY_SSE4 SKIP_PRECOMPILE_HEADERS ON)
# A third of the files include Eigen.
target_precompile_headers(tetwarp PRIVATE <algorithm> <string> <vector> <Eigen/Dense> <Eigen/SparseCore>)
target_compile_features(tetwarp PUBLIC cxx_std_20)
target_include_directories(tetwarp
  PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/host> $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/kernels/base>
    $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
  PRIVATE ${PROJECT_SOURCE_DIR})
tetwarp_export_macro(tetwarp export.hpp)
target_link_libraries(tetwarp PRIVATE
  tetwarp_hwy tetwarp_threads $<BUILD_INTERFACE:tetwarp_options> $<BUILD_INTERFACE:Eigen3::Eigen>
  $<BUILD_INTERFACE:nlohmann_json::nlohmann_json>)
set(tetwarp_exported tetwarp tetwarp_hwy tetwarp_threads)
