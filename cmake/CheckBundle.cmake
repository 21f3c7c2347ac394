# Fails when a file in FOLDER needs a library that is neither of glibc nor in FOLDER/lib, or when
# the folder's archive exceeds its size limit. Run by target `bundle`.
cmake_minimum_required(VERSION 3.22)
set(largest_mib 60)
file(GLOB_RECURSE files ${FOLDER}/*)
list(FILTER files EXCLUDE REGEX "\\.sh$")
foreach(file IN LISTS files)
  execute_process(COMMAND readelf --dynamic ${file}
    OUTPUT_VARIABLE dynamic COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "\\(NEEDED\\)[^\n]*" entries "${dynamic}")
  foreach(entry IN LISTS entries)
    string(REGEX REPLACE ".*\\[(.*)\\].*" "\\1" library "${entry}")
    if(NOT library MATCHES "^(libc|libm|libdl|libpthread|librt|ld-linux-.*)\\.so"
        AND NOT EXISTS ${FOLDER}/lib/${library})
      message(FATAL_ERROR "${file} needs ${library}, which the bundle does not hold")
    endif()
  endforeach()
endforeach()
get_filename_component(parent ${FOLDER} DIRECTORY)
get_filename_component(name ${FOLDER} NAME)
execute_process(COMMAND ${CMAKE_COMMAND} -E tar czf ${FOLDER}.tar.gz ${name}
  WORKING_DIRECTORY ${parent} COMMAND_ERROR_IS_FATAL ANY)
file(SIZE ${FOLDER}.tar.gz bytes)
math(EXPR mib "${bytes} / 1048576")
if(mib GREATER largest_mib)
  message(FATAL_ERROR "the bundle's archive is ${mib} MiB, more than ${largest_mib}")
endif()
message(STATUS "bundle: ${FOLDER} and ${FOLDER}.tar.gz, ${mib} MiB; needs glibc and nothing else")
