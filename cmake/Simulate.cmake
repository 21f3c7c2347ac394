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
  host/simulate/cpu/stepper_cpu.cpp
  host/simulate/cpu/vector_stages.cpp
  host/simulate/cpu/vector_stages_base.cpp
  host/simulate/cuda/stepper_$<IF:$<BOOL:${TETWARP_HAS_CUDA}>,cuda.cu,nocuda.cpp>
  host/simulate/fingerprint.cpp
  host/simulate/reference_stepper.cpp
  host/simulate/scene_drive.cpp
  host/simulate/scene_loads.cpp
  host/simulate/scene_record.cpp
  host/simulate/simulator.cpp
  host/simulate/simulator_impl.cpp
  host/simulate/simulator_step.cpp
  host/simulate/step_sums.cpp
  host/simulate/system_pattern.cpp)
set(tetwarp_simulate_reference_sources  # host/reference/simulate
  host/reference/simulate/assemble.cpp
  host/reference/simulate/bodies.cpp
  host/reference/simulate/bodies_record.cpp
  host/reference/simulate/cloth_body.cpp
  host/reference/simulate/elements.cpp
  host/reference/simulate/energy.cpp
  host/reference/simulate/fem_body.cpp
  host/reference/simulate/forces.cpp
  host/reference/simulate/image_material.cpp
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
  host/reference/simulate/system.cpp)
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
