# Installs the build in BUILD, then configures, builds and runs the programs in EXAMPLES, which
# use only the installed files.
cmake_minimum_required(VERSION 3.22)
set(root ${BUILD}/install_test)
file(REMOVE_RECURSE ${root})

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --config ${CONFIG} --prefix ${root}/prefix)
run(${CMAKE_COMMAND} -S ${EXAMPLES} -B ${root}/examples -G ${GENERATOR}
  -DCMAKE_BUILD_TYPE=${CONFIG} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${CXX_FLAGS}
  -DCMAKE_PREFIX_PATH=${root}/prefix -DCUDAToolkit_ROOT=${CUDA_ROOT})
run(${CMAKE_COMMAND} --build ${root}/examples --config ${CONFIG})
run(${CMAKE_CTEST_COMMAND} --test-dir ${root}/examples -C ${CONFIG} --verbose)
if(WITH_IO)
  # Moved to another folder, the command still finds tetwarp-read, which finds nothing to read.
  file(RENAME ${root}/prefix ${root}/moved)
  run(${CMAKE_COMMAND} -E chdir ${root} ${root}/moved/bin/tetwarp --version)
  file(WRITE ${root}/empty.msh "")
  execute_process(COMMAND ${root}/moved/bin/tetwarp info ${root}/empty.msh ERROR_VARIABLE error)
  if(NOT error MATCHES "does not begin with .MeshFormat|this build cannot read")
    message(FATAL_ERROR "tetwarp-read was not found: ${error}")
  endif()
endif()
