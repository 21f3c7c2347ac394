# tetwarp::io, the files
include(cmake/MeshImport.cmake)
include(cmake/ShippedScenes.cmake)
# Sources that exist twice, with an optional library and without.
foreach(library gdcm gif gmsh mpi vtk)
  string(TOUPPER ${library} upper)
  if(TETWARP_HAS_${upper})
    set(tetwarp_${library} ${library})
  else()
    set(tetwarp_${library} no${library})
  endif()
endforeach()
add_library(tetwarp_io ${PROJECT_BINARY_DIR}/shipped_scenes.cpp)
tetwarp_sources(tetwarp_io io/child
  child_process.cpp foreign_image.cpp foreign_source.cpp image_kind.cpp reader_program.cpp)
tetwarp_sources(tetwarp_io io/fclib
  contact_checkpoint.cpp fclib.cpp fclib_contact.cpp fclib_left_out.cpp fclib_matrix.cpp
  fclib_numbers.cpp fclib_rows.cpp fclib_write.cpp)
tetwarp_sources(tetwarp_io io/files
  extension.cpp finished_file.cpp input_check.cpp leftover_files.cpp memory.cpp names.cpp
  numbered_files.cpp read_check.cpp scratch_file.cpp sha256.cpp sink_checks.cpp text_file.cpp)
tetwarp_sources(tetwarp_io io/h5
  h5.cpp h5_attribute.cpp h5_disk.cpp h5_output.cpp h5_read.cpp h5_rows.cpp h5_write.cpp
  value_names.cpp)
tetwarp_sources(tetwarp_io io/image
  image_header.cpp image_volume.cpp image_write.cpp meta_header.cpp mgh_header.cpp
  nrrd_header.cpp nrrd_words.cpp vti_write.cpp)
tetwarp_sources(tetwarp_io io/import
  coarse_surface.cpp merge_cells.cpp mesh_child.cpp mesh_import.cpp
  split_cells.cpp)
tetwarp_sources(tetwarp_io io/nifti
  nifti_components.cpp nifti_extension.cpp nifti_facts.cpp nifti_fields.cpp nifti_grid.cpp
  nifti_header.cpp nifti_samples.cpp nifti_volume.cpp nifti_write.cpp)
tetwarp_sources(tetwarp_io io/picture
  film_${tetwarp_gif}.cpp palette.cpp png_image.cpp)
tetwarp_sources(tetwarp_io io/points
  foreign_points.cpp markup_points.cpp point_file.cpp text_points.cpp vtkhdf_points.cpp)
tetwarp_sources(tetwarp_io io/scene
  scene_actions.cpp scene_body.cpp scene_contact.cpp scene_file.cpp scene_files.cpp
  scene_geometry.cpp scene_json.cpp scene_loft.cpp scene_motion.cpp transfer_file.cpp)
tetwarp_sources(tetwarp_io io/transforms
  field_file.cpp fsl_field.cpp itk_flat_transform.cpp itk_transform.cpp itk_transform_files.cpp
  transform_file.cpp)
tetwarp_sources(tetwarp_io io/volume
  file_kind.cpp itk_space.cpp label_source.cpp mesh_arrays.cpp mesh_reader.cpp output_check.cpp
  times_warning.cpp volume_file.cpp)
tetwarp_sources(tetwarp_io io/vtkhdf
  series_reader.cpp simulation_mesh.cpp simulation_points.cpp simulation_series.cpp
  surface_file.cpp surface_reader.cpp vtkhdf_array.cpp vtkhdf_cells.cpp vtkhdf_image.cpp
  vtkhdf_input.cpp vtkhdf_mesh_file.cpp vtkhdf_output.cpp vtkhdf_volume.cpp vtkhdf_write.cpp
  vtkhdf_write_mesh.cpp)
add_library(tetwarp::io ALIAS tetwarp_io)
set_target_properties(tetwarp_io PROPERTIES EXPORT_NAME io VERSION ${PROJECT_VERSION} SOVERSION 0
  UNITY_BUILD ${TETWARP_UNITY} UNITY_BUILD_MODE GROUP)
target_include_directories(tetwarp_io
  PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/io> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
  PRIVATE ${PROJECT_SOURCE_DIR})
tetwarp_export_macro(tetwarp_io io_export.hpp)
target_link_libraries(tetwarp_io PUBLIC tetwarp
  PRIVATE tetwarp_hdf5 tetwarp_nifti tetwarp_png tetwarp_gif ${CMAKE_DL_LIBS}
    $<BUILD_INTERFACE:tetwarp_options> $<BUILD_INTERFACE:nlohmann_json::nlohmann_json>)
list(APPEND tetwarp_exported tetwarp_io tetwarp_hdf5 tetwarp_nifti tetwarp_png tetwarp_gif)

# The program tetwarp-read, which tetwarp::io starts to read meshes by VTK and Gmsh: they crash on
# some damaged files. It is compiled with what it needs of tetwarp::io, since a shared library hides
# its private code.
add_library(tetwarp_reader STATIC)
tetwarp_sources(tetwarp_reader io/child
  image_kind.cpp)
tetwarp_sources(tetwarp_reader io/files
  extension.cpp memory.cpp numbered_files.cpp)
tetwarp_sources(tetwarp_reader io/image
  dicom_stack.cpp image_header.cpp)
tetwarp_sources(tetwarp_reader io/volume
  mesh_arrays.cpp)
tetwarp_sources(tetwarp_reader io/reader
  dicom_${tetwarp_gdcm}.cpp image_readers.cpp mesh_${tetwarp_gmsh}.cpp mesh_readers.cpp
  mesh_sender.cpp mesh_${tetwarp_vtk}.cpp)
if(TETWARP_HAS_GDCM)
  tetwarp_sources(tetwarp_reader io/reader
    ALONE dicom_frames.cpp)
endif()
if(TETWARP_HAS_VTK)
  tetwarp_sources(tetwarp_reader io/reader
    coarsen_vtk.cpp image_vtk.cpp mesh_vtk_arrays.cpp surface_seams.cpp surface_vtk.cpp vtk_file_list.cpp
    vtk_point_set.cpp vtk_steps.cpp)
endif()
set_target_properties(tetwarp_reader PROPERTIES UNITY_BUILD ${TETWARP_UNITY} UNITY_BUILD_MODE GROUP)
target_include_directories(tetwarp_reader PUBLIC ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/io)
target_link_libraries(tetwarp_reader PUBLIC tetwarp PRIVATE tetwarp_mesh_import tetwarp_options
  nlohmann_json::nlohmann_json)
add_executable(tetwarp_read io/reader/main.cpp)
set_target_properties(tetwarp_read PROPERTIES OUTPUT_NAME tetwarp-read)
target_link_libraries(tetwarp_read PRIVATE tetwarp_reader tetwarp_options)

# Where tetwarp::io searches it once it is installed: from its own folder, which is that of a program
# with the static library, and where this build is configured to be installed.
set(tetwarp_reader_folder ${CMAKE_INSTALL_LIBEXECDIR}/tetwarp)
if(BUILD_SHARED_LIBS)
  file(RELATIVE_PATH tetwarp_reader_path /${CMAKE_INSTALL_LIBDIR} /${tetwarp_reader_folder})
else()
  file(RELATIVE_PATH tetwarp_reader_path /${CMAKE_INSTALL_BINDIR} /${tetwarp_reader_folder})
endif()
set_property(SOURCE io/child/reader_program.cpp PROPERTY COMPILE_DEFINITIONS
  TETWARP_READER_FROM_HERE="${tetwarp_reader_path}/tetwarp-read"
  TETWARP_READER_INSTALLED="${CMAKE_INSTALL_FULL_LIBEXECDIR}/tetwarp/tetwarp-read")
install(TARGETS tetwarp_read DESTINATION ${tetwarp_reader_folder})
