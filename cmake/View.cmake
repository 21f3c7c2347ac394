# Live windows: what needs no window, and the program tetwarp-view, which draws by VTK 9 with X11 and is
# left out where this is missing. `tetwarp view` then names the package.
add_library(tetwarp_view_parts STATIC)
tetwarp_sources(tetwarp_view_parts host/view
  body_carrier.cpp camera_keys.cpp curve_editor.cpp finger_pair.cpp grab_handle.cpp input_delay.cpp
  input_log.cpp live_simulation.cpp live_start.cpp live_volumes.cpp overlay_text.cpp pick.cpp
  ray_quality.cpp view_options.cpp view_scene.cpp view_tools.cpp volume_colors.cpp)
tetwarp_sources(tetwarp_view_parts host/view/devices
  input_device.cpp number_line.cpp simulated_device.cpp tracked_names.cpp)
tetwarp_sources(tetwarp_view_parts host/view/hand
  device_hand.cpp room_place.cpp scene_hand.cpp)
tetwarp_sources(tetwarp_view_parts host/view/look
  look_surfaces.cpp obstacle_surface.cpp scene_look.cpp slice_look.cpp surface_values.cpp
  value_colors.cpp)
tetwarp_sources(tetwarp_view_parts host/view/screens
  off_axis.cpp room.cpp room_file.cpp scene_sharer.cpp screen_keys.cpp screen_message.cpp
  shared_scene.cpp shared_state.cpp swap_group.cpp)
# shipped_rooms.cpp: the rooms of scenes/rooms/ as texts, read when the build is configured.
set(TETWARP_ROOMS "")
foreach(name amphitheatre cube wall)
  set(file ${PROJECT_SOURCE_DIR}/scenes/rooms/${name}.json)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  string(APPEND TETWARP_ROOMS "    {\"${name}\", R\"room(${text})room\"},\n")
endforeach()
configure_file(host/view/screens/shipped_rooms.cpp.in ${PROJECT_BINARY_DIR}/shipped_rooms.cpp @ONLY)
target_sources(tetwarp_view_parts PRIVATE ${PROJECT_BINARY_DIR}/shipped_rooms.cpp)
set_target_properties(tetwarp_view_parts PROPERTIES
  UNITY_BUILD ${TETWARP_UNITY} UNITY_BUILD_MODE GROUP)
target_include_directories(tetwarp_view_parts PUBLIC ${PROJECT_SOURCE_DIR})
target_link_libraries(tetwarp_view_parts PUBLIC tetwarp_io
  PRIVATE fmt::fmt nlohmann_json::nlohmann_json tetwarp_options)
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
    RenderingAnnotation RenderingCore RenderingFreeType RenderingOpenGL2 RenderingUI RenderingVolume
    RenderingVolumeOpenGL2)
  find_package(X11 QUIET)
  if(VTK_FOUND AND X11_FOUND)
    set(TETWARP_HAS_VIEW TRUE)
  elseif(TETWARP_VIEW STREQUAL "ON")
    message(FATAL_ERROR "TETWARP_VIEW=ON, but VTK 9 with X11 was not found; install libvtk9-dev")
  endif()
endif()
message(STATUS "tetwarp: window of tetwarp view: ${TETWARP_HAS_VIEW}")

# ---- screens of a room, by ZeroMQ; rooms of ParaView, by expat
set(TETWARP_SCREENS AUTO CACHE STRING "Screens of tetwarp view: AUTO, ON or OFF")
set_property(CACHE TETWARP_SCREENS PROPERTY STRINGS AUTO ON OFF)
set(TETWARP_HAS_SCREENS FALSE)
if(TETWARP_HAS_VIEW AND NOT TETWARP_SCREENS STREQUAL "OFF")
  find_path(TETWARP_ZMQ_INCLUDE zmq_addon.hpp)
  find_library(TETWARP_ZMQ_LIBRARY zmq)
  find_package(EXPAT QUIET)
  if(TETWARP_ZMQ_INCLUDE AND TETWARP_ZMQ_LIBRARY AND EXPAT_FOUND)
    set(TETWARP_HAS_SCREENS TRUE)
  endif()
endif()
if(TETWARP_SCREENS STREQUAL "ON" AND NOT TETWARP_HAS_SCREENS)
  message(FATAL_ERROR "TETWARP_SCREENS=ON, but the window of tetwarp view, ZeroMQ, its C++ headers or "
    "expat were not found; install libvtk9-dev, libzmq3-dev, cppzmq-dev and libexpat1-dev")
endif()
message(STATUS "tetwarp: screens of tetwarp view: ${TETWARP_HAS_SCREENS}")

set(tetwarp_viewer_folder ${CMAKE_INSTALL_LIBEXECDIR}/tetwarp)
file(RELATIVE_PATH tetwarp_viewer_path /${CMAKE_INSTALL_BINDIR} /${tetwarp_viewer_folder})
set_property(SOURCE host/cli/view/cmd_view.cpp PROPERTY COMPILE_DEFINITIONS
  TETWARP_VIEWER_FROM_HERE="${tetwarp_viewer_path}/tetwarp-view"
  TETWARP_VIEWER_INSTALLED="${CMAKE_INSTALL_FULL_LIBEXECDIR}/tetwarp/tetwarp-view")
if(NOT TETWARP_HAS_VIEW)
  return()
endif()
if(TETWARP_HAS_SCREENS)
  add_library(tetwarp_view_link STATIC)
  tetwarp_sources(tetwarp_view_link host/view/link
    room_pvx.cpp screen_link.cpp screen_server.cpp sockets.cpp)
  set_target_properties(tetwarp_view_link PROPERTIES
    UNITY_BUILD ${TETWARP_UNITY} UNITY_BUILD_MODE GROUP)
  target_include_directories(tetwarp_view_link SYSTEM PUBLIC ${TETWARP_ZMQ_INCLUDE})
  target_link_libraries(tetwarp_view_link
    PUBLIC tetwarp_view_parts ${TETWARP_ZMQ_LIBRARY} PRIVATE EXPAT::EXPAT tetwarp_options)
  target_compile_options(tetwarp_view_link PRIVATE $<$<CONFIG:Release>:-O1>)
  set(tetwarp_screen_sources head_sender.cpp screen_window.cpp screens_zmq.cpp)
else()
  set(tetwarp_screen_sources screens_nozmq.cpp)
endif()

# ---- devices beside mouse and keys, each by its library
add_library(tetwarp_view_devices STATIC)
find_package(SDL2 QUIET)
find_path(TETWARP_SPNAV_INCLUDE spnav.h)
find_library(TETWARP_SPNAV_LIBRARY spnav)
set(TETWARP_VRPN AUTO CACHE STRING "Trackers and wands of tetwarp view: AUTO, ON or OFF")
set_property(CACHE TETWARP_VRPN PROPERTY STRINGS AUTO ON OFF)
set(TETWARP_HAS_VRPN FALSE)
if(NOT TETWARP_VRPN STREQUAL "OFF")
  find_path(TETWARP_VRPN_INCLUDE vrpn_Tracker.h)
  find_library(TETWARP_VRPN_LIBRARY vrpn HINTS ${TETWARP_VRPN_INCLUDE}/../lib)
  find_library(TETWARP_QUAT_LIBRARY quat HINTS ${TETWARP_VRPN_INCLUDE}/../lib)  # a part of VRPN
  if(TETWARP_VRPN_INCLUDE AND TETWARP_VRPN_LIBRARY AND TETWARP_QUAT_LIBRARY)
    set(TETWARP_HAS_VRPN TRUE)
  elseif(TETWARP_VRPN STREQUAL "ON")
    message(FATAL_ERROR "TETWARP_VRPN=ON, but VRPN was not found; install it from github.com/vrpn/vrpn "
      "and set CMAKE_PREFIX_PATH to where it is")
  endif()
endif()
set(tetwarp_device_sources gamepad_nosdl.cpp space_mouse_nospnav.cpp tracked_device_novrpn.cpp)
if(TARGET SDL2::SDL2)  # some packages have none
  list(TRANSFORM tetwarp_device_sources REPLACE "nosdl" "sdl")
  target_link_libraries(tetwarp_view_devices PRIVATE SDL2::SDL2)
endif()
if(TETWARP_SPNAV_INCLUDE AND TETWARP_SPNAV_LIBRARY)
  list(TRANSFORM tetwarp_device_sources REPLACE "nospnav" "spnav")
  target_include_directories(tetwarp_view_devices SYSTEM PRIVATE ${TETWARP_SPNAV_INCLUDE})
  target_link_libraries(tetwarp_view_devices PRIVATE ${TETWARP_SPNAV_LIBRARY} ${X11_LIBRARIES})
endif()
if(TETWARP_HAS_VRPN)
  list(TRANSFORM tetwarp_device_sources REPLACE "novrpn" "vrpn")
  add_library(tetwarp_vrpn INTERFACE)
  target_include_directories(tetwarp_vrpn SYSTEM INTERFACE ${TETWARP_VRPN_INCLUDE})
  target_compile_definitions(tetwarp_vrpn INTERFACE VRPN_CLIENT_ONLY)
  target_link_libraries(tetwarp_vrpn INTERFACE
    ${TETWARP_VRPN_LIBRARY} ${TETWARP_QUAT_LIBRARY} Threads::Threads)
  target_link_libraries(tetwarp_view_devices PRIVATE tetwarp_vrpn)
endif()
tetwarp_sources(tetwarp_view_devices host/view/devices open_devices.cpp ${tetwarp_device_sources})
target_link_libraries(tetwarp_view_devices PUBLIC tetwarp_view_parts PRIVATE tetwarp_options)
target_compile_options(tetwarp_view_devices PRIVATE $<$<CONFIG:Release>:-O1>)
message(STATUS "tetwarp: devices of tetwarp view: ${tetwarp_device_sources}")

add_executable(tetwarp_view)
tetwarp_sources(tetwarp_view host/view/window
  curve_panel.cpp cut_plane.cpp full_screen.cpp mouse_style.cpp picture_meter.cpp pointer.cpp
  scene_actors.cpp
  ${tetwarp_screen_sources} surface_actor.cpp value_legend.cpp view_window.cpp volume_actors.cpp
  window_camera.cpp window_film.cpp window_picture.cpp window_texts.cpp
  ALONE main.cpp)
set_target_properties(tetwarp_view PROPERTIES
  OUTPUT_NAME tetwarp-view UNITY_BUILD ${TETWARP_UNITY} UNITY_BUILD_MODE GROUP)
target_link_libraries(tetwarp_view PRIVATE
  tetwarp_view_devices tetwarp_view_parts fmt::fmt ${VTK_LIBRARIES} ${X11_LIBRARIES} tetwarp_options)
if(TETWARP_HAS_SCREENS)
  target_link_libraries(tetwarp_view PRIVATE tetwarp_view_link)
endif()
target_include_directories(tetwarp_view SYSTEM PRIVATE ${X11_INCLUDE_DIR})
target_compile_options(tetwarp_view PRIVATE $<$<CONFIG:Release>:-O1>)
vtk_module_autoinit(TARGETS tetwarp_view MODULES ${VTK_LIBRARIES})
install(TARGETS tetwarp_view DESTINATION ${tetwarp_viewer_folder})
install(DIRECTORY scenes/rooms DESTINATION ${CMAKE_INSTALL_DATADIR}/tetwarp)
