# tetwarp_bench: the measured cases, one program for all back ends.
find_package(benchmark REQUIRED)
add_executable(tetwarp_bench bench/bench_warp.cpp tests/scenes.cpp)
target_include_directories(tetwarp_bench PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(tetwarp_bench PRIVATE
  tetwarp benchmark::benchmark tetwarp_options)
