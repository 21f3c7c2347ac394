# Sources by folder, each list sorted.

# tetwarp_sources(TARGET FOLDER FILE... [ALONE FILE...]): sources of a folder. Parsing their includes
# takes longer than compiling their code, so up to 16 files are compiled as one unit, except those
# that have options of their own or the reference's short names (ALONE).
function(tetwarp_sources target folder)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "" "ALONE")
  string(MAKE_C_IDENTIFIER ${folder} unit)
  list(LENGTH arg_UNPARSED_ARGUMENTS count)
  math(EXPR units "(${count} + 15) / 16")
  set(number 0)
  foreach(file IN LISTS arg_UNPARSED_ARGUMENTS)
    math(EXPR part "${number} * ${units} / ${count}")
    set_source_files_properties(${folder}/${file} PROPERTIES UNITY_GROUP ${unit}_${part})
    math(EXPR number "${number} + 1")
  endforeach()
  list(TRANSFORM arg_UNPARSED_ARGUMENTS PREPEND ${folder}/)
  list(TRANSFORM arg_ALONE PREPEND ${folder}/)
  target_sources(${target} PRIVATE ${arg_UNPARSED_ARGUMENTS} ${arg_ALONE})
endfunction()
