# The Python package whose module runs warps of back end cuda on the emulated device, for the tests of
# arrays in the memory of a device.
set(tetwarp_emulated_package ${PROJECT_BINARY_DIR}/emulated_python/tetwarp)
get_target_property(tetwarp_python_libraries tetwarp_python LINK_LIBRARIES)
add_library(tetwarp_emulated_python MODULE $<TARGET_OBJECTS:tetwarp_python>
  $<TARGET_OBJECTS:tetwarp_emulated_backend> $<TARGET_OBJECTS:tetwarp_emulated_primitives>
  $<TARGET_OBJECTS:tetwarp_emulated_start>)
target_link_libraries(tetwarp_emulated_python PRIVATE ${tetwarp_python_libraries} tetwarp_openmp)
set_target_properties(tetwarp_emulated_python PROPERTIES
  PREFIX "" OUTPUT_NAME _core LIBRARY_OUTPUT_DIRECTORY ${tetwarp_emulated_package} LINKER_LANGUAGE CXX)
file(MAKE_DIRECTORY ${tetwarp_emulated_package})
foreach(file IN LISTS tetwarp_python_files)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/python/tetwarp/${file} ${tetwarp_emulated_package}/${file}
    SYMBOLIC)
endforeach()
add_test(NAME python_device
  COMMAND ${Python_EXECUTABLE} ${PROJECT_SOURCE_DIR}/python/tests/run.py -k device)
set_tests_properties(python_device PROPERTIES LABELS python SKIP_RETURN_CODE 77 TIMEOUT 300
  ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1"
  ENVIRONMENT_MODIFICATION "PYTHONPATH=path_list_prepend:${PROJECT_BINARY_DIR}/emulated_python")
