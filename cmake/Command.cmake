# The command `tetwarp`.
add_executable(tetwarp_command
  host/cli/main.cpp
  host/cli/array_checks.cpp
  host/cli/batch.cpp
  host/cli/batch_file.cpp
  host/cli/cmd_contact.cpp
  host/cli/cmd_deform.cpp
  host/cli/cmd_demo.cpp
  host/cli/cmd_export.cpp
  host/cli/cmd_import.cpp
  host/cli/cmd_info.cpp
  host/cli/cmd_mesh.cpp
  host/cli/cmd_render.cpp
  host/cli/cmd_simulate.cpp
  host/cli/cmd_warp.cpp
  host/cli/contact_arguments.cpp
  host/cli/declare.cpp
  host/cli/displacement.cpp
  host/cli/file_checks.cpp
  host/cli/fingerprint.cpp
  host/cli/interrupt.cpp
  host/cli/job_plan.cpp
  host/cli/job_share.cpp
  host/cli/memory_plan.cpp
  host/cli/obstacle_surface.cpp
  host/cli/output_files.cpp
  host/cli/output_writer.cpp
  host/cli/output_grid.cpp
  host/cli/progress_bar.cpp
  host/cli/ranks.cpp
  host/cli/ranks_$<IF:$<BOOL:${TETWARP_HAS_MPI}>,mpi,nompi>.cpp
  host/cli/read_array.cpp
  host/cli/report_exchange.cpp
  host/cli/simulate_arguments.cpp
  host/cli/simulate_bodies.cpp
  host/cli/simulate_contacts.cpp
  host/cli/simulate_frames.cpp
  host/cli/simulate_pictures.cpp
  host/cli/simulate_report.cpp
  host/cli/simulate_run.cpp
  host/cli/simulate_series.cpp
  host/cli/simulate_warp.cpp
  host/cli/source_scan.cpp
  host/cli/step_selection.cpp
  host/cli/volume_run.cpp
  host/cli/volume_run_queue.cpp
  host/cli/volume_run_parts.cpp
  host/cli/volume_run_step.cpp
  host/cli/warnings.cpp
  host/cli/warp_arguments.cpp
  host/cli/warp_job.cpp)
# Eight files per unit: parsing and instantiating their common includes is most of the work.
set_target_properties(tetwarp_command PROPERTIES
  OUTPUT_NAME tetwarp UNITY_BUILD ${TETWARP_UNITY} UNITY_BUILD_BATCH_SIZE 8)
target_include_directories(tetwarp_command PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(tetwarp_command PRIVATE
  tetwarp_io CLI11::CLI11 fmt::fmt nlohmann_json::nlohmann_json tetwarp_options)
target_precompile_headers(tetwarp_command PRIVATE
  <CLI/CLI.hpp> <fmt/format.h> <nlohmann/json.hpp> <tetwarp/io.hpp> <tetwarp/warp.hpp>)
# The command's own code takes little time: -O3 would double its compile time for no gain.
target_compile_options(tetwarp_command PRIVATE $<$<CONFIG:Release>:-O1>)
if(TETWARP_HAS_MPI)
  target_link_libraries(tetwarp_command PRIVATE MPI::MPI_CXX)
endif()
install(TARGETS tetwarp_command)
