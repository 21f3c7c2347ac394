# `cmake --install`: libraries, public headers and package files for find_package().
include(CMakePackageConfigHelpers)
set(tetwarp_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/tetwarp)

install(TARGETS ${tetwarp_exported} EXPORT tetwarpTargets)
install(DIRECTORY host/tetwarp kernels/base/tetwarp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY ${PROJECT_BINARY_DIR}/include/tetwarp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(TETWARP_IO)
  install(DIRECTORY io/tetwarp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endif()

if(BUILD_SHARED_LIBS AND TETWARP_IO)  # an installed tree may be moved
  file(RELATIVE_PATH tetwarp_lib_from_bin ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
  file(RELATIVE_PATH tetwarp_lib_from_reader
    ${CMAKE_INSTALL_FULL_LIBEXECDIR}/tetwarp ${CMAKE_INSTALL_FULL_LIBDIR})
  set_target_properties(tetwarp_command PROPERTIES INSTALL_RPATH "$ORIGIN/${tetwarp_lib_from_bin}")
  set_target_properties(tetwarp_read PROPERTIES INSTALL_RPATH "$ORIGIN/${tetwarp_lib_from_reader}")
  set_target_properties(tetwarp_io PROPERTIES INSTALL_RPATH "$ORIGIN")
  if(TETWARP_HAS_VIEW)
    set_target_properties(tetwarp_view PROPERTIES
      INSTALL_RPATH "$ORIGIN/${tetwarp_lib_from_reader}")
  endif()
endif()

install(EXPORT tetwarpTargets NAMESPACE tetwarp:: DESTINATION ${tetwarp_package_dir})
configure_package_config_file(cmake/tetwarpConfig.cmake.in tetwarpConfig.cmake
  INSTALL_DESTINATION ${tetwarp_package_dir})
write_basic_package_version_file(tetwarpConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/tetwarpConfig.cmake ${PROJECT_BINARY_DIR}/tetwarpConfigVersion.cmake
  DESTINATION ${tetwarp_package_dir})
