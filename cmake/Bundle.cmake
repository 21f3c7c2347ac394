# Target `bundle`: a folder with the programs and the shared libraries that they need besides glibc,
# to be copied to a machine that has only a CUDA driver.
set(tetwarp_bundled tetwarp_tests tetwarp_stress_tests tetwarp_device_tests
  tetwarp_device_simulate_tests)
if(TETWARP_IO)
  list(APPEND tetwarp_bundled tetwarp_command tetwarp_read)
endif()
if(TETWARP_BENCH)
  list(APPEND tetwarp_bundled tetwarp_bench tetwarp_bench_simulate)
  if(TETWARP_IO)
    list(APPEND tetwarp_bundled tetwarp_bench_contact)
  endif()
endif()
# RPATH, not RUNPATH: it also applies to the libraries that libraries need. The folder must be
# called lib, because libniftiio looks there for its own dependencies.
set_target_properties(${tetwarp_bundled} PROPERTIES
  BUILD_WITH_INSTALL_RPATH ON INSTALL_RPATH "$ORIGIN/lib")
foreach(program IN LISTS tetwarp_bundled)
  target_link_options(${program} PRIVATE -Wl,--disable-new-dtags)
  list(APPEND tetwarp_bundled_files $<TARGET_FILE:${program}>)
endforeach()
add_custom_target(bundle
  COMMAND ${CMAKE_COMMAND} "-DPROGRAMS=${tetwarp_bundled_files}" -DSTRIP=${CMAKE_STRIP}
    -DFOLDER=${PROJECT_BINARY_DIR}/bundle -P ${PROJECT_SOURCE_DIR}/cmake/MakeBundle.cmake
  COMMAND ${CMAKE_COMMAND} -E copy
    ${PROJECT_SOURCE_DIR}/cmake/run_on_device.sh ${PROJECT_BINARY_DIR}/bundle
  COMMAND ${CMAKE_COMMAND}
    -DFOLDER=${PROJECT_BINARY_DIR}/bundle -P ${PROJECT_SOURCE_DIR}/cmake/CheckBundle.cmake
  COMMAND ${PROJECT_BINARY_DIR}/bundle/run_on_device.sh list  # fails when a filter matches nothing
  DEPENDS ${tetwarp_bundled} VERBATIM)
