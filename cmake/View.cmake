# Live windows: what needs no window, and the program tetwarp-view, which draws by VTK 9 with X11 and is
# left out where this is missing. `tetwarp view` then names the package.
add_library(tetwarp_view_parts STATIC)
tetwarp_sources(tetwarp_view_parts host/view
  input_log.cpp live_simulation.cpp live_volumes.cpp obstacle_surface.cpp pick.cpp scene_look.cpp
  view_options.cpp view_scene.cpp volume_colors.cpp)
set_target_properties(tetwarp_view_parts PROPERTIES
  UNITY_BUILD ${TETWARP_UNITY} UNITY_BUILD_MODE GROUP)
target_include_directories(tetwarp_view_parts PUBLIC ${PROJECT_SOURCE_DIR})
target_link_libraries(tetwarp_view_parts PUBLIC tetwarp_io PRIVATE tetwarp_options)
target_compile_options(tetwarp_view_parts PRIVATE $<$<CONFIG:Release>:-O1>)

set(TETWARP_VIEW AUTO CACHE STRING "The window of tetwarp view: AUTO, ON or OFF")
set_property(CACHE TETWARP_VIEW PROPERTY STRINGS AUTO ON OFF)
if(TETWARP_BUNDLE)
  set(TETWARP_VIEW OFF)
endif()
set(TETWARP_HAS_VIEW FALSE)
if(NOT TETWARP_VIEW STREQUAL "OFF")
  find_package(VTK 9 QUIET COMPONENTS
    CommonCore CommonDataModel CommonExecutionModel FiltersCore FiltersSources InteractionStyle
    RenderingCore RenderingFreeType RenderingOpenGL2 RenderingUI RenderingVolume
    RenderingVolumeOpenGL2)
  find_package(X11 QUIET)
  if(VTK_FOUND AND X11_FOUND)
    set(TETWARP_HAS_VIEW TRUE)
  elseif(TETWARP_VIEW STREQUAL "ON")
    message(FATAL_ERROR "TETWARP_VIEW=ON, but VTK 9 with X11 was not found; install libvtk9-dev")
  endif()
endif()
message(STATUS "tetwarp: window of tetwarp view: ${TETWARP_HAS_VIEW}")

set(tetwarp_viewer_folder ${CMAKE_INSTALL_LIBEXECDIR}/tetwarp)
file(RELATIVE_PATH tetwarp_viewer_path /${CMAKE_INSTALL_BINDIR} /${tetwarp_viewer_folder})
set_property(SOURCE host/cli/view/cmd_view.cpp PROPERTY COMPILE_DEFINITIONS
  TETWARP_VIEWER_FROM_HERE="${tetwarp_viewer_path}/tetwarp-view"
  TETWARP_VIEWER_INSTALLED="${CMAKE_INSTALL_FULL_LIBEXECDIR}/tetwarp/tetwarp-view")
if(NOT TETWARP_HAS_VIEW)
  return()
endif()
add_executable(tetwarp_view)
tetwarp_sources(tetwarp_view host/view/window
  mouse_style.cpp scene_actors.cpp surface_actor.cpp view_window.cpp volume_actors.cpp
  ALONE main.cpp)
set_target_properties(tetwarp_view PROPERTIES
  OUTPUT_NAME tetwarp-view UNITY_BUILD ${TETWARP_UNITY} UNITY_BUILD_MODE GROUP)
target_link_libraries(tetwarp_view PRIVATE
  tetwarp_view_parts fmt::fmt ${VTK_LIBRARIES} ${X11_LIBRARIES} tetwarp_options)
target_include_directories(tetwarp_view SYSTEM PRIVATE ${X11_INCLUDE_DIR})
target_compile_options(tetwarp_view PRIVATE $<$<CONFIG:Release>:-O1>)
vtk_module_autoinit(TARGETS tetwarp_view MODULES ${VTK_LIBRARIES})
install(TARGETS tetwarp_view DESTINATION ${tetwarp_viewer_folder})
