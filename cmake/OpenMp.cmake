# tetwarp_openmp: parallel loops of tests and benchmarks. The library has its own threads, which sleep
# between loops.
include_guard()
add_library(tetwarp_openmp INTERFACE)
find_package(OpenMP COMPONENTS CXX)
if(OpenMP_CXX_FOUND)
  target_link_libraries(tetwarp_openmp INTERFACE OpenMP::OpenMP_CXX)
  target_compile_options(tetwarp_openmp INTERFACE
    $<$<COMPILE_LANGUAGE:CUDA>:-Xcompiler=${OpenMP_CXX_FLAGS}>)
else()
  target_compile_options(tetwarp_openmp INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-Wno-unknown-pragmas>
    $<$<COMPILE_LANGUAGE:CUDA>:-Xcompiler=-Wno-unknown-pragmas>)
endif()
