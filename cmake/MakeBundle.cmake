# Fills FOLDER with stripped copies of PROGRAMS, and FOLDER/lib with the libraries that they need
# beyond glibc. Run by target `bundle`.
cmake_minimum_required(VERSION 3.22)
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER}/lib)
file(GET_RUNTIME_DEPENDENCIES
  EXECUTABLES ${PROGRAMS}
  RESOLVED_DEPENDENCIES_VAR libraries
  PRE_EXCLUDE_REGEXES "^(libc|libm|libdl|libpthread|librt|ld-linux-.*)\\.so")
foreach(library IN LISTS libraries)
  get_filename_component(name ${library} NAME)
  file(COPY_FILE ${library} ${FOLDER}/lib/${name})  # files, not links: copying tools may drop links
endforeach()
foreach(program IN LISTS PROGRAMS)
  get_filename_component(name ${program} NAME)
  execute_process(COMMAND ${STRIP} -o ${FOLDER}/${name} ${program} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
