# Programs from which the linker removes what they do not reach; tests/lint/dead.py compares them with
# what is compiled. In one of them the command runs on the emulated device.
add_executable(tetwarp_emulated_command $<TARGET_OBJECTS:tetwarp_command>)
target_link_libraries(tetwarp_emulated_command PRIVATE
  tetwarp_view_parts tetwarp_io tetwarp_openmp CLI11::CLI11 fmt::fmt nlohmann_json::nlohmann_json)
if(TETWARP_HAS_MPI)
  target_link_libraries(tetwarp_emulated_command PRIVATE MPI::MPI_CXX)
endif()
foreach(part backend contact detector primitives start stepper)
  target_sources(tetwarp_emulated_command PRIVATE $<TARGET_OBJECTS:tetwarp_emulated_${part}>)
endforeach()
foreach(example contact_block progress simulate_warp quickstart warp_series nifti)
  add_executable(tetwarp_example_${example} examples/${example}.cpp)
  target_link_libraries(tetwarp_example_${example} PRIVATE tetwarp_io)
endforeach()
