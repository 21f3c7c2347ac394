# Every command and block of code in README.md and docs/ is run; links are checked.
if(NOT TETWARP_PYTHON3)
  add_test(NAME docs COMMAND ${CMAKE_COMMAND} -E echo "skipped: no python3")
  set_tests_properties(docs PROPERTIES LABELS docs SKIP_REGULAR_EXPRESSION skipped)
  return()
endif()

set(tetwarp_pages CHANGELOG CONTRIBUTING README docs/architecture docs/benchmarks docs/compare docs/contact
  docs/coordinates docs/cuda docs/day docs/formats docs/gallery docs/glossary docs/guide docs/python
  docs/scenes docs/screens docs/simulate docs/tried docs/view)
list(TRANSFORM tetwarp_pages REPLACE "(.+)" "${PROJECT_SOURCE_DIR}/\\1.md")
set(tetwarp_docs_test ${TETWARP_PYTHON3} -B ${PROJECT_SOURCE_DIR}/tests/docs/run_docs.py)
add_custom_command(OUTPUT docs_blocks.cpp
  COMMAND ${tetwarp_docs_test} extract ${PROJECT_SOURCE_DIR} docs_blocks.cpp
  DEPENDS ${tetwarp_pages} ${PROJECT_SOURCE_DIR}/tests/docs/run_docs.py
    ${PROJECT_SOURCE_DIR}/tests/docs/pages.py
  COMMENT "C++ blocks of the documentation")
add_executable(docs_blocks ${PROJECT_BINARY_DIR}/docs_blocks.cpp)
target_link_libraries(docs_blocks PRIVATE tetwarp_io)
# Compiled once and run once: -O3 would take longer to compile than it saves.
target_compile_options(docs_blocks PRIVATE $<$<CONFIG:Release>:-O0>)

find_program(TETWARP_XVFB_RUN xvfb-run)
add_test(NAME docs COMMAND ${tetwarp_docs_test} run ${PROJECT_SOURCE_DIR}
  --command $<TARGET_FILE:tetwarp_command> --blocks $<TARGET_FILE:docs_blocks>
  "--mpirun=$<$<BOOL:${TETWARP_HAS_MPI}>:${MPIEXEC_EXECUTABLE}>"
  "--has=$<$<AND:$<BOOL:${TETWARP_HAS_VIEW}>,$<BOOL:${TETWARP_XVFB_RUN}>>:view>"
  "--has=$<$<BOOL:${TETWARP_HAS_GDCM}>:gdcm>" "--has=$<$<BOOL:${TETWARP_HAS_GMSH}>:gmsh>"
  "--has=$<$<BOOL:${TETWARP_HAS_VTK}>:vtk>"
  "--python=$<$<BOOL:${TETWARP_HAS_PYTHON}>:${Python_EXECUTABLE}>"
  --package ${PROJECT_BINARY_DIR}/python)
set_tests_properties(docs PROPERTIES LABELS docs TIMEOUT 300 RESOURCE_LOCK display
  COST 20)  # starts early
