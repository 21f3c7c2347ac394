# Compares displacement fields with ITK where it is installed (libinsighttoolkit5-dev).
set(TETWARP_ITK_TESTS AUTO CACHE STRING "Tests against ITK: AUTO, ON or OFF")
set_property(CACHE TETWARP_ITK_TESTS PROPERTY STRINGS AUTO ON OFF)

function(tetwarp_add_itk_tests)  # in a function, to keep the hundreds of variables that ITK sets local
  set(ITK_FOUND FALSE)
  if(NOT TETWARP_ITK_TESTS STREQUAL "OFF")
    set(CMAKE_MESSAGE_LOG_LEVEL WARNING)  # hides its notes about optional programs
    find_package(ITK 5 QUIET COMPONENTS ITKImageGrid ITKIONIFTI)
    unset(CMAKE_MESSAGE_LOG_LEVEL)
  endif()
  if(TETWARP_ITK_TESTS STREQUAL "ON" AND NOT ITK_FOUND)
    message(FATAL_ERROR "TETWARP_ITK_TESTS=ON, but ITK 5 was not found; install libinsighttoolkit5-dev")
  endif()
  message(STATUS "tetwarp: tests against ITK: ${ITK_FOUND}")
  if(NOT ITK_FOUND)
    add_test(NAME itk_warp COMMAND ${CMAKE_COMMAND} -E echo
      "skipped: built without ITK 5 (libinsighttoolkit5-dev, -DTETWARP_ITK_TESTS=ON)")
    set_tests_properties(itk_warp PROPERTIES LABELS io SKIP_REGULAR_EXPRESSION "skipped:")
    return()
  endif()
  tetwarp_add_tests(tetwarp_itk_tests LIBRARIES tetwarp_io tetwarp_hdf5 ${ITK_LIBRARIES} SOURCES
    tests/io/test_itk_warp.cpp)
  target_include_directories(tetwarp_itk_tests SYSTEM PRIVATE ${ITK_INCLUDE_DIRS})
  tetwarp_discover(tetwarp_itk_tests io)
endfunction()
tetwarp_add_itk_tests()
