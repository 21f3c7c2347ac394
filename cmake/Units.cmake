# Compiled together: parsing the includes of these files takes longer than compiling their code.
# tetwarp_unit(NAME FILE...): units of at most eight files
function(tetwarp_unit name)
  set(number 0)
  foreach(file IN LISTS ARGN)
    math(EXPR unit "${number} / 8")
    set_source_files_properties(${file} PROPERTIES UNITY_GROUP ${name}_${unit})
    math(EXPR number "${number} + 1")
  endforeach()
endfunction()
tetwarp_unit(measure host/contact/tracker/match.cpp host/contact/problem/matrix.cpp
  host/contact/problem/measure.cpp host/contact/newton/natural_map.cpp)
tetwarp_unit(newton host/contact/newton/newton.cpp host/contact/newton/newton_system.cpp
  host/contact/newton/pivoting.cpp)
tetwarp_unit(fallback host/contact/newton/associated.cpp host/contact/newton/contact_assembly.cpp
  host/contact/island_fallback.cpp host/contact/island_restart.cpp)
tetwarp_unit(structure host/contact/problem/problem.cpp host/contact/report.cpp
  host/contact/problem/residual.cpp host/contact/problem/imbalance.cpp host/contact/sweeps/run.cpp
  host/contact/structure/structure.cpp host/contact/structure/structure_global.cpp)
tetwarp_unit(engine host/contact/contact_solver.cpp host/contact/solve_arrays.cpp
  host/contact/certificate.cpp host/contact/status.cpp host/contact/condense.cpp
  host/contact/energy.cpp host/contact/engine.cpp host/contact/engine_coupled.cpp
  host/contact/fill_report.cpp host/contact/adhesion.cpp host/contact/modes.cpp
  host/contact/method_choice.cpp host/contact/feasibility.cpp
  host/contact/block_jacobi/coupled_system.cpp host/contact/problem/budget.cpp
  host/contact/problem/delassus.cpp)
tetwarp_unit(contact_rows host/contact/problem/checks.cpp host/contact/problem/row_blocks.cpp
  host/contact/problem/row_checks.cpp host/contact/problem/row_solution.cpp
  host/contact/problem/spring_offset.cpp host/contact/tracker/input_checks.cpp
  host/contact/tracker/record_update.cpp host/contact/tracker/tracker.cpp
  host/contact/structure/color.cpp host/contact/structure/extract.cpp
  host/contact/structure/islands.cpp host/contact/structure/system.cpp)
tetwarp_unit(base host/base/volume.cpp host/base/mesh.cpp host/base/error.cpp host/base/names.cpp
  host/base/parallel.cpp host/base/backend.cpp host/base/report.cpp host/base/page_lock.cpp)
tetwarp_unit(warp host/warp/hex_split.cpp host/warp/transform_checks.cpp host/warp/warper.cpp
  host/warp/block_mesh.cpp host/warp/blocks.cpp host/warp/geometry.cpp host/warp/step_queue.cpp)
get_target_property(files tetwarp SOURCES)
foreach(folder make collide simulate simulate/run simulate/model simulate/contact)
  set(unit ${files})
  list(FILTER unit INCLUDE REGEX "^host/${folder}/[a-z_0-9]+[.]cpp$")
  list(FILTER unit EXCLUDE REGEX "/reference_")
  string(REPLACE "/" "_" name ${folder})
  tetwarp_unit(${name} ${unit})
endforeach()
tetwarp_unit(geometry ${tetwarp_geometry_sources})
tetwarp_unit(simulate_reference ${tetwarp_simulate_reference_sources})
