# The command `tetwarp`.
add_executable(tetwarp_command)
tetwarp_sources(tetwarp_command host/cli
  main.cpp)
tetwarp_sources(tetwarp_command host/cli/certify
  cmd_certify.cpp)
tetwarp_sources(tetwarp_command host/cli/common
  camera_option.cpp declare.cpp file_checks.cpp interrupt.cpp picture_options.cpp progress_bar.cpp
  ranks.cpp ranks_${tetwarp_mpi}.cpp)
tetwarp_sources(tetwarp_command host/cli/contact
  cmd_contact.cpp contact_arguments.cpp)
tetwarp_sources(tetwarp_command host/cli/job
  array_checks.cpp disk_plan.cpp fingerprint.cpp job_plan.cpp job_result.cpp label_rule_option.cpp memory_plan.cpp
  output_files.cpp output_grid.cpp output_writer.cpp provenance.cpp source_scan.cpp step_selection.cpp warnings.cpp
  warp_arguments.cpp)
tetwarp_sources(tetwarp_command host/cli/simulate
  cmd_simulate.cpp simulate_arguments.cpp simulate_bodies.cpp
  simulate_contacts.cpp simulate_frames.cpp simulate_pictures.cpp simulate_report.cpp
  simulate_run.cpp simulate_series.cpp simulate_warp.cpp)
tetwarp_sources(tetwarp_command host/cli/tools
  chart.cpp cmd_compose.cpp cmd_deform.cpp cmd_demo.cpp cmd_export.cpp cmd_import.cpp cmd_info.cpp
  cmd_invert.cpp cmd_mesh.cpp cmd_plot.cpp cmd_points.cpp cmd_render.cpp displacement.cpp
  mesh_options.cpp read_array.cpp)
tetwarp_sources(tetwarp_command host/cli/view
  cmd_view.cpp)
tetwarp_sources(tetwarp_command host/cli/warp
  batch.cpp batch_file.cpp batch_list.cpp batch_order.cpp cmd_warp.cpp field_inverse.cpp
  image_cells.cpp job_process.cpp job_share.cpp position_bins.cpp transform_chain.cpp
  transform_job.cpp transform_run.cpp warp_job.cpp)
tetwarp_sources(tetwarp_command host/cli/warp/volumes
  block_warper.cpp part_exchange.cpp part_queue.cpp report_exchange.cpp series_in_parts.cpp
  step_writer.cpp volume_blocks.cpp volume_run.cpp volume_sources.cpp volume_steps.cpp
  volume_task.cpp)
set_target_properties(tetwarp_command PROPERTIES
  OUTPUT_NAME tetwarp UNITY_BUILD ${TETWARP_UNITY} UNITY_BUILD_MODE GROUP)
target_include_directories(tetwarp_command PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(tetwarp_command PRIVATE
  tetwarp_view_parts tetwarp_io CLI11::CLI11 fmt::fmt nlohmann_json::nlohmann_json tetwarp_options)
target_precompile_headers(tetwarp_command PRIVATE
  <CLI/CLI.hpp> <fmt/format.h> <nlohmann/json.hpp> <tetwarp/io.hpp> <tetwarp/warp.hpp>)
# The command's own code takes little time: -O3 would double its compile time for no gain.
target_compile_options(tetwarp_command PRIVATE $<$<CONFIG:Release>:-O1>)
if(TETWARP_HAS_MPI)
  target_link_libraries(tetwarp_command PRIVATE MPI::MPI_CXX)
endif()
add_dependencies(tetwarp_command tetwarp_read)
if(TETWARP_HAS_VIEW)
  add_dependencies(tetwarp_command tetwarp_view)
endif()
install(TARGETS tetwarp_command)
