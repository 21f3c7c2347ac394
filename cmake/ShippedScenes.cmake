# shipped_scenes.cpp: the scenes of scenes/ as texts, read when the build is configured.
set(tetwarp_scene_names
  candy cantilever carps chain cloth cloth_peels mouth oranges peel sheet shoulder top torso)
set(TETWARP_SCENES "")
foreach(name IN LISTS tetwarp_scene_names)
  set(file ${PROJECT_SOURCE_DIR}/scenes/${name}.json)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  string(APPEND TETWARP_SCENES "    {\"${name}\", R\"scene(${text})scene\"},\n")
endforeach()
configure_file(io/shipped_scenes.cpp.in ${PROJECT_BINARY_DIR}/shipped_scenes.cpp @ONLY)
