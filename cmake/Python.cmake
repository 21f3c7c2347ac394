# The Python package `tetwarp`: the module tetwarp._core, which links the library as it is (all its
# files are position independent already), and the files of python/tetwarp beside it. In the build
# folder python/tetwarp is complete: PYTHONPATH=<build>/python. `pip install` builds and installs the
# same targets (pyproject.toml).
set(TETWARP_HAS_PYTHON FALSE)
set(tetwarp_python_missing "wish for it: TETWARP_PYTHON is OFF")
if(NOT TETWARP_PYTHON STREQUAL "OFF")
  find_package(Python 3.9 QUIET
    COMPONENTS Interpreter Development.Module ${SKBUILD_SABI_COMPONENT})
  if(Python_Development.Module_FOUND AND Python_Interpreter_FOUND)
    execute_process(COMMAND ${Python_EXECUTABLE} -m nanobind --cmake_dir
      OUTPUT_VARIABLE tetwarp_nanobind OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    find_package(nanobind QUIET CONFIG HINTS ${tetwarp_nanobind})
    if(nanobind_FOUND AND NOT nanobind_VERSION VERSION_LESS 2.4)
      set(TETWARP_HAS_PYTHON TRUE)
    else()
      set(tetwarp_python_missing "nanobind; ${Python_EXECUTABLE} -m pip install nanobind")
    endif()
  else()
    set(tetwarp_python_missing "the headers of Python 3.9 or later")
  endif()
  if(TETWARP_PYTHON STREQUAL "ON" AND NOT TETWARP_HAS_PYTHON)
    message(FATAL_ERROR "TETWARP_PYTHON=ON, but there is no ${tetwarp_python_missing}")
  endif()
endif()
message(STATUS "tetwarp: Python package: ${TETWARP_HAS_PYTHON}")
if(NOT TETWARP_HAS_PYTHON)
  return()
endif()

set(tetwarp_python_abi)
if(SKBUILD_SABI_COMPONENT)  # set from CPython 3.12 on, by pyproject.toml
  set(tetwarp_python_abi STABLE_ABI)
endif()
nanobind_add_module(tetwarp_python ${tetwarp_python_abi} NB_STATIC NB_SUPPRESS_WARNINGS
  NB_DOMAIN tetwarp
  python/array_warper.cpp python/arrays.cpp python/bind_certify.cpp python/bind_compose.cpp python/bind_contact.cpp
  python/bind_files.cpp python/bind_mesh.cpp python/bind_operator.cpp python/bind_resample.cpp python/bind_simulate.cpp
  python/bind_tracker.cpp python/bind_volume.cpp python/bind_warp.cpp python/interruption.cpp python/module.cpp)
set(tetwarp_package ${PROJECT_BINARY_DIR}/python/tetwarp)
set_target_properties(tetwarp_python PROPERTIES
  OUTPUT_NAME _core LIBRARY_OUTPUT_DIRECTORY ${tetwarp_package}
  UNITY_BUILD ${TETWARP_UNITY} UNITY_BUILD_BATCH_SIZE 3)
target_include_directories(tetwarp_python PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(tetwarp_python PRIVATE tetwarp_io tetwarp_options)
if(TETWARP_BUNDLE)
  # HDF5 is in the module and hidden: h5py brings another one into the same process.
  target_sources(tetwarp_python PRIVATE python/standard_streams.c)
  target_link_options(tetwarp_python PRIVATE
    -Wl,--exclude-libs,ALL -Wl,--wrap=stdout -Wl,--wrap=stderr)
endif()

set(tetwarp_python_files __init__.py _arrays.py _autograd.py _bridges.py _certify.py _compose.py _contact.py
  _device.py _dicom.py _fields.py _files.py _grid.py _mesh.py _operator.py _packages.py _resample.py
  _result.py _simulate.py _sources.py _tracker.py _values.py _volume.py _warp.py _warper.py py.typed)
file(MAKE_DIRECTORY ${tetwarp_package})
foreach(file IN LISTS tetwarp_python_files)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/python/tetwarp/${file} ${tetwarp_package}/${file} SYMBOLIC)
endforeach()
# The module searches it in its own folder.
file(CREATE_LINK ${PROJECT_BINARY_DIR}/tetwarp-read ${tetwarp_package}/tetwarp-read SYMBOLIC)
add_dependencies(tetwarp_python tetwarp_read)
nanobind_add_stub(tetwarp_python_stub MODULE _core PYTHON_PATH ${tetwarp_package}
  OUTPUT ${tetwarp_package}/_core.pyi DEPENDS tetwarp_python)

if(SKBUILD)
  # Everything lies in the package: module and command search the reader beside them.
  install(TARGETS tetwarp_python tetwarp_command tetwarp_read
    LIBRARY DESTINATION tetwarp COMPONENT python RUNTIME DESTINATION tetwarp COMPONENT python)
  install(FILES ${tetwarp_package}/_core.pyi DESTINATION tetwarp COMPONENT python)
  install(PROGRAMS python/command.py DESTINATION ${SKBUILD_SCRIPTS_DIR} RENAME tetwarp
    COMPONENT python)
endif()
